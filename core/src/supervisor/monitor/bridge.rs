//! The last sound state in; the same, carried on by gyroscope and accelerometer while something is missing, out.

use nalgebra::Vector3;

use super::ZERO;
use super::checks::normalised;
use super::sample::{MonitorConfig, Sample, Soundness};
use crate::clock::Tick;
use crate::flatness::GRAVITY_M_S2;
use crate::quaternion::Quaternion;
use crate::state::State;

/// Largest specific force that is believed, m/s^2: 16 g.
const FORCE_MAX_M_S2: f32 = 157.0;
/// Drag over mass that bridges a velocity where there is no accelerometer, 1/s.
const DRAG_PER_S: f32 = 0.4;
/// Share of a new difference of attitudes in the body rates that are made of them.
const DIFFERENCE_SHARE: f32 = 0.5;

/// The state that is carried on while something is not sound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bridge {
    pub(super) state: State,
    pub(super) rates: Vector3<f32>,
    /// Since when each is bad.
    pub(super) place: Option<Tick>,
    pub(super) attitude: Option<Tick>,
    pub(super) gyroscope: Option<Tick>,
    /// That the estimate stays the same, and where the gyroscope was when it began to.
    pub(super) still: Option<Still<Vector3<f32>>>,
    /// That the gyroscope does, and where the attitude was.
    pub(super) still_gyroscope: Option<Still<Quaternion>>,
}

/// One measurement stays the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Still<T> {
    pub(super) from: Tick,
    /// Where another one was then, and whether that has moved since.
    pub(super) other: T,
    pub(super) has_moved: bool,
}

impl<T> Still<T> {
    pub(super) const fn new(from: Tick, other: T) -> Self {
        Self { from, other, has_moved: false }
    }
}

impl Bridge {
    /// Carries the state on by gyroscope and accelerometer.
    #[inline(never)]
    pub(super) fn carry(&mut self, sample: &Sample<'_>, step_s: f32) {
        let State { position_m, attitude, velocity_m_s } = self.state;
        let is_felt = |f: &&Vector3<f32>| f.dot(f) <= FORCE_MAX_M_S2 * FORCE_MAX_M_S2;
        let acceleration = match sample.specific_force_m_s2.filter(is_felt) {
            Some(force) => turned(attitude, force),
            None => {
                let thrust = attitude.thrust_axis() * sample.thrust_m_s2;
                if thrust.dot(&thrust).is_finite() { thrust - velocity_m_s * DRAG_PER_S } else { ZERO }
            }
        };
        let acceleration = Vector3::new(acceleration.x, acceleration.y, acceleration.z - GRAVITY_M_S2);
        let half = 0.5 * step_s;
        let turn = Quaternion::new(1.0, half * self.rates.x, half * self.rates.y, half * self.rates.z);
        self.state = State {
            position_m: position_m + (velocity_m_s + acceleration * half) * step_s,
            attitude: normalised(attitude * turn).unwrap_or(attitude),
            velocity_m_s: velocity_m_s + acceleration * step_s,
        };
    }

    /// Makes body rates of the difference of two attitudes.
    #[inline(never)]
    pub(super) fn differ(&mut self, before: Quaternion, after: Quaternion, step_s: f32) {
        let turn = before.conjugate() * after;
        let scale = if turn.w < 0.0 { -2.0 } else { 2.0 };
        if step_s > 0.0 {
            let difference = turn.vector() * (scale / step_s);
            self.rates += (difference - self.rates) * DIFFERENCE_SHARE;
        }
    }

    #[inline(never)]
    pub(super) fn soundness(&self, is_known: bool, config: &MonitorConfig, now: Tick) -> Soundness {
        let longer = |from: Option<Tick>, most: Tick| from.is_some_and(|from| now.wrapping_sub(from) > most);
        if !is_known || longer(self.attitude, config.attitude_ticks) {
            Soundness::AttitudeLost
        } else if longer(self.gyroscope, config.body_rates_ticks)
            || (self.gyroscope.is_some() && longer(self.attitude, 0))
        {
            Soundness::BodyRatesLost
        } else if longer(self.place, config.bridge_ticks) || longer(self.attitude, config.bridge_ticks) {
            Soundness::AttitudeOnly
        } else if self.place.is_some() || self.attitude.is_some() || self.gyroscope.is_some() {
            Soundness::Bridged
        } else {
            Soundness::Sound
        }
    }
}

/// A body vector in the world frame.
fn turned(q: Quaternion, v: &Vector3<f32>) -> Vector3<f32> {
    let u = q.vector();
    let t = u.cross(v) * 2.0;
    v + t * q.w + u.cross(&t)
}
