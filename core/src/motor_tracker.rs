//! One control step to the motors: an estimated state with body rates and a reference in, four motor forces within their
//! range out, or the reason for none. Any law: the paper's go through the body-rate loop and the mixer, the
//! actuator-aware one straight to the forces.

use crate::airframe::Airframe;
use crate::body_rate::BodyRateLoop;
use crate::error::{Field, StateError, StepError};
use crate::law::{ActuatorAware, ActuatorMemory};
use crate::mixer::MotorLimited;
use crate::motor_lag::{MotorForces, MotorLag};
use crate::motor_reference::MotorReference;
use crate::rigid_state::RigidState;
use crate::tracker::Tracker;

/// A law on a craft, down to its motors. To be called at the rate of its lag.
///
/// What a law remembers is apart, in [`ActuatorMemory`], and is kept up by every law: another tracker with the same lag can
/// take over between two steps.
#[derive(Clone, Copy, Debug)]
pub struct MotorTracker<'a> {
    flown: Flown<'a>,
}

/// Any law, to be chosen at run time.
#[derive(Clone, Copy, Debug)]
pub enum MotorLaw<'a> {
    /// Thrust and body rates from a tracker, through the body-rate loop and the mixer.
    BodyRates(ByBodyRates<'a>),
    /// Straight to the forces.
    ActuatorAware(ActuatorAware<'a>),
}

/// Each law beside what it needs of the craft: a step then takes one pointer to both.
#[derive(Clone, Copy, Debug)]
enum Flown<'a> {
    BodyRates(Mixed<'a>),
    ActuatorAware(ActuatorAware<'a>),
}

#[derive(Clone, Copy, Debug)]
struct Mixed<'a> {
    law: ByBodyRates<'a>,
    airframe: Airframe,
}

/// A law of thrust and body rates with what carries it to the motors.
#[derive(Clone, Copy, Debug)]
pub struct ByBodyRates<'a> {
    /// The law and its limits.
    pub tracker: Tracker<'a>,
    /// From body rates to torque.
    pub body_rates: BodyRateLoop,
    /// The craft's, by which the motor forces are predicted for who takes over.
    pub lag: MotorLag,
}

/// What one step gives.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MotorStep {
    /// Commanded forces of M1 to M4, N, finite and within the motors' range.
    pub forces_n: MotorForces,
    /// What was given up to stay there.
    pub limited: MotorLimited,
}

impl<'a> MotorTracker<'a> {
    /// A law on a craft.
    pub const fn new(law: MotorLaw<'a>, airframe: &Airframe) -> Self {
        let flown = match law {
            MotorLaw::BodyRates(law) => Flown::BodyRates(Mixed { law, airframe: *airframe }),
            MotorLaw::ActuatorAware(law) => Flown::ActuatorAware(law),
        };
        Self { flown }
    }

    /// The commanded forces for this step. The measured quaternion may have either sign.
    ///
    /// # Errors
    /// [`StepError`] where state or body rates are not to be flown on or the law has no answer. There are then no forces and
    /// the memory is as it was: the caller stops or levels, and never holds the last ones.
    pub fn step(
        &self,
        memory: &mut ActuatorMemory,
        state: &RigidState,
        reference: &MotorReference,
    ) -> Result<MotorStep, StepError> {
        match &self.flown {
            Flown::ActuatorAware(law) => straight(law, memory, state, reference),
            Flown::BodyRates(mixed) => mixed.step(memory, state, reference),
        }
    }
}

// Both out of line, so that no law pays for the registers of another.

impl Mixed<'_> {
    #[inline(never)]
    fn step(
        &self,
        memory: &mut ActuatorMemory,
        state: &RigidState,
        reference: &MotorReference,
    ) -> Result<MotorStep, StepError> {
        let ByBodyRates { tracker, body_rates, lag } = &self.law;
        let step = tracker.step(&state.state, &reference.reference)?;
        let wrench = body_rates.wrench(&step.command, &state.body_rates_rad_s);
        let Some((forces_n, limited)) = self.airframe.mix(&wrench) else { return refuse(state) };
        memory.forces_n = lag.next(&memory.forces_n, &forces_n);
        Ok(MotorStep { forces_n, limited: limited.with_command(step.limited) })
    }
}

#[inline(never)]
fn straight(
    law: &ActuatorAware<'_>,
    memory: &mut ActuatorMemory,
    state: &RigidState,
    reference: &MotorReference,
) -> Result<MotorStep, StepError> {
    if state.state.measured().is_some()
        && let Some((forces_n, limited)) = law.step(memory, state, reference)
    {
        return Ok(MotorStep { forces_n, limited });
    }
    refuse(state)
}

/// Why there are no forces. The reference has been checked when it was made.
#[cold]
#[inline(never)]
fn refuse(state: &RigidState) -> Result<MotorStep, StepError> {
    let of_rates = |value: &f32| StateError::NonFinite { field: Field::BodyRates, value: *value };
    let rates = || state.body_rates_rad_s.iter().find(|rate| !rate.is_finite()).map(of_rates);
    Err(state.state.fault().or_else(rates).map_or(StepError::Singular, StepError::State))
}
