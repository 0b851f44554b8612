//! Whether a state may be flown on: an estimate and body rates in; the same, or others that bridge them, and how sound
//! they are, out.
//!
//! A step with a sound estimate costs a few comparisons. A part that is not sound is replaced by the last sound one,
//! carried on: attitude by the gyroscope, velocity and position by the accelerometer, or by the thrust that the motors
//! should give where there is none. Each part is looked at by itself, so that a position that is NaN takes nothing
//! from a good attitude.

mod bridge;
mod checks;
mod sample;

use nalgebra::Vector3;

use self::bridge::{Bridge, Still};
use self::checks::{
    NORM_SQUARED_NEAR, as_attitude, is_attitude, is_moving, is_near_unit, is_place, is_same, is_turning, motion_max,
    motion_of, normalised, shorter,
};
pub use self::sample::{Looked, MonitorConfig, Sample, Soundness};
use crate::clock::Tick;
use crate::quaternion::Quaternion;
use crate::state::State;

/// Change of a body rate from which on the gyroscope moves, rad/s: one step of its output at 2000 degrees a second.
const MOVED_RAD_S: f32 = 1e-3;
/// How long an estimate or body rates may stay the same before it is checked whether they are stuck, ticks: three periods
/// of 100 Hz.
const QUIET_TICKS: Tick = 30;
/// Longest step of the bridge, s.
const STEP_MAX_S: f32 = 0.05;
/// A bound below every sum of squares.
const NEVER_CALM: f32 = -1.0;
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

/// Notes since when something is so.
fn since(noted: &mut Option<Tick>, is_so: bool, from: Tick) {
    *noted = if is_so { Some(noted.unwrap_or(from)) } else { None };
}

#[cfg(test)]
mod tests;
