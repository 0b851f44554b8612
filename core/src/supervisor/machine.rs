//! The state machine: the conditions of a step in; the mode of the craft, and the action on its motors, out.

use nalgebra::Vector3;

use super::mode::{Action, Fault, Mode, Reason, Tumble};
use super::monitor::Soundness;
use crate::clock::Tick;

/// A box that a flight keeps to, world frame, m.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Geofence {
    /// Its lowest corner.
    pub least_m: [f32; 3],
    /// Its highest one.
    pub most_m: [f32; 3],
}

impl Geofence {
    fn holds(&self, p: &Vector3<f32>) -> bool {
        let ([x, y, z], [fx, fy, fz]) = (self.least_m, self.most_m);
        p.x >= x && p.x <= fx && p.y >= y && p.y <= fy && p.z >= z && p.z <= fz
    }
}

/// Bounds that the supervisor holds a flight to; apart from its state, so that they can be set without touching it. A tick is 1 ms
/// of the product's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Config {
    /// Oldest state that is taken for one, ticks since it came.
    pub state_age_max_ticks: Tick,
    /// Longest time without any accepted frame, ticks.
    pub link_silence_max_ticks: Tick,
    /// Overruns in a row that a flight survives; with 0 the first one ends it.
    pub overruns_tolerated: u32,
    /// How long a craft that brakes stays where it comes to rest, ticks from when it began to.
    pub hold_ticks: Tick,
    /// Longest way down, ticks.
    pub down_max_ticks: Tick,
    /// How long all has to be well again before a flight goes on as asked, ticks.
    pub recovery_ticks: Tick,
    /// How long the thrust axis may be more than 60 degrees from the vertical, ticks.
    pub tilt_max_ticks: Tick,
    /// How long it may point downwards, ticks.
    pub upside_down_max_ticks: Tick,
    /// How long the motors may give all that they have while the craft does not move, ticks.
    pub no_climb_max_ticks: Tick,
    /// How long motors may be at their limits without a break, ticks.
    pub saturation_max_ticks: Tick,
    /// Voltage of a cell below which it is empty, V.
    pub battery_least_v: f32,
    /// How long it has to be below, ticks.
    pub battery_low_ticks: Tick,
    /// The space that a flight keeps to, if it is told one.
    pub geofence: Option<Geofence>,
}

impl Config {
    /// 50 ms without a state, half a second without a frame, two overruns; stays for a second and a half where it has braked, and
    /// looks for the ground for half a minute.
    pub const STANDARD: Self = Self {
        state_age_max_ticks: 50,
        link_silence_max_ticks: 500,
        overruns_tolerated: 2,
        hold_ticks: 1500,
        down_max_ticks: 30_000,
        recovery_ticks: 100,
        tilt_max_ticks: 1000,
        upside_down_max_ticks: 600,
        no_climb_max_ticks: 1500,
        saturation_max_ticks: 3000,
        battery_least_v: 3.0,
        battery_low_ticks: 2000,
        geofence: None,
    };
}

/// Whether there is a reference, and a sound one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ReferenceReport {
    /// There is none, or it is too old.
    Missing,
    /// Something that cannot be flown.
    Bad,
    /// Something that can.
    Sound,
}

/// The conditions of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// The tick.
    pub now: Tick,
    /// Ticks since the last accepted frame; none if there never was one. 0 without a link.
    pub link_silence_ticks: Option<Tick>,
    /// How sound the state is that can be flown on.
    pub soundness: Soundness,
    /// Vertical component of the thrust axis: the cosine of the tilt.
    pub upright: f32,
    /// Position of the craft, world frame, m.
    pub position_m: Vector3<f32>,
    /// Velocity, m/s, world frame.
    pub velocity_m_s: Vector3<f32>,
    /// Whether there is a reference, and a sound one.
    pub reference: ReferenceReport,
    /// Whether the last step cut something to the motors' range.
    pub limited: bool,
    /// Whether it cut the thrust.
    pub limited_thrust: bool,
    /// Whether the craft can be levelled by attitude: there are body rates and motors.
    pub levels: bool,
    /// Whether it is near enough to where its reference begins; looked at while it is armed.
    pub starts_near: bool,
    /// Whether it has come to the ground.
    pub landed: bool,
    /// Voltage of a cell, V, where it is known.
    pub battery_v: Option<f32>,
    /// Whether this step or the one before ran past its period.
    pub overrun: bool,
    /// A fault, from the step on which it is found.
    pub fault: Option<Fault>,
}

