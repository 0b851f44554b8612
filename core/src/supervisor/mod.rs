//! The supervisor: what a tick saw (ages, step, overrun, fault) in; whether the motors may turn and the command may
//! pass out.
//!
//! ```text
//! Disarmed --arm--> Armed --first command on a fresh state--> Flying
//!     ^               |                                         |
//!     +---------------+----- disarm, or any stop reason --------+        any mode --fault--> Faulted, for good
//! ```
//!
//! Nothing ever holds the last command: what ends a flight gives a zero command and disarms in the same tick. Armed
//! motors stand still; a new arm request is needed after every stop. Levelling out instead would take an attitude, and
//! without the link's states there is none on board.

mod mode;

pub use mode::{ArmError, Fault, Mode, StopReason};

use crate::clock::Tick;
use crate::command::Command;

/// Bounds that the supervisor holds a flight to; apart from its state, so that they can be set without touching it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Config {
    /// Oldest state that is flown on, ticks since it came.
    pub state_age_max_ticks: Tick,
    /// Longest time without any accepted frame, ticks.
    pub link_silence_max_ticks: Tick,
    /// Overruns in a row that a flight survives; with 0 the first one ends it.
    pub overruns_tolerated: u32,
}

/// How the control step of a tick went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StepReport {
    /// There was no state or no reference to step on.
    NoReference,
    /// It gave a command.
    Command,
    /// It gave none.
    Failed,
}

/// What one tick saw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Conditions {
    /// Ticks since the last accepted frame; none if there never was one.
    pub link_silence_ticks: Option<Tick>,
    /// Ticks since the last state came; none if there never was one.
    pub state_age_ticks: Option<Tick>,
    /// The step.
    pub step: StepReport,
    /// Whether this tick or the one before ran past its period.
    pub overrun: bool,
    /// A fault, from the tick on which it is found.
    pub fault: Option<Fault>,
}

/// What follows from a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Verdict {
    /// The mode from this tick on.
    pub mode: Mode,
    /// Whether this tick ended a flight or the readiness for one.
    pub stopped: bool,
}

impl Verdict {
    /// The command for the motors: the step's own while flying, zero in every other mode.
    pub fn gate(&self, command: &Command) -> Command {
        if self.mode.command_passes() { *command } else { Command::ZERO }
    }
}

/// The state machine; disarmed at start-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Supervisor {
    mode: Mode,
    overruns_in_a_row: u32,
}

impl Supervisor {
    /// Disarmed.
    pub const fn new() -> Self {
        Self { mode: Mode::Disarmed(None), overruns_in_a_row: 0 }
    }

    /// The mode after the last call.
    pub const fn mode(&self) -> Mode {
        self.mode
    }

    /// Takes an arm request; nothing changes when armed or flying.
    ///
    /// # Errors
    /// [`ArmError`] after a fault, and where the link has been silent for longer than `config` allows.
    pub fn arm(&mut self, config: &Config, link_silence_ticks: Option<Tick>) -> Result<(), ArmError> {
        match self.mode {
            Mode::Faulted(fault) => Err(ArmError::Faulted(fault)),
            Mode::Armed | Mode::Flying => Ok(()),
            Mode::Disarmed(_) if !within(link_silence_ticks, config.link_silence_max_ticks) => {
                Err(ArmError::LinkSilent)
            }
            Mode::Disarmed(_) => {
                *self = Self { mode: Mode::Armed, overruns_in_a_row: 0 };
                Ok(())
            }
        }
    }

    /// Takes a disarm request; from the next command on it is zero.
    pub fn disarm(&mut self) {
        if self.mode.motors_allowed() {
            self.mode = Mode::Disarmed(Some(StopReason::Requested));
        }
    }

    /// Takes what a tick saw, once a control step: after the step and before its command goes to the motors.
    ///
    /// Of several reasons to stop, the first in this order is named: overrun, link, step, state, reference.
    pub fn tick(&mut self, config: &Config, conditions: &Conditions) -> Verdict {
        self.overruns_in_a_row = if conditions.overrun { self.overruns_in_a_row.saturating_add(1) } else { 0 };
        let before = self.mode;
        self.mode = match (before, conditions.fault) {
            (Mode::Faulted(fault), _) | (_, Some(fault)) => Mode::Faulted(fault),
            (Mode::Disarmed(reason), None) => Mode::Disarmed(reason),
            (Mode::Armed | Mode::Flying, None) => self.armed(config, conditions),
        };
        Verdict { mode: self.mode, stopped: before.motors_allowed() && !self.mode.motors_allowed() }
    }

