//! Whether a state may be flown on: an estimate and body rates in; the same, or others that bridge them, and how sound
//! they are, out.
//!
//! A step with a sound estimate costs a few comparisons. A part that is not sound is replaced by the last sound one,
//! carried on: attitude by the gyroscope, velocity and position by the accelerometer, or by the thrust that the motors
//! should give where there is none. Each part is looked at by itself, so that a position that is NaN takes nothing
//! from a good attitude.

use nalgebra::Vector3;

use crate::clock::Tick;
use crate::flatness::GRAVITY_M_S2;
use crate::math::sqrt;
use crate::quaternion::Quaternion;
use crate::state::State;

/// The bounds of a sound sample, and for how long the rest is bridged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MonitorConfig {
    /// Length of a tick, s.
    pub tick_s: f32,
    /// How long a position, velocity or attitude is bridged before it counts as lost, ticks.
    pub bridge_ticks: Tick,
    /// How long the gyroscope alone may carry an attitude on, ticks.
    pub attitude_ticks: Tick,
    /// How long body rates may be the attitude's differences, ticks.
    pub body_rates_ticks: Tick,
    /// How long an estimate may stay the same, bit by bit, while the gyroscope moves; and a gyroscope while the attitude
    /// does.
    pub frozen_ticks: Tick,
    /// Velocity that no craft has, m/s.
    pub speed_max_m_s: f32,
    /// Farthest position, m.
    pub position_max_m: f32,
    /// Body rate beyond the gyroscope's range, rad/s.
    pub body_rate_max_rad_s: f32,
}

impl MonitorConfig {
    /// Ticks of 1 ms; half a second of bridging, five on the gyroscope alone, and a range of 2000 degrees a second.
    pub const STANDARD: Self = Self {
        tick_s: 1e-3,
        bridge_ticks: 500,
        attitude_ticks: 5000,
        body_rates_ticks: 600,
        frozen_ticks: 100,
        speed_max_m_s: 30.0,
        position_max_m: 10_000.0,
        body_rate_max_rad_s: 34.9,
    };
}

/// Squared norms between which a quaternion is an attitude and is scaled to norm 1: of 0.7 and of 1.4.
const NORM_SQUARED: [f32; 2] = [0.49, 1.96];
/// Squared norms that every law takes as they are.
const NORM_SQUARED_NEAR: [f32; 2] = [1.0 - NEAR, 1.0 + NEAR];
const NEAR: f32 = 0.02;
/// Largest specific force that is believed, m/s^2: 16 g.
const FORCE_MAX_M_S2: f32 = 157.0;
/// Change of a body rate from which on the gyroscope moves, rad/s: one step of its output at 2000 degrees a second.
const MOVED_RAD_S: f32 = 1e-3;
/// How long an estimate or body rates may stay the same before it is checked whether they are stuck, ticks: three periods
/// of 100 Hz.
const QUIET_TICKS: Tick = 30;
/// Drag over mass that bridges a velocity where there is no accelerometer, 1/s.
const DRAG_PER_S: f32 = 0.4;
/// Longest step of the bridge, s.
const STEP_MAX_S: f32 = 0.05;
/// A bound below every sum of squares.
const NEVER_CALM: f32 = -1.0;
/// Share of a new difference of attitudes in the body rates that are made of them.
const DIFFERENCE_SHARE: f32 = 0.5;

/// The soundness of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Soundness {
    /// As it was given, or with its quaternion scaled to norm 1.
    Sound,
    /// In parts the last sound one, carried on.
    Bridged,
    /// A position, velocity or attitude has been missing for too long: the rest is good for staying level.
    AttitudeOnly,
    /// There is no attitude.
    AttitudeLost,
    /// There are no body rates.
    BodyRatesLost,
}

