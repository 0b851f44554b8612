//! One step of one law: table, sample or reference, and state in; the output, into the outcome.

use quatrack::law::ActuatorMemory;
use quatrack::mixer::{MotorLimited, Wrench};
use quatrack::{
    Airframe, Equilibrium, FifthOrderSample, FlatOutput, Heading, MotorLaw, MotorReference, MotorTracker, Reference,
    RigidState, StepError, Tracker,
};

use super::outcome::{Outcome, Output, Settings};
use crate::craft::Craft;
use crate::tables::{Gains, Table};

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
    ) -> Result<(), StepError> {
        if let Gains::ActuatorAware(motors) = &table.gains {
            let airframe = &motors.airframe;
            let tracker = MotorTracker::new(MotorLaw::ActuatorAware(motors.law()), airframe);
            // References are looked at where they lie: to move one out costs as much as the product with a gain.
            return match &MotorReference::from_flat_at(self.sample, self.heading, airframe) {
                Ok(reference) => self.straight(&tracker, reference, memory, outcome),
                Err(_) => self.straight_up(&tracker, airframe, memory, outcome),
            };
        }
        self.through_rates(table, outcome)
    }

    /// Steps a law of the paper on a reference that is there.
    #[inline(always)]
    pub(super) fn follow(&self, table: &Table, reference: &Reference, outcome: &mut Outcome) -> Result<(), StepError> {
        let feed_forward = self.settings.feed_forward;
        let tracker = match &table.gains {
            Gains::Equilibrium(gain) => {
                Tracker::new(Equilibrium { feed_forward, ..Equilibrium::new(gain) }, self.settings.limits)
            }
            Gains::FlatOutput(gain) => Tracker::new(FlatOutput { gain, feed_forward }, self.settings.limits),
            Gains::ActuatorAware(_) => return Err(StepError::Singular),
        };
        let step = tracker.step(&self.state.state, reference)?;
        let wrench = self.craft.body_rates.wrench(&step.command, &self.state.body_rates_rad_s);
        if !is_finite(&wrench) {
            return Err(StepError::Singular);
        }
        outcome.output = Output::Wrench(wrench);
        outcome.limited = MotorLimited::from_bits(u16::from(step.limited.bits()) << 8);
        outcome.target = reference.state().attitude;
        Ok(())
    }

    /// Steps a law of the paper on a reference that has to be made.
    #[inline(never)]
    fn through_rates(&self, table: &Table, outcome: &mut Outcome) -> Result<(), StepError> {
        let reference = match Reference::from_flat_at(&self.sample.flat, self.heading) {
            Ok(reference) => reference,
            Err(_) => Reference::from_flat_at(&self.upright().flat, self.heading).map_err(|_| StepError::Singular)?,
        };
        self.follow(table, &reference, outcome)
    }

    #[inline(always)]
    fn straight(
        &self,
        tracker: &MotorTracker<'_>,
        reference: &MotorReference,
        memory: &mut ActuatorMemory,
        outcome: &mut Outcome,
    ) -> Result<(), StepError> {
        let step = tracker.step(memory, self.state, reference)?;
        outcome.output = Output::Forces(step.forces_n);
        (outcome.limited, outcome.target) = (step.limited, reference.state().attitude);
        Ok(())
    }

    // Apart, so that no step pays for its stack.
    #[cold]
    #[inline(never)]
    fn straight_up(
        &self,
        tracker: &MotorTracker<'_>,
        airframe: &Airframe,
        memory: &mut ActuatorMemory,
        outcome: &mut Outcome,
    ) -> Result<(), StepError> {
        let upright =
            MotorReference::from_flat_at(&self.upright(), self.heading, airframe).map_err(|_| StepError::Singular)?;
        self.straight(tracker, &upright, memory, outcome)
    }

    /// Where the motion asks for what no thrust does (free fall, upside down): its position and velocity alone.
    #[cold]
    #[inline(never)]
    fn upright(&self) -> FifthOrderSample {
        let flat = &self.sample.flat;
        let mut sample = FifthOrderSample::at_rest(flat.position_m, 0.0);
        sample.flat.velocity_m_s = flat.velocity_m_s;
        sample
    }
}

/// The gyroscope's readings come in here; the thrust has been looked at.
#[inline]
pub(super) fn is_finite(wrench: &Wrench) -> bool {
    let torque = &wrench.torque_n_m;
    (torque.x + torque.y + torque.z).abs() <= f32::MAX
}