    /// The mode that follows on armed or flying without a fault.
    fn armed(&self, config: &Config, conditions: &Conditions) -> Mode {
        let stop = |reason| Mode::Disarmed(Some(reason));
        let fresh = within(conditions.state_age_ticks, config.state_age_max_ticks);
        let flying = self.mode.command_passes();
        if self.overruns_in_a_row > config.overruns_tolerated {
            return stop(StopReason::Overrun);
        }
        if !within(conditions.link_silence_ticks, config.link_silence_max_ticks) {
            return stop(StopReason::LinkLost);
        }
        match conditions.step {
            StepReport::Failed => stop(StopReason::StepFailed),
            // Nothing has to have come yet before the first command.
            _ if flying && !fresh => stop(StopReason::StaleState),
            StepReport::NoReference if flying => stop(StopReason::NoReference),
            StepReport::Command if fresh => Mode::Flying,
            StepReport::Command | StepReport::NoReference => Mode::Armed,
        }
    }
}

impl Default for Supervisor {
    fn default() -> Self {
        Self::new()
    }
}

fn within(age_ticks: Option<Tick>, max_ticks: Tick) -> bool {
    age_ticks.is_some_and(|age| age <= max_ticks)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    const CONFIG: Config = Config { state_age_max_ticks: 10, link_silence_max_ticks: 20, overruns_tolerated: 0 };

    /// Everything as it should be.
    const SOUND: Conditions = Conditions {
        link_silence_ticks: Some(20),
        state_age_ticks: Some(10),
        step: StepReport::Command,
        overrun: false,
        fault: None,
    };

    const STOPPED: Mode = Mode::Disarmed(Some(StopReason::Requested));
    const FAULTED: Mode = Mode::Faulted(Fault::HardFault);
    const MODES: [Mode; 5] = [Mode::Disarmed(None), STOPPED, Mode::Armed, Mode::Flying, FAULTED];

    fn stop(reason: StopReason) -> Mode {
        Mode::Disarmed(Some(reason))
    }

    /// The mode after one tick in `mode`.
    fn after(mode: Mode, conditions: Conditions) -> Mode {
        let mut supervisor = Supervisor { mode, overruns_in_a_row: 0 };
        let verdict = supervisor.tick(&CONFIG, &conditions);
        assert_eq!(verdict.mode, supervisor.mode());
        let stopped = matches!(mode, Mode::Armed | Mode::Flying) && !matches!(verdict.mode, Mode::Armed | Mode::Flying);
        assert_eq!(verdict.stopped, stopped, "{mode:?} to {:?}", verdict.mode);
        verdict.mode
    }

    #[test]
    fn every_transition_of_a_tick() {
        use StepReport::{Failed, NoReference};
        let with = |change: fn(&mut Conditions)| {
            let mut conditions = SOUND;
            change(&mut conditions);
            conditions
        };
        // Conditions, then what armed and what flying become.
        let rows = [
            (SOUND, Mode::Flying, Mode::Flying),
            (with(|c| c.state_age_ticks = Some(11)), Mode::Armed, stop(StopReason::StaleState)),
            (with(|c| c.state_age_ticks = None), Mode::Armed, stop(StopReason::StaleState)),
            (with(|c| c.step = NoReference), Mode::Armed, stop(StopReason::NoReference)),
            (with(|c| c.step = Failed), stop(StopReason::StepFailed), stop(StopReason::StepFailed)),
            (with(|c| c.link_silence_ticks = Some(21)), stop(StopReason::LinkLost), stop(StopReason::LinkLost)),
            (with(|c| c.link_silence_ticks = None), stop(StopReason::LinkLost), stop(StopReason::LinkLost)),
            (with(|c| c.overrun = true), stop(StopReason::Overrun), stop(StopReason::Overrun)),
            (with(|c| c.fault = Some(Fault::HardFault)), FAULTED, FAULTED),
        ];
        for (conditions, from_armed, from_flying) in rows {
            assert_eq!(after(Mode::Armed, conditions), from_armed, "armed, {conditions:?}");
            assert_eq!(after(Mode::Flying, conditions), from_flying, "flying, {conditions:?}");
            // Without a fault, nothing that a tick sees leaves a mode in which the motors are off.
            for off in [Mode::Disarmed(None), STOPPED, Mode::Faulted(Fault::StackExhausted)] {
                let expected = match (off, conditions.fault) {
                    (Mode::Disarmed(_), Some(fault)) => Mode::Faulted(fault),
                    _ => off,
                };
                assert_eq!(after(off, conditions), expected, "{off:?}, {conditions:?}");
            }
        }
    }

    #[test]
    fn the_first_of_several_reasons_is_named() {
        let mut conditions = Conditions {
            link_silence_ticks: None,
            state_age_ticks: None,
            step: StepReport::Failed,
            overrun: true,
            fault: Some(Fault::HardFault),
        };
        assert_eq!(after(Mode::Flying, conditions), FAULTED);
        conditions.fault = None;
        assert_eq!(after(Mode::Flying, conditions), stop(StopReason::Overrun));
        conditions.overrun = false;
        assert_eq!(after(Mode::Flying, conditions), stop(StopReason::LinkLost));
        conditions.link_silence_ticks = Some(0);
        assert_eq!(after(Mode::Flying, conditions), stop(StopReason::StepFailed));
        conditions.step = StepReport::NoReference;
        assert_eq!(after(Mode::Flying, conditions), stop(StopReason::StaleState));
        conditions.state_age_ticks = Some(0);
        assert_eq!(after(Mode::Flying, conditions), stop(StopReason::NoReference));
    }

    #[test]
    fn every_transition_of_a_request() {
        for mode in MODES {
            let mut armed = Supervisor { mode, overruns_in_a_row: 7 };
            let answer = armed.arm(&CONFIG, Some(20));
            let (expected, mode_after) = match mode {
                Mode::Disarmed(_) => (Ok(()), Mode::Armed),
                Mode::Faulted(fault) => (Err(ArmError::Faulted(fault)), mode),
                Mode::Armed | Mode::Flying => (Ok(()), mode),
            };
            assert_eq!((answer, armed.mode()), (expected, mode_after), "arm in {mode:?}");

            let mut disarmed = Supervisor { mode, overruns_in_a_row: 0 };
            disarmed.disarm();
            let mode_after = if matches!(mode, Mode::Armed | Mode::Flying) { STOPPED } else { mode };
            assert_eq!(disarmed.mode(), mode_after, "disarm in {mode:?}");
        }
    }

    #[test]
    fn a_silent_link_cannot_arm() {
        for silence in [None, Some(21)] {
            let mut supervisor = Supervisor::new();
            assert_eq!(supervisor.arm(&CONFIG, silence), Err(ArmError::LinkSilent));
            assert_eq!(supervisor.mode(), Mode::Disarmed(None));
        }
    }

    #[test]
    fn only_overruns_in_a_row_add_up_and_arming_forgets_them() {
        let config = Config { overruns_tolerated: 2, ..CONFIG };
        let mut supervisor = Supervisor::new();
        let tick =
            |supervisor: &mut Supervisor, overrun| supervisor.tick(&config, &Conditions { overrun, ..SOUND }).mode;
        (0..5).for_each(|_| assert_eq!(tick(&mut supervisor, true), Mode::Disarmed(None)));
        supervisor.arm(&config, Some(0)).unwrap();
        for overrun in [true, true, false, true, true] {
            assert_eq!(tick(&mut supervisor, overrun), Mode::Flying);
        }
        assert_eq!(tick(&mut supervisor, true), stop(StopReason::Overrun), "the third in a row");
    }

    #[test]
    fn only_flying_lets_a_command_through() {
        let command = Command { thrust_m_s2: 9.81, body_rates_rad_s: Vector3::new(1.0, 2.0, 3.0) };
        for mode in MODES {
            let passed = Verdict { mode, stopped: false }.gate(&command);
            let expected = if mode == Mode::Flying { command } else { Command::ZERO };
            assert_eq!(passed, expected, "{mode}");
            assert_eq!(mode.motors_allowed(), matches!(mode, Mode::Armed | Mode::Flying));
        }
    }
}