/// The state and body rates that a step may be flown on.
#[derive(Clone, Copy, Debug)]
pub struct Looked<'a> {
    /// Its soundness.
    pub soundness: Soundness,
    /// The state; of finite numbers and an attitude, unless that is lost.
    pub state: &'a State,
    /// The body rates, rad/s.
    pub body_rates_rad_s: &'a Vector3<f32>,
    /// How long the velocity has been bridged, ticks; none while it is measured.
    pub velocity_bridged_ticks: Option<Tick>,
}

/// The measurements of a step.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// The tick.
    pub now: Tick,
    /// The estimate; nothing where the newest is too old.
    pub state: Option<&'a State>,
    /// The gyroscope's body rates, rad/s; nothing where there is none. One that has failed gives NaN.
    pub body_rates_rad_s: Option<&'a Vector3<f32>>,
    /// The accelerometer's specific force in the body frame, m/s^2.
    pub specific_force_m_s2: Option<&'a Vector3<f32>>,
    /// Thrust over mass that the motors should give, m/s^2: it carries a velocity on where there is no accelerometer.
    pub thrust_m_s2: f32,
}

/// The monitor's memory; first the part that every step looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Monitor {
    /// The newest estimate as it was given, and its body rates.
    given: State,
    rates: Vector3<f32>,
    at: Tick,
    /// When the body rates were others the last time.
    turned_at: Tick,
    /// Bound of [`motion_of`] below which a step is sound without a closer look; [`NEVER_CALM`] until a sound estimate has come and
    /// while something is bridged.
    calm_below: f32,
    /// A sound estimate has come.
    is_known: bool,
    /// The last step is flown on a bridged state.
    is_bridged: bool,
    /// Something is not sound, or stays the same.
    bridge: Option<Bridge>,
}

/// The state that is carried on while something is not sound.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bridge {
    state: State,
    rates: Vector3<f32>,
    /// Since when each is bad.
    place: Option<Tick>,
    attitude: Option<Tick>,
    gyroscope: Option<Tick>,
    /// That the estimate stays the same, and where the gyroscope was when it began to.
    still: Option<Still<Vector3<f32>>>,
    /// That the gyroscope does, and where the attitude was.
    still_gyroscope: Option<Still<Quaternion>>,
}

/// One measurement stays the same.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Still<T> {
    from: Tick,
    /// Where another one was then, and whether that has moved since.
    other: T,
    has_moved: bool,
}

impl<T> Still<T> {
    const fn new(from: Tick, other: T) -> Self {
        Self { from, other, has_moved: false }
    }
}

const ZERO: Vector3<f32> = Vector3::new(0.0, 0.0, 0.0);
/// Of a craft without a gyroscope.
static NO_RATES: Vector3<f32> = ZERO;

impl Monitor {
    /// Nothing seen.
    pub const fn new() -> Self {
        let given = State { position_m: ZERO, attitude: Quaternion::IDENTITY, velocity_m_s: ZERO };
        Self {
            given,
            rates: ZERO,
            at: 0,
            turned_at: 0,
            calm_below: NEVER_CALM,
            is_known: false,
            is_bridged: false,
            bridge: None,
        }
    }