/// The verdict of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// The mode of the craft from here on.
    pub mode: Mode,
    /// The action on its motors.
    pub action: Action,
    /// Whether this step ended a flight or the readiness for one.
    pub stopped: bool,
    /// Whether it is the first that does not fly as asked, after one that did.
    pub left: bool,
}

/// Cosine of the tilt beyond which a craft is tumbling, if it stays there: 60 degrees.
pub(super) const UPRIGHT_LEAST: f32 = 0.5;
/// Squared speed below which a craft does not move, m^2/s^2.
const AT_REST_M2_S2: f32 = 0.15 * 0.15;

/// The state machine; on the ground at start-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Supervisor {
    mode: Mode,
    /// Since when.
    since: Tick,
    overruns_in_a_row: u32,
    /// Since when motors have been at their limits, which is nothing wrong for a while.
    saturated: Option<Tick>,
    /// Since when each has been so; all none while nothing is wrong.
    watched: Watched,
    /// It flies as asked, and nothing is watched.
    is_calm: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Watched {
    tilted: Option<Tick>,
    upside_down: Option<Tick>,
    stuck: Option<Tick>,
    battery_low: Option<Tick>,
    well: Option<Tick>,
}

const NOTHING: Watched = Watched { tilted: None, upside_down: None, stuck: None, battery_low: None, well: None };

impl Supervisor {
    /// On the ground.
    pub const fn new() -> Self {
        Self { mode: Mode::OnGround, since: 0, overruns_in_a_row: 0, saturated: None, watched: NOTHING, is_calm: false }
    }

    /// Of a product that takes over in the air: it flies.
    pub const fn flying(now: Tick) -> Self {
        Self { mode: Mode::Flying, since: now, is_calm: true, ..Self::new() }
    }

    /// The mode after the last call.
    pub const fn mode(&self) -> Mode {
        self.mode
    }

    /// Since which tick it is in it.
    pub const fn since(&self) -> Tick {
        self.since
    }

    /// Arms, where the caller has looked whether that may be ([`super::Preflight`]); nothing changes in the air.
    pub fn arm(&mut self, now: Tick) {
        if !(self.mode.motors_allowed() || matches!(self.mode, Mode::Stopped(Reason::Fault(_)))) {
            *self = Self { mode: Mode::Armed, since: now, ..Self::new() };
        }
    }

    /// Takes a disarm request: from the next step on the motors are off.
    pub fn disarm(&mut self, now: Tick) {
        if !matches!(self.mode, Mode::Stopped(Reason::Fault(_))) {
            *self = Self { mode: Mode::OnGround, since: now, ..Self::new() };
        }
    }

    /// The law has given nothing, on a state that is sound: the verdict from this very step on.
    #[cold]
    pub fn step_failed(&mut self, now: Tick, levels: bool) -> Verdict {
        let next = match self.mode {
            Mode::Flying | Mode::Holding(_) if levels => Mode::LevelAndDown(Reason::StepFailed),
            Mode::LevelAndDown(_) if levels => self.mode,
            mode if mode.motors_allowed() => Mode::Stopped(Reason::StepFailed),
            mode => mode,
        };
        let verdict = self.enter(next, now);
        Verdict { action: if verdict.action == Action::Brake { Action::Level } else { verdict.action }, ..verdict }
    }

    /// The reference turns out not to be flyable in this very step.
    #[cold]
    pub fn reference_failed(&mut self, now: Tick, levels: bool) -> Verdict {
        let next = match self.mode {
            Mode::Flying if levels => Mode::Holding(Reason::BadReference),
            Mode::Flying | Mode::Armed => Mode::Stopped(Reason::BadReference),
            mode => mode,
        };
        self.enter(next, now)
    }

    /// Takes a fault between two steps.
    #[cold]
    pub fn fail(&mut self, fault: Fault, now: Tick) -> Verdict {
        self.enter(Mode::Stopped(Reason::Fault(fault)), now)
    }

