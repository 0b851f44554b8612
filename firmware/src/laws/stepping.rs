//! Measurements and a target in; the output of a step of the law in force, or of the way to it, out.

#[cfg(feature = "motors")]
use quatrack::MotorStep;
use quatrack::link::Table;
use quatrack::{Controller, Measured, Memory, Output, StepError, Target};

#[cfg(feature = "motors")]
use super::Follow;
use super::Laws;
use super::motors::step;

impl Laws {
    /// The kind of target for the laws that are stepped.
    #[cfg(feature = "motors")]
    #[inline]
    pub fn follow(&self) -> Follow {
        match (self.is_alone, self.controller.law().follows_samples()) {
            (true, true) => Follow::Samples,
            (true, false) => Follow::References,
            (false, _) => self.follow_together(),
        }
    }

    #[cfg(feature = "motors")]
    #[cold]
    #[inline(never)]
    fn follow_together(&self) -> Follow {
        let takes_samples = |choice| self.controller_of(choice).is_some_and(|c| c.law().follows_samples());
        let new = takes_samples(&self.choice);
        match (new, if self.handover.is_over() { new } else { takes_samples(&self.before) }) {
            (true, true) => Follow::Samples,
            (false, false) => Follow::References,
            _ => Follow::Both,
        }
    }

    /// The output of a step.
    ///
    /// # Errors
    /// As [`Controller::step`].
    #[inline]
    pub fn step(&mut self, measured: Measured<'_>, target: Target<'_>) -> Result<Output, StepError> {
        self.is_rescued = false;
        if self.is_alone {
            step(&self.controller, &mut self.memory, measured, target)
        } else {
            self.otherwise(measured, target)
        }
    }

    /// Motor forces for the output of a step.
    ///
    /// # Errors
    /// As [`Controller::carry`].
    #[cfg(feature = "motors")]
    #[inline(never)]
    pub fn carry(&mut self, output: &Output, measured: Measured<'_>) -> Result<MotorStep, StepError> {
        let actuation = self.actuations.of(self.choice.table).ok_or(StepError::NoActuation)?;
        self.controller.with_actuation(actuation).carry(&mut self.memory, output, measured)
    }

    /// A step of a loaded table, or on the way from one law to another.
    #[cold]
    #[inline(never)]
    fn otherwise(&mut self, measured: Measured<'_>, target: Target<'_>) -> Result<Output, StepError> {
        let (mut memory, mut handover) = (self.memory, self.handover);
        // The chosen table is on board; were it not, there would be no command.
        let Some(new) = self.controller_of(&self.choice) else { return Err(StepError::Singular) };
        let output = if handover.is_over() {
            step_apart(&new, &mut memory, measured, target)
        } else {
            let old = self.controller_of(&self.before).unwrap_or(new);
            let to = |memory: &mut Memory| step_apart(&new, memory, measured, target);
            let from = |memory: &mut Memory| step_apart(&old, memory, measured, target);
            handover.step_with(&mut memory, self.actuations.of(self.choice.table), measured, to, from)
        };
        (self.memory, self.handover) = (memory, handover);
        self.is_alone = self.handover.is_over() && !matches!(self.choice.table, Table::Loaded(_));
        output
    }
}

/// A step where one call more does not count.
#[inline(never)]
fn step_apart(
    controller: &Controller<'_>,
    memory: &mut Memory,
    measured: Measured<'_>,
    target: Target<'_>,
) -> Result<Output, StepError> {
    step(controller, memory, measured, target)
}