    /// Checks the sample of a step.
    #[inline(always)]
    pub fn look(&mut self, config: &MonitorConfig, sample: &Sample<'_>) -> Looked<'_> {
        if self.keeps(config, sample) { self.looked() } else { self.look_closely(config, sample) }
    }

    /// Keeps the sample of a step where all of it is sound and nothing has been bridged, which is seen by a few comparisons; whether
    /// it is. They are stricter than the bounds: a sample that fails one gets the closer look.
    #[inline(always)]
    pub(super) fn keeps(&mut self, config: &MonitorConfig, sample: &Sample<'_>) -> bool {
        let rates = sample.body_rates_rad_s.unwrap_or(&NO_RATES);
        let Some(state) = sample.state else { return false };
        if !(is_near_unit(state.attitude) && motion_of(state, rates, config) < self.calm_below) {
            return false;
        }
        // An estimate that comes more rarely than steps is the same in between; body rates may be, too. Most differ in the first
        // that is looked at.
        let has_changed = state.velocity_m_s.x.to_bits() != self.given.velocity_m_s.x.to_bits();
        if sample.body_rates_rad_s.is_none() || has_changed && rates.x != self.rates.x {
            (self.at, self.turned_at) = (sample.now, sample.now);
        } else if !self.is_still_briefly(state, rates, sample.now) {
            return false;
        }
        (self.given, self.rates) = (*state, *rates);
        true
    }

    /// Notes the tick of the last change where a part of the sample may be the same as before; whether none has been for too long.
    #[inline(always)]
    fn is_still_briefly(&mut self, state: &State, rates: &Vector3<f32>, now: Tick) -> bool {
        let at = if is_same(state, &self.given) { self.at } else { now };
        let turned_at = if is_moving(rates, &self.rates) { now } else { self.turned_at };
        let is_brief = |since: Tick| now.wrapping_sub(since) <= QUIET_TICKS;
        let is_brief = is_brief(at) && is_brief(turned_at);
        if is_brief {
            (self.at, self.turned_at) = (at, turned_at);
        }
        is_brief
    }

    /// The state and body rates that the last step is flown on.
    #[inline(always)]
    pub(super) fn looked(&self) -> Looked<'_> {
        if self.is_bridged { self.bridged() } else { self.sound() }
    }

