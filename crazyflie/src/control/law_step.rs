//! One step of one law: table, sample or reference, and state in; the output, into the outcome.

use quatrack::law::ActuatorMemory;
use quatrack::mixer::{MotorLimited, Wrench};
use quatrack::{
    Equilibrium, FifthOrderSample, FlatOutput, Heading, MotorLaw, MotorReference, MotorTracker, Reference,
    ReferenceError, RigidState, StepError, Tracker,
};

use super::outcome::{Outcome, Settings};
use crate::craft::Craft;
use crate::output::Output;
use crate::tables::{Gains, MotorGains, Table};

/// Why a step gave nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unflown {
    /// The motion asks for what no thrust does: free fall, or upside down.
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
    fn from(_: StepError) -> Self {
        Self::State
    }
}

/// What every law's step takes beside its table.
pub(super) struct LawStep<'a> {
    pub(super) craft: &'a Craft,
    pub(super) settings: &'a Settings,
    pub(super) sample: &'a FifthOrderSample,
    pub(super) heading: Heading,
    pub(super) state: &'a RigidState,
}

impl LawStep<'_> {
    /// Steps the law of a table.
    #[inline(always)]
    pub(super) fn step(
        &self,
        table: &Table,
        memory: &mut ActuatorMemory,
        outcome: &mut Outcome,
    ) -> Result<(), Unflown> {
        match &table.gains {
            Gains::ActuatorAware(motors) => self.straight(motors, memory, outcome),
            _ => self.through_rates(table, outcome),
        }
    }

    /// The same for a second law in one step, whose stack is only that of its own kind.
    #[inline(always)]
    pub(super) fn step_beside(
        &self,
        table: &Table,
        memory: &mut ActuatorMemory,
        outcome: &mut Outcome,
    ) -> Result<(), Unflown> {
        match &table.gains {
            Gains::ActuatorAware(motors) => self.straight_beside(motors, memory, outcome),
            _ => self.through_rates(table, outcome),
        }
    }

    #[inline(never)]
    fn straight_beside(
        &self,
        motors: &MotorGains,
        memory: &mut ActuatorMemory,
        outcome: &mut Outcome,
    ) -> Result<(), Unflown> {
        self.straight(motors, memory, outcome)
    }

    #[inline(always)]
    fn straight(&self, motors: &MotorGains, memory: &mut ActuatorMemory, outcome: &mut Outcome) -> Result<(), Unflown> {
        let airframe = &motors.airframe;
        let tracker = MotorTracker::new(MotorLaw::ActuatorAware(motors.law()), airframe);
        // References are looked at where they lie: to move one out costs as much as the product with a gain.
        let Ok(reference) = &MotorReference::from_flat_at(self.sample, self.heading, airframe) else {
            return Err(Unflown::Motion);
        };
        let step = tracker.step(memory, self.state, reference)?;
        outcome.output = Output::Forces(step.forces_n);
        (outcome.limited, outcome.target) = (step.limited, reference.state().attitude);
        Ok(())
    }

    /// Steps a law of the paper on a reference that is there.
    #[inline(always)]
    pub(super) fn follow(&self, table: &Table, reference: &Reference, outcome: &mut Outcome) -> Result<(), Unflown> {
        let feed_forward = self.settings.feed_forward;
        let tracker = match &table.gains {
            Gains::Equilibrium(gain) => {
                Tracker::new(Equilibrium { feed_forward, ..Equilibrium::new(gain) }, self.settings.limits)
            }
            Gains::FlatOutput(gain) => Tracker::new(FlatOutput { gain, feed_forward }, self.settings.limits),
            Gains::ActuatorAware(_) => return Err(Unflown::State),
        };
        let step = tracker.step(&self.state.state, reference)?;
        let wrench = self.craft.body_rates.wrench(&step.command, &self.state.body_rates_rad_s);
        if !is_finite(&wrench) {
            return Err(Unflown::State);
        }
        outcome.output = Output::Wrench(wrench);
        outcome.limited = MotorLimited::from_bits(u16::from(step.limited.bits()) << 8);
        outcome.target = reference.state().attitude;
        Ok(())
    }

    /// Steps a law of the paper on a reference that has to be made.
    #[inline(never)]
    fn through_rates(&self, table: &Table, outcome: &mut Outcome) -> Result<(), Unflown> {
        self.follow(table, &Reference::from_flat_at(&self.sample.flat, self.heading)?, outcome)
    }
}

/// The gyroscope's readings come in here; the thrust has been looked at.
#[inline]
pub(super) fn is_finite(wrench: &Wrench) -> bool {
    let torque = &wrench.torque_n_m;
    (torque.x + torque.y + torque.z).abs() <= f32::MAX
}
