//! The result of the last step in; its output, the message that answers the state, once, and the counts of steps, out.

use quatrack::link::{CommandOut, ForcesOut, FromBoard, NoCommand};
use quatrack::{Command, MotorForces, Output, Tick};

use super::Flight;
use crate::vehicle::STOPPED;

/// A step and its result.
pub(super) struct Answer {
    pub(super) tick: Tick,
    pub(super) state_tick: Tick,
    pub(super) result: Result<Output, NoCommand>,
}

impl Flight {
    /// The command that passes; zero under a law that gives none.
    pub fn command(&self) -> &Command {
        &self.passed
    }

    /// The motor forces that pass, N.
    pub fn forces_n(&self) -> &MotorForces {
        self.motors.forces_n()
    }

    /// Those that motors are to be driven to: none in lock-step, where it is not this craft that flies.
    #[inline]
    pub fn driven_forces_n(&self) -> &MotorForces {
        if self.is_lock_step() { &STOPPED } else { self.motors.forces_n() }
    }

    /// The answer to the last state, once.
    pub fn take_message(&mut self) -> Option<FromBoard> {
        let is_new = core::mem::take(&mut self.is_answer_new);
        is_new.then(|| self.message())
    }

    fn message(&self) -> FromBoard {
        let Answer { tick, state_tick, result } = &self.answer;
        let (tick, state_tick) = (*tick, *state_tick);
        match result {
            Ok(Output::Command(step)) => FromBoard::Command(CommandOut { tick, state_tick, result: Ok(*step) }),
            Ok(Output::Forces(step)) => FromBoard::Forces(ForcesOut { tick, state_tick, result: Ok(*step) }),
            Err(reason) if self.motors.answers_by_forces() => {
                FromBoard::Forces(ForcesOut { tick, state_tick, result: Err(*reason) })
            }
            Err(reason) => FromBoard::Command(CommandOut { tick, state_tick, result: Err(*reason) }),
        }
    }

    /// The same, if it is a command.
    pub fn take_answer(&mut self) -> Option<CommandOut> {
        match self.take_message()? {
            FromBoard::Command(command) => Some(command),
            _ => None,
        }
    }

    /// Steps taken, and those without a command.
    pub fn steps(&self) -> (u32, u32) {
        (self.steps, self.steps_failed)
    }
}
