//! The conditions of a step without a fault in; the mode that follows the one of now out.

use nalgebra::Vector3;

use super::conditions::{Conditions, Config, ReferenceReport};
use super::{Supervisor, has_lasted};
use crate::clock::Tick;
use crate::supervisor::mode::{Mode, Reason, Tumble};
use crate::supervisor::monitor::Soundness;

/// Cosine of the tilt beyond which a craft is tumbling, if it stays there: 60 degrees.
pub(in crate::supervisor) const UPRIGHT_LEAST: f32 = 0.5;
/// Squared speed below which a craft does not move, m^2/s^2.
const AT_REST_M2_S2: f32 = 0.15 * 0.15;

impl Supervisor {
    fn is_overrun(&self, config: &Config) -> bool {
        self.overruns_in_a_row > config.overruns_tolerated
    }

    /// The mode after armed, without a fault: on the ground nothing has to be levelled.
    pub(super) fn armed(&self, config: &Config, seen: &Conditions) -> Mode {
        if self.is_overrun(config) {
            Mode::Stopped(Reason::Overrun)
        } else if !within(seen.link_silence_ticks, config.link_silence_max_ticks) {
            Mode::Stopped(Reason::LinkLost)
        } else if seen.soundness != Soundness::Sound || seen.reference == ReferenceReport::Missing {
            Mode::Armed
        } else if seen.reference == ReferenceReport::Bad {
            Mode::Stopped(Reason::BadReference)
        } else if seen.upright < UPRIGHT_LEAST {
            Mode::Tumbled(Tumble::Tilted)
        } else if !seen.starts_near {
            Mode::Stopped(Reason::StartTooFar)
        } else {
            Mode::Flying
        }
    }

    pub(super) fn in_air(&mut self, config: &Config, seen: &Conditions) -> Mode {
        let now = seen.now;
        if self.is_overrun(config) {
            return Mode::Stopped(Reason::Overrun);
        }
        match seen.soundness {
            Soundness::AttitudeLost => return Mode::Stopped(Reason::AttitudeLost),
            Soundness::BodyRatesLost => return Mode::Stopped(Reason::BodyRatesLost),
            Soundness::Sound | Soundness::Bridged | Soundness::AttitudeOnly => {}
        }
        if let Some(tumble) = self.tumbled(config, seen) {
            return Mode::Tumbled(tumble);
        }
        let trouble = self.trouble(config, seen);
        let Some(reason) = trouble.or(self.mode.reason()) else { return Mode::Flying };
        if !seen.levels && trouble.is_some() {
            return Mode::Stopped(reason);
        }
        let is_well = trouble.is_none() && !is_final(reason) && seen.soundness == Soundness::Sound;
        if lasted(&mut self.watched.well, is_well, now, config.recovery_ticks) {
            return Mode::Flying;
        }
        // A mode that goes on keeps the reason that it began with.
        match self.mode {
            Mode::LevelAndDown(_) if seen.landed => Mode::Stopped(Reason::Landed),
            Mode::LevelAndDown(_) if now.wrapping_sub(self.since) > config.down_max_ticks => {
                Mode::Stopped(Reason::NoGround)
            }
            Mode::LevelAndDown(_) => self.mode,
            _ if seen.soundness == Soundness::AttitudeOnly => Mode::LevelAndDown(reason),
            Mode::Holding(before) if now.wrapping_sub(self.since) > config.hold_ticks => Mode::LevelAndDown(before),
            Mode::Holding(_) => self.mode,
            _ => Mode::Holding(reason),
        }
    }

    /// Why the flight cannot go on as it is asked to, if it cannot.
    fn trouble(&mut self, config: &Config, seen: &Conditions) -> Option<Reason> {
        let now = seen.now;
        let is_low = seen.battery_v.is_some_and(|volts| volts < config.battery_least_v);
        let is_empty = lasted(&mut self.watched.battery_low, is_low, now, config.battery_low_ticks);
        let is_saturated = !self.is_limited_briefly(seen.limited, now, config);
        let is_outside = config.geofence.is_some_and(|fence| !fence.holds(&seen.position_m));
        if seen.soundness == Soundness::AttitudeOnly {
            Some(Reason::StateLost)
        } else if !within(seen.link_silence_ticks, config.link_silence_max_ticks) {
            Some(Reason::LinkLost)
        } else if seen.reference == ReferenceReport::Bad {
            Some(Reason::BadReference)
        } else if seen.reference == ReferenceReport::Missing {
            Some(Reason::NoReference)
        } else if is_outside {
            Some(Reason::Geofence)
        } else if is_empty {
            Some(Reason::Battery)
        } else {
            is_saturated.then_some(Reason::Saturated)
        }
    }

    /// Whether it flies no more.
    fn tumbled(&mut self, config: &Config, seen: &Conditions) -> Option<Tumble> {
        let now = seen.now;
        let is_at_rest = is_at_rest(&seen.velocity_m_s) && seen.soundness == Soundness::Sound;
        let watched = &mut self.watched;
        let is_tilted = lasted(&mut watched.tilted, seen.upright < UPRIGHT_LEAST, now, config.tilt_max_ticks);
        let is_down = lasted(&mut watched.upside_down, seen.upright < 0.0, now, config.upside_down_max_ticks);
        let is_stuck = lasted(&mut watched.stuck, seen.limited_thrust && is_at_rest, now, config.no_climb_max_ticks);
        if is_down {
            Some(Tumble::UpsideDown)
        } else if is_tilted {
            Some(Tumble::Tilted)
        } else {
            is_stuck.then_some(Tumble::NoClimb)
        }
    }
}

/// Whether a flight that has begun to come down for this reason does not go on.
const fn is_final(reason: Reason) -> bool {
    matches!(reason, Reason::Geofence | Reason::Battery | Reason::Saturated)
}

/// Notes since when something is so, and whether that is longer than allowed.
#[inline(never)]
fn lasted(since: &mut Option<Tick>, is_so: bool, now: Tick, most: Tick) -> bool {
    has_lasted(since, is_so, now, most)
}

/// Whether a craft with a velocity (m/s) does not move.
pub(in crate::supervisor) fn is_at_rest(v: &Vector3<f32>) -> bool {
    v.dot(v) < AT_REST_M2_S2
}

pub(in crate::supervisor) fn within(age_ticks: Option<Tick>, max_ticks: Tick) -> bool {
    age_ticks.is_some_and(|age| age <= max_ticks)
}
