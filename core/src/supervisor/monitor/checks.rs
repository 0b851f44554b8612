//! A part of a sample in; whether it is within its bounds, and whether it is another one than before, out.

use nalgebra::Vector3;

use super::sample::MonitorConfig;
use crate::math::sqrt;
use crate::quaternion::Quaternion;
use crate::state::State;

/// Squared norms between which a quaternion is an attitude and is scaled to norm 1: of 0.7 and of 1.4.
const NORM_SQUARED: [f32; 2] = [0.49, 1.96];
/// Squared norms that every law takes as they are.
pub(super) const NORM_SQUARED_NEAR: [f32; 2] = [1.0 - NEAR, 1.0 + NEAR];
const NEAR: f32 = 0.02;

pub(super) fn shorter(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
pub(super) fn is_attitude(q: Quaternion, [least, most]: [f32; 2]) -> bool {
    let squared = q.dot(q);
    squared >= least && squared <= most
}

/// The same of [`NORM_SQUARED_NEAR`] by one comparison.
#[inline(always)]
pub(super) fn is_near_unit(q: Quaternion) -> bool {
    let squared = (q.x * q.x + q.y * q.y) + (q.w * q.w + q.z * q.z);
    (squared - 1.0).abs() <= NEAR
}

/// Position, velocity and body rates as one sum of squares. Below [`motion_max`] each is within its own bound; one that is no number
/// is below nothing.
#[inline(always)]
pub(super) fn motion_of(state: &State, w: &Vector3<f32>, config: &MonitorConfig) -> f32 {
    let (p, v) = (&state.position_m, &state.velocity_m_s);
    let per_m2 = motion_max(config) / (config.position_max_m * config.position_max_m);
    let motion = (v.x * v.x + v.y * v.y + v.z * v.z) + (w.x * w.x + w.y * w.y + w.z * w.z);
    (p.x * p.x + p.y * p.y + p.z * p.z) * per_m2 + motion
}

/// The square of the lesser of the bounds of velocity and body rates.
#[inline(always)]
pub(super) fn motion_max(config: &MonitorConfig) -> f32 {
    let most = shorter(config.speed_max_m_s, config.body_rate_max_rad_s);
    most * most
}

#[inline(always)]
pub(super) fn is_place(state: &State, config: &MonitorConfig) -> bool {
    let (p, v) = (&state.position_m, &state.velocity_m_s);
    let (far, fast) = (config.position_max_m, config.speed_max_m_s);
    p.x * p.x + p.y * p.y + p.z * p.z <= far * far && v.x * v.x + v.y * v.y + v.z * v.z <= fast * fast
}

#[inline(always)]
pub(super) fn is_turning(w: &Vector3<f32>, config: &MonitorConfig) -> bool {
    let most = config.body_rate_max_rad_s;
    w.x * w.x + w.y * w.y + w.z * w.z < most * most
}

/// Whether body rates are other ones than those before.
#[inline(always)]
pub(super) fn is_moving(rates: &Vector3<f32>, before: &Vector3<f32>) -> bool {
    rates.x != before.x || rates.y != before.y || rates.z != before.z
}

/// Whether two estimates have the same bits; a NaN is the same as itself.
#[inline(always)]
pub(super) fn is_same(a: &State, b: &State) -> bool {
    let differ = |a: f32, b: f32| a.to_bits() ^ b.to_bits();
    let (p, q, v) = (&a.position_m, &a.attitude, &a.velocity_m_s);
    let (o, r, u) = (&b.position_m, &b.attitude, &b.velocity_m_s);
    let place = differ(p.x, o.x) | differ(p.y, o.y) | differ(p.z, o.z);
    let attitude = differ(q.w, r.w) | differ(q.x, r.x) | differ(q.y, r.y) | differ(q.z, r.z);
    let velocity = differ(v.x, u.x) | differ(v.y, u.y) | differ(v.z, u.z);
    (place | attitude | velocity) == 0
}

/// An attitude as the laws take it: as it is where its norm is near 1, else scaled.
pub(super) fn as_attitude(q: Quaternion) -> Option<Quaternion> {
    if is_attitude(q, NORM_SQUARED_NEAR) { Some(q) } else { normalised(q) }
}

#[inline(never)]
pub(super) fn normalised(q: Quaternion) -> Option<Quaternion> {
    is_attitude(q, NORM_SQUARED).then(|| q.scaled(1.0 / sqrt(q.dot(q))))
}
