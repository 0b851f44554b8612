//! One control step to the motors: an estimated state, the gyroscope and a reference in, four motor forces within their
//! range out, or the reason for none. Any law: the paper's go through the body-rate loop and the mixer, the
//! actuator-aware one straight to the forces.

use nalgebra::Vector3;

use crate::airframe::Airframe;
use crate::body_rate::BodyRateLoop;
use crate::error::{Field, StateError, StepError};
use crate::law::{ActuatorAware, ActuatorMemory};
use crate::mixer::MotorLimited;
use crate::motor_lag::{MotorForces, MotorLag};
use crate::motor_reference::MotorReference;
use crate::state::State;
use crate::tracker::Tracker;

/// A law on a craft, down to its motors. To be called at the rate of its lag.
///
/// What a law remembers is apart, in [`ActuatorMemory`], and is kept up by every law: another tracker with the same lag can
/// take over between two steps.
#[derive(Clone, Copy, Debug)]
pub struct MotorTracker<'a> {
    airframe: Airframe,
    law: MotorLaw<'a>,
}

/// How the forces are found.
#[derive(Clone, Copy, Debug)]
pub enum MotorLaw<'a> {
    /// Thrust and body rates from a tracker, through the body-rate loop and the mixer.
    BodyRates {
        /// The law and its limits.
        tracker: Tracker<'a>,
        /// From body rates to torque.
        body_rates: BodyRateLoop,
        /// By which the motor forces are predicted for who takes over.
        lag: MotorLag,
    },
    /// Straight to the forces.
    ActuatorAware(ActuatorAware<'a>),
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
        Self { airframe: *airframe, law }
    }

    /// The craft.
    pub const fn airframe(&self) -> &Airframe {
        &self.airframe
    }

    /// The commanded forces for this step. The measured quaternion may have either sign.
    ///
    /// # Errors
    /// [`StepError`] where state or body rates are not to be flown on or the law has no answer. There are then no forces and
    /// the memory is as it was: the caller stops or levels, and never holds the last ones.
    pub fn step(
        &self,
        memory: &mut ActuatorMemory,
        state: &State,
        body_rates_rad_s: &Vector3<f32>,
        reference: &MotorReference,
    ) -> Result<MotorStep, StepError> {
        match &self.law {
            MotorLaw::ActuatorAware(law) => straight(law, memory, state, body_rates_rad_s, reference),
            MotorLaw::BodyRates { tracker, body_rates, lag } => {
                let step = tracker.step(state, &reference.reference)?;
                let wrench = body_rates.wrench(&step.command, body_rates_rad_s);
                let Some((forces_n, limited)) = self.airframe.mix(&wrench) else {
                    return refuse(state, body_rates_rad_s);
                };
                memory.forces_n = lag.next(&memory.forces_n, &forces_n);
                Ok(MotorStep { forces_n, limited: limited.with_command(step.limited) })
            }
        }
    }
}

/// Out of line, so that no law pays for the registers of another.
#[inline(never)]
fn straight(
    law: &ActuatorAware<'_>,
    memory: &mut ActuatorMemory,
    state: &State,
    body_rates_rad_s: &Vector3<f32>,
    reference: &MotorReference,
) -> Result<MotorStep, StepError> {
    let Some(measured) = state.measured() else { return refuse(state, body_rates_rad_s) };
    match law.step(memory, &measured, body_rates_rad_s, reference) {
        Some((forces_n, limited)) => Ok(MotorStep { forces_n, limited }),
        None => refuse(state, body_rates_rad_s),
    }
}

/// Why there are no forces. The reference has been checked when it was made.
#[cold]
#[inline(never)]
fn refuse(state: &State, body_rates_rad_s: &Vector3<f32>) -> Result<MotorStep, StepError> {
    let of_rates = |value: &f32| StateError::NonFinite { field: Field::BodyRates, value: *value };
    let rates = || body_rates_rad_s.iter().find(|rate| !rate.is_finite()).map(of_rates);
    Err(state.fault().or_else(rates).map_or(StepError::Singular, StepError::State))
}