    #[inline(always)]
    const fn sound(&self) -> Looked<'_> {
        Looked {
            soundness: Soundness::Sound,
            state: &self.given,
            body_rates_rad_s: &self.rates,
            velocity_bridged_ticks: None,
        }
    }

    #[cold]
    fn bridged(&self) -> Looked<'_> {
        let Some(Bridge { state, rates, place, .. }) = &self.bridge else { return self.sound() };
        let velocity_bridged_ticks = place.map(|from| self.at.wrapping_sub(from));
        Looked { soundness: Soundness::Bridged, state, body_rates_rad_s: rates, velocity_bridged_ticks }
    }

    #[cold]
    #[inline(never)]
    pub(super) fn look_closely(&mut self, config: &MonitorConfig, sample: &Sample<'_>) -> Looked<'_> {
        let now = sample.now;
        let step_s = shorter(now.wrapping_sub(self.at) as f32 * config.tick_s, STEP_MAX_S);
        let mut bridge = self.bridge.unwrap_or_else(|| Bridge {
            state: State { attitude: normalised(self.given.attitude).unwrap_or(Quaternion::IDENTITY), ..self.given },
            rates: self.rates,
            place: None,
            attitude: None,
            gyroscope: None,
            still: None,
            still_gyroscope: None,
        });
        let before = bridge.state.attitude;

        let given_rates = sample.body_rates_rad_s.copied();
        let is_gyroscope = given_rates.is_none_or(|rates| is_turning(&rates, config));
        let is_gyroscope = is_gyroscope && !self.is_gyroscope_stuck(&mut bridge, config, sample);
        since(&mut bridge.gyroscope, !is_gyroscope, now);
        if is_gyroscope {
            bridge.rates = given_rates.unwrap_or(ZERO);
        }
        bridge.carry(sample, step_s);

        let stuck_since = self.stuck_since(&mut bridge, config, sample);
        let fresh = sample.state.filter(|_| stuck_since.is_none());
        let place = fresh.filter(|state| is_place(state, config));
        let attitude = fresh.and_then(|state| as_attitude(state.attitude));
        since(&mut bridge.place, place.is_none(), stuck_since.unwrap_or(now));
        since(&mut bridge.attitude, attitude.is_none(), stuck_since.unwrap_or(now));
        // A part that stays the same is carried on beside it, should it turn out to be stuck.
        let is_still = bridge.still.is_some();
        if let Some(state) = place.filter(|_| !is_still) {
            (bridge.state.position_m, bridge.state.velocity_m_s) = (state.position_m, state.velocity_m_s);
        }
        if let Some(attitude) = attitude.filter(|_| !is_still) {
            if !is_gyroscope && sample.state.is_some_and(|state| state.attitude != self.given.attitude) {
                bridge.differ(before, attitude, step_s);
            }
            bridge.state.attitude = attitude;
        }
        self.is_known |= place.is_some() && attitude.is_some();
        if let Some(State { position_m: p, attitude, velocity_m_s: v }) = sample.state {
            // Number by number: as a whole it is a move between places that may overlap, which links 1.6 kB.
            let (position_m, velocity_m_s) = (Vector3::new(p.x, p.y, p.z), Vector3::new(v.x, v.y, v.z));
            self.given = State { position_m, attitude: *attitude, velocity_m_s };
        }
        if given_rates.is_none_or(|rates| rates != self.rates) {
            self.turned_at = now;
        }
        (self.rates, self.at) = (given_rates.unwrap_or(ZERO), now);

        let soundness = bridge.soundness(self.is_known, config, now);
        let velocity_bridged_ticks = bridge.place.map(|from| now.wrapping_sub(from));
        let is_over = soundness == Soundness::Sound
            && bridge.still.is_none()
            && bridge.still_gyroscope.is_none()
            && is_attitude(self.given.attitude, NORM_SQUARED_NEAR);
        self.bridge = (!is_over).then_some(bridge);
        self.calm_below = if is_over { motion_max(config) } else { NEVER_CALM };
        let is_given = soundness == Soundness::Sound && is_attitude(self.given.attitude, NORM_SQUARED_NEAR);
        self.is_bridged = !(is_over || is_given);
        Looked { soundness, velocity_bridged_ticks, ..self.looked() }
    }

    /// Since when the estimate has been standing still while the gyroscope moves, where that is too long.
    fn stuck_since(&self, bridge: &mut Bridge, config: &MonitorConfig, sample: &Sample<'_>) -> Option<Tick> {
        let rates = bridge.rates;
        if !self.is_known || sample.state.is_none_or(|state| !is_same(state, &self.given)) {
            bridge.still = None;
            return None;
        }
        let still = bridge.still.get_or_insert(Still::new(self.at, rates));
        let turn = rates - still.other;
        still.has_moved |= turn.dot(&turn) > MOVED_RAD_S * MOVED_RAD_S;
        (still.has_moved && sample.now.wrapping_sub(still.from) >= config.frozen_ticks).then_some(still.from)
    }

    /// Whether the gyroscope has been standing still for too long while the attitude moves.
    fn is_gyroscope_stuck(&self, bridge: &mut Bridge, config: &MonitorConfig, sample: &Sample<'_>) -> bool {
        let (Some(rates), Some(state)) = (sample.body_rates_rad_s, sample.state) else { return false };
        if *rates != self.rates || !self.is_known {
            bridge.still_gyroscope = None;
            return false;
        }
        let still = bridge.still_gyroscope.get_or_insert(Still::new(self.turned_at, state.attitude));
        still.has_moved |= state.attitude != still.other;
        still.has_moved && sample.now.wrapping_sub(still.from) >= config.frozen_ticks
    }
}

impl Default for Monitor {
    fn default() -> Self {
        Self::new()
    }
}

