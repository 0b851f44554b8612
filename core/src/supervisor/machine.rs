//! The state machine: the conditions of a step in; the mode of the craft, and the action on its motors, out.

mod conditions;
mod transitions;

pub use self::conditions::{Conditions, Config, Geofence, ReferenceReport, Verdict};
pub(super) use self::transitions::{UPRIGHT_LEAST, is_at_rest, within};
use super::mode::{Action, Fault, Mode, Reason};
use super::monitor::Soundness;
use crate::clock::Tick;

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
}

impl Default for Supervisor {
    fn default() -> Self {
        Self::new()
    }
}

#[inline(always)]
fn has_lasted(since: &mut Option<Tick>, is_so: bool, now: Tick, most: Tick) -> bool {
    *since = if is_so { Some(since.unwrap_or(now)) } else { None };
    since.is_some_and(|since| now.wrapping_sub(since) > most)
}

#[cfg(test)]
mod tests;