    /// Stops where no step comes any more that could level the craft.
    #[cold]
    pub fn stop(&mut self, reason: Reason, now: Tick) -> Verdict {
        let next = if self.mode.motors_allowed() { Mode::Stopped(reason) } else { self.mode };
        self.enter(next, now)
    }

    /// Whether it flies as asked and watches nothing.
    #[inline(always)]
    pub(super) const fn is_calm(&self) -> bool {
        self.is_calm
    }

    /// The same for motors that mostly are not.
    #[inline(always)]
    pub(super) fn is_in_range(&mut self, is_limited: bool, now: Tick, config: &Config) -> bool {
        if is_limited {
            return self.is_limited_briefly(true, now, config);
        }
        self.saturated = None;
        true
    }

    /// Notes since when motors have been at their limits; whether that is not too long yet.
    #[inline(always)]
    pub(super) fn is_limited_briefly(&mut self, is_limited: bool, now: Tick, config: &Config) -> bool {
        !has_lasted(&mut self.saturated, is_limited, now, config.saturation_max_ticks)
    }

    /// Takes the conditions of a step, before it is taken.
    ///
    /// Of several reasons the first in the order of [`Reason`] is named.
    #[cold]
    #[inline(never)]
    pub fn step(&mut self, config: &Config, seen: &Conditions) -> Verdict {
        self.overruns_in_a_row = if seen.overrun { self.overruns_in_a_row.saturating_add(1) } else { 0 };
        let next = match (self.mode, seen.fault) {
            (_, Some(fault)) => Mode::Stopped(Reason::Fault(fault)),
            (Mode::OnGround | Mode::Stopped(_) | Mode::Tumbled(_), None) => self.mode,
            (Mode::Armed, None) => self.armed(config, seen),
            (Mode::Flying | Mode::Holding(_) | Mode::LevelAndDown(_), None) => self.in_air(config, seen),
        };
        let verdict = self.enter(next, seen.now);
        let has_place = matches!(seen.soundness, Soundness::Sound | Soundness::Bridged);
        match verdict.action {
            Action::Brake if !has_place => Verdict { action: Action::Level, ..verdict },
            _ => verdict,
        }
    }

    /// Goes over to a mode.
    fn enter(&mut self, next: Mode, now: Tick) -> Verdict {
        let before = self.mode;
        if next != before {
            (self.mode, self.since) = (next, now);
            self.watched.well = None;
            if !next.is_in_air() {
                (self.watched, self.saturated) = (NOTHING, None);
            }
        }
        self.is_calm = next == Mode::Flying && self.watched == NOTHING && self.overruns_in_a_row == 0;
        let action = match next {
            Mode::OnGround | Mode::Armed | Mode::Stopped(_) | Mode::Tumbled(_) => Action::Off,
            Mode::Flying => Action::Fly,
            Mode::Holding(_) | Mode::LevelAndDown(_) => Action::Brake,
        };
        Verdict {
            mode: next,
            action,
            stopped: before.motors_allowed() && !next.motors_allowed(),
            left: before == Mode::Flying && next != before,
        }
    }

    fn is_overrun(&self, config: &Config) -> bool {
        self.overruns_in_a_row > config.overruns_tolerated
    }

    /// The mode after armed, without a fault: on the ground nothing has to be levelled.
    fn armed(&self, config: &Config, seen: &Conditions) -> Mode {
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

    fn in_air(&mut self, config: &Config, seen: &Conditions) -> Mode {
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

impl Default for Supervisor {
    fn default() -> Self {
        Self::new()
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

#[inline(always)]
fn has_lasted(since: &mut Option<Tick>, is_so: bool, now: Tick, most: Tick) -> bool {
    *since = if is_so { Some(since.unwrap_or(now)) } else { None };
    since.is_some_and(|since| now.wrapping_sub(since) > most)
}

/// Whether a craft with a velocity (m/s) does not move.
pub(super) fn is_at_rest(v: &Vector3<f32>) -> bool {
    v.dot(v) < AT_REST_M2_S2
}

pub(super) fn within(age_ticks: Option<Tick>, max_ticks: Tick) -> bool {
    age_ticks.is_some_and(|age| age <= max_ticks)
}

#[cfg(test)]
mod tests;
