//! One step of one table's controller: sample or reference, and state in; the output, into the outcome.

use quatrack::supervisor::Looked;
use quatrack::{
    FifthOrderSample, Followed, Handover, Heading, Measured, Memory, Output as LawOutput, Quaternion, Reference,
    ReferenceError, StepError, Target,
};

use super::outcome::{Outcome, Settings};
use crate::craft::Craft;
use crate::output::Output;
use crate::tables::Table;

/// Why a step gave nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unflown {
    /// No thrust gives the motion's acceleration: free fall, or upside down.
    Motion,
    /// The state, or the law at this state.
    State,
}

impl From<ReferenceError> for Unflown {
    fn from(_: ReferenceError) -> Self {
        Self::Motion
    }
}

impl From<StepError> for Unflown {
    fn from(error: StepError) -> Self {
        match error {
            StepError::Singular => Self::Motion,
            _ => Self::State,
        }
    }
}

/// The inputs of every law's step beside its table.
pub(super) struct LawStep<'a> {
    pub(super) craft: &'a Craft,
    pub(super) settings: &'a Settings,
    pub(super) sample: &'a FifthOrderSample,
    pub(super) heading: Heading,
    pub(super) followed: Followed,
    pub(super) looked: &'a Looked<'a>,
}

impl LawStep<'_> {
    /// Steps the law of a table.
    #[inline(always)]
    pub(super) fn step(&self, table: &Table, memory: &mut Memory, outcome: &mut Outcome) -> Result<(), Unflown> {
        if table.gives_forces() {
            match &self.controlled(table, memory, self.sampled()) {
                Ok(output) => self.put(output, Quaternion::IDENTITY, outcome),
                Err(error) => Err(Unflown::from(*error)),
            }
        } else {
            self.by_rates(table, memory, outcome)
        }
    }

    /// On the way from one table to another, both side by side.
    #[inline(never)]
    pub(super) fn hand_over(
        &self,
        handover: &mut Handover,
        (before, table): (&Table, &Table),
        memory: &mut Memory,
        outcome: &mut Outcome,
    ) -> Result<(), Unflown> {
        let to = |memory: &mut Memory| self.output(table, memory, outcome);
        // The new law's outcome is logged.
        let from = |memory: &mut Memory| self.output_before(before, memory);
        let output = handover.step_with(memory, Some(&table.actuation), self.measured(), to, from)?;
        let target = outcome.target;
        self.put(&output, target, outcome)
    }

    fn output_before(&self, table: &Table, memory: &mut Memory) -> Result<LawOutput, Unflown> {
        let mut outcome = Outcome::OFF;
        self.output(table, memory, &mut outcome)
    }

    /// The output of a table's law; its target into the outcome. Each out of line: the stack of two laws in one step is then that
    /// of the larger one, and the cascade's, which is the deepest, has no reference beside it.
    #[inline(always)]
    fn output(&self, table: &Table, memory: &mut Memory, outcome: &mut Outcome) -> Result<LawOutput, Unflown> {
        if table.gives_forces() { self.forces(table, memory) } else { self.command(table, memory, outcome) }
    }

    #[inline(never)]
    fn forces(&self, table: &Table, memory: &mut Memory) -> Result<LawOutput, Unflown> {
        Ok(self.controlled(table, memory, self.sampled())?)
    }

    #[inline(never)]
    fn command(&self, table: &Table, memory: &mut Memory, outcome: &mut Outcome) -> Result<LawOutput, Unflown> {
        let reference = &Reference::from_flat_at(&self.sample.flat, self.heading)?;
        outcome.target = reference.state().attitude;
        Ok(self.controlled(table, memory, Target::new(reference))?)
    }

    /// Steps a law of commands on a reference that has to be made.
    #[inline(never)]
    fn by_rates(&self, table: &Table, memory: &mut Memory, outcome: &mut Outcome) -> Result<(), Unflown> {
        self.follow(table, &Reference::from_flat_at(&self.sample.flat, self.heading)?, memory, outcome)
    }

    /// Steps a law of commands on a reference that is there.
    #[inline(always)]
    pub(super) fn follow(
        &self,
        table: &Table,
        reference: &Reference,
        memory: &mut Memory,
        outcome: &mut Outcome,
    ) -> Result<(), Unflown> {
        // References are looked at where they are: to move one out costs as much as the product with a gain.
        match &self.controlled(table, memory, Target::new(reference)) {
            Ok(output) => self.put(output, reference.state().attitude, outcome),
            Err(_) => Err(Unflown::State),
        }
    }

    /// The sample, for a law that makes a reference of its own.
    #[inline(always)]
    fn sampled(&self) -> Target<'_> {
        Target::with_sample(self.sample, self.heading).following(self.followed)
    }

    /// A step of a table's controller.
    #[inline(always)]
    fn controlled(&self, table: &Table, memory: &mut Memory, target: Target<'_>) -> Result<LawOutput, StepError> {
        let Settings { limits, feed_forward, .. } = *self.settings;
        table.step((limits, feed_forward), memory, self.measured(), target)
    }

    #[inline(always)]
    fn measured(&self) -> Measured<'_> {
        Measured::new(self.looked.state).with_body_rates(self.looked.body_rates_rad_s)
    }

    /// An output as the firmware takes it: a command goes through the body-rate loop to its mixer.
    #[inline(always)]
    fn put(&self, output: &LawOutput, target: Quaternion, outcome: &mut Outcome) -> Result<(), Unflown> {
        (outcome.target, outcome.limited, outcome.has_stepped) = (target, output.limited(), true);
        outcome.output = match output {
            LawOutput::Forces(step) => Output::Forces(step.forces_n),
            LawOutput::Command(step) => {
                Output::Wrench(self.craft.actuation.wrench(&step.command, self.looked.body_rates_rad_s)?)
            }
        };
        Ok(())
    }
}