impl Bridge {
    /// Carries the state on by gyroscope and accelerometer.
    #[inline(never)]
    fn carry(&mut self, sample: &Sample<'_>, step_s: f32) {
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
    fn differ(&mut self, before: Quaternion, after: Quaternion, step_s: f32) {
        let turn = before.conjugate() * after;
        let scale = if turn.w < 0.0 { -2.0 } else { 2.0 };
        if step_s > 0.0 {
            let difference = turn.vector() * (scale / step_s);
            self.rates += (difference - self.rates) * DIFFERENCE_SHARE;
        }
    }

    #[inline(never)]
    fn soundness(&self, is_known: bool, config: &MonitorConfig, now: Tick) -> Soundness {
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

/// Notes since when something is so.
fn since(noted: &mut Option<Tick>, is_so: bool, from: Tick) {
    *noted = if is_so { Some(noted.unwrap_or(from)) } else { None };
}

fn shorter(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn is_attitude(q: Quaternion, [least, most]: [f32; 2]) -> bool {
    let squared = q.dot(q);
    squared >= least && squared <= most
}

/// The same of [`NORM_SQUARED_NEAR`] by one comparison.
#[inline(always)]
fn is_near_unit(q: Quaternion) -> bool {
    let squared = (q.x * q.x + q.y * q.y) + (q.w * q.w + q.z * q.z);
    (squared - 1.0).abs() <= NEAR
}

/// Position, velocity and body rates as one sum of squares. Below [`motion_max`] each is within its own bound; one that is no number
/// is below nothing.
#[inline(always)]
fn motion_of(state: &State, w: &Vector3<f32>, config: &MonitorConfig) -> f32 {
    let (p, v) = (&state.position_m, &state.velocity_m_s);
    let per_m2 = motion_max(config) / (config.position_max_m * config.position_max_m);
    let motion = (v.x * v.x + v.y * v.y + v.z * v.z) + (w.x * w.x + w.y * w.y + w.z * w.z);
    (p.x * p.x + p.y * p.y + p.z * p.z) * per_m2 + motion
}

/// The square of the lesser of the bounds of velocity and body rates.
#[inline(always)]
fn motion_max(config: &MonitorConfig) -> f32 {
    let most = shorter(config.speed_max_m_s, config.body_rate_max_rad_s);
    most * most
}

#[inline(always)]
fn is_place(state: &State, config: &MonitorConfig) -> bool {
    let (p, v) = (&state.position_m, &state.velocity_m_s);
    let (far, fast) = (config.position_max_m, config.speed_max_m_s);
    p.x * p.x + p.y * p.y + p.z * p.z <= far * far && v.x * v.x + v.y * v.y + v.z * v.z <= fast * fast
}

#[inline(always)]
fn is_turning(w: &Vector3<f32>, config: &MonitorConfig) -> bool {
    let most = config.body_rate_max_rad_s;
    w.x * w.x + w.y * w.y + w.z * w.z < most * most
}

/// Whether body rates are other ones than those before.
#[inline(always)]
fn is_moving(rates: &Vector3<f32>, before: &Vector3<f32>) -> bool {
    rates.x != before.x || rates.y != before.y || rates.z != before.z
}

/// Whether two estimates have the same bits; a NaN is the same as itself.
#[inline(always)]
fn is_same(a: &State, b: &State) -> bool {
    let differ = |a: f32, b: f32| a.to_bits() ^ b.to_bits();
    let (p, q, v) = (&a.position_m, &a.attitude, &a.velocity_m_s);
    let (o, r, u) = (&b.position_m, &b.attitude, &b.velocity_m_s);
    let place = differ(p.x, o.x) | differ(p.y, o.y) | differ(p.z, o.z);
    let attitude = differ(q.w, r.w) | differ(q.x, r.x) | differ(q.y, r.y) | differ(q.z, r.z);
    let velocity = differ(v.x, u.x) | differ(v.y, u.y) | differ(v.z, u.z);
    (place | attitude | velocity) == 0
}

/// An attitude as the laws take it: as it is where its norm is near 1, else scaled.
fn as_attitude(q: Quaternion) -> Option<Quaternion> {
    if is_attitude(q, NORM_SQUARED_NEAR) { Some(q) } else { normalised(q) }
}

#[inline(never)]
fn normalised(q: Quaternion) -> Option<Quaternion> {
    is_attitude(q, NORM_SQUARED).then(|| q.scaled(1.0 / sqrt(q.dot(q))))
}

/// A body vector in the world frame.
fn turned(q: Quaternion, v: &Vector3<f32>) -> Vector3<f32> {
    let u = q.vector();
    let t = u.cross(v) * 2.0;
    v + t * q.w + u.cross(&t)
}

#[cfg(test)]
mod tests;
