//! From one controller to another without a jump: both are stepped for a while, and their outputs mixed in changing shares.
//!
//! Swapping one static gain for another jumps the command by `(K1 - K2) e`: by nothing at zero error, by anything in a
//! corner. Over `n` steps the same difference comes in `n` parts. Two commands are mixed as commands; where one of the two
//! gives motor forces, the other's command is carried to the motors and forces are mixed.

use nalgebra::Vector3;

use super::controller::{Controller, carried};
use super::input::{Measured, Target};
use super::law::Law;
use super::memory::Memory;
use super::output::{MotorStep, Output, Step};
use crate::actuation::Actuation;
use crate::command::{Command, Limited};
use crate::error::StepError;
use crate::mixer::MotorLimited;
use crate::motor_lag::MotorForces;

/// How far the way from one controller to the other is. Each step of it takes as long as both controllers' steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Handover {
    steps: u16,
    done: u16,
    /// Of the controller on its way out.
    memory: Memory,
}

impl Handover {
    /// Nobody hands over to anybody.
    pub const OVER: Self = Self { steps: 0, done: 0, memory: Memory::at_rest() };

    /// The way from `old` to `new` in so many steps, the last of which is the new one's alone; 0 and 1 swap at once. The
    /// old one's integral goes on with the new one only where it means the same to it.
    #[inline]
    pub fn begin(steps: u16, old: &Law<'_>, new: &Law<'_>, memory: &mut Memory) -> Self {
        let mut way = Self::OVER;
        way.begin_again(steps, old, new, memory);
        way
    }

    /// The same in the place of another: a memory is large where a stack is small.
    #[inline]
    pub fn begin_again(&mut self, steps: u16, old: &Law<'_>, new: &Law<'_>, memory: &mut Memory) {
        (self.steps, self.done) = (steps, 0);
        self.memory = *memory;
        if !old.integrates_like(new) {
            memory.clear_integral();
        }
        #[cfg(feature = "cascade")]
        if new.follows_samples() && !old.follows_samples() {
            memory.cascade.begin_in_flight();
        }
    }

    /// The way in so many steps between laws that remember nothing.
    #[inline]
    pub const fn of_commands(steps: u16) -> Self {
        Self { steps, ..Self::OVER }
    }

    /// Ends it here.
    #[inline]
    pub const fn end(&mut self) {
        self.done = self.steps;
    }

    /// Whether the way is over: from then on the new controller is stepped alone.
    #[inline]
    pub const fn is_over(&self) -> bool {
        self.done >= self.steps
    }

    /// The next step on the way, both controllers towards one target. Its output is between theirs, and so within the limits of
    /// both wherever those are the same; it is theirs to the bit where they agree.
    ///
    /// # Errors
    /// [`StepError`] of the new controller. Where only the old one has no answer, the new one's counts at once.
    pub fn step(
        &mut self,
        (old, new): (&Controller<'_>, &Controller<'_>),
        memory: &mut Memory,
        measured: Measured<'_>,
        target: Target<'_>,
    ) -> Result<Output, StepError> {
        let actuation = new.actuation.or(old.actuation);
        let to = |memory: &mut Memory| new.step(memory, measured, target);
        let from = |memory: &mut Memory| old.step(memory, measured, target);
        self.step_with(memory, actuation, measured, to, from)
    }

    /// The same for controllers that make their own targets. `to` steps the new one on `memory`, `from` the old one on
    /// its own memory; both are given motors that have followed the mixed forces so far.
    ///
    /// # Errors
    /// Those of the new one.
    pub fn step_with<E>(
        &mut self,
        memory: &mut Memory,
        actuation: Option<&Actuation>,
        measured: Measured<'_>,
        to: impl FnOnce(&mut Memory) -> Result<Output, E>,
        from: impl FnOnce(&mut Memory) -> Result<Output, E>,
    ) -> Result<Output, E> {
        let before_n = memory.forces_n;
        let to = to(memory)?;
        self.done = self.done.saturating_add(1);
        if !self.is_over() {
            self.memory.forces_n = before_n;
            if let Ok(from) = from(&mut self.memory)
                && let Some(output) = self.mixed(memory, actuation, measured, (&from, &to), before_n)
            {
                return Ok(output);
            }
        }
        self.done = self.steps;
        Ok(to)
    }

    /// The mixture of two outputs at this step of the way; nothing where one of them cannot be carried to the motors.
    #[inline]
    fn mixed(
        &mut self,
        memory: &mut Memory,
        actuation: Option<&Actuation>,
        measured: Measured<'_>,
        (from, to): (&Output, &Output),
        before_n: MotorForces,
    ) -> Option<Output> {
        let share = f32::from(self.done) / f32::from(self.steps);
        if let (Output::Command(from), Output::Command(to)) = (from, to) {
            return Some(Output::Command(between_commands(from, to, share)));
        }
        let step = between_carried(actuation?, measured, (from, to), share)?;
        memory.forces_n = actuation?.lag.next(&before_n, &step.forces_n);
        Some(Output::Forces(step))
    }
}

/// Both carried to the motors.
#[inline(never)]
fn between_carried(
    actuation: &Actuation,
    measured: Measured<'_>,
    (from, to): (&Output, &Output),
    share: f32,
) -> Option<MotorStep> {
    let to_motors = |output: &Output| carried(Some(actuation), output, measured).ok();
    Some(between_forces(&to_motors(from)?, &to_motors(to)?, share))
}

/// `share` of the way from one number to another; `share` below 1 and a multiple of 1/65535, which no rounding takes beyond
/// either end.
#[inline]
fn between(from: f32, to: f32, share: f32) -> f32 {
    from + (to - from) * share
}

fn between_commands(from: &Step, to: &Step, share: f32) -> Step {
    let (a, b) = (&from.command.body_rates_rad_s, &to.command.body_rates_rad_s);
    Step {
        command: Command {
            thrust_m_s2: between(from.command.thrust_m_s2, to.command.thrust_m_s2, share),
            body_rates_rad_s: Vector3::new(
                between(a.x, b.x, share),
                between(a.y, b.y, share),
                between(a.z, b.z, share),
            ),
        },
        limited: Limited::from_bits(from.limited.bits() | to.limited.bits()),
    }
}

fn between_forces(from: &MotorStep, to: &MotorStep, share: f32) -> MotorStep {
    let ([a1, a2, a3, a4], [b1, b2, b3, b4]) = (from.forces_n, to.forces_n);
    MotorStep {
        forces_n: [between(a1, b1, share), between(a2, b2, share), between(a3, b3, share), between(a4, b4, share)],
        limited: MotorLimited::from_bits(from.limited.bits() | to.limited.bits()),
    }
}

#[cfg(test)]
mod tests;
