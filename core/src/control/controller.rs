//! One control step of any law: the measurements and the reference in, an output within the limits out, or the
//! reason for none.

use nalgebra::Vector3;

use super::input::{Measured, Target};
use super::law::Law;
use super::memory::Memory;
use super::output::{MotorStep, Output, Step};
use super::registers;
use crate::actuation::Actuation;
#[cfg(feature = "cascade")]
use crate::cascade::{Cascade, CascadeInput};
use crate::command::Limits;
use crate::error::{StateError, StepError};
#[cfg(feature = "actuator-aware")]
use crate::law::ActuatorAware;
use crate::law::{AlongTrajectory, IntegralAction};

/// A law, the limits that its commands keep to, and the actuation that carries them to the motors. To be called at a
/// fixed rate.
///
/// Its memory is apart, in [`Memory`]: a flight begins with a new one, and another controller can take over between
/// two steps with the same.
#[derive(Clone, Copy, Debug)]
pub struct Controller<'a> {
    pub(super) law: Law<'a>,
    pub(super) limits: Limits,
    pub(super) actuation: Option<&'a Actuation>,
}

impl<'a> Controller<'a> {
    /// A controller that flies `law` within `limits`. A law of motor forces keeps to the motors' range instead, and has brought
    /// their figures.
    #[inline]
    pub fn new(law: impl Into<Law<'a>>, limits: Limits) -> Self {
        let law = law.into();
        let actuation = match &law {
            #[cfg(feature = "actuator-aware")]
            Law::ActuatorAware(law) => Some(law.actuation),
            #[cfg(feature = "cascade")]
            Law::Cascade(law) => Some(law.actuation()),
            _ => None,
        };
        Self { law, limits, actuation }
    }

    /// With the actuation that carries commands to the motors; a law of motor forces keeps its own.
    #[inline]
    pub const fn with_actuation(self, actuation: &'a Actuation) -> Self {
        match self.law {
            #[cfg(feature = "actuator-aware")]
            Law::ActuatorAware(_) => self,
            #[cfg(feature = "cascade")]
            Law::Cascade(_) => self,
            _ => Self { actuation: Some(actuation), ..self },
        }
    }

    /// The law.
    pub const fn law(&self) -> &Law<'a> {
        &self.law
    }

    /// The limits.
    pub const fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The actuation that carries commands to the motors.
    pub const fn actuation(&self) -> Option<&'a Actuation> {
        self.actuation
    }

    /// The output for this step.
    ///
    /// # Errors
    /// [`StepError`] where the state is not finite, the law has no answer, or lacks an input. There is then no output,
    /// and the memory is as it was: the caller stops or levels, and never holds the last output.
    #[inline(always)]
    pub fn step(&self, memory: &mut Memory, measured: Measured<'_>, target: Target<'_>) -> Result<Output, StepError> {
        match &self.law {
            #[cfg(feature = "cascade")]
            Law::Cascade(law) => {
                let output = cascade(law, memory, measured, target)?;
                law.observe(&mut memory.cascade, measured.specific_force_m_s2);
                Ok(output)
            }
            _ => self.step_unobserved(memory, measured, target),
        }
    }

    /// The same without the law's observers, which can wait until the motors have their forces: for a caller with little
    /// time at the step, which calls [`Self::observe`] before the next one.
    ///
    /// # Errors
    /// As [`Self::step`].
    #[inline(always)]
    pub fn step_unobserved(
        &self,
        memory: &mut Memory,
        measured: Measured<'_>,
        target: Target<'_>,
    ) -> Result<Output, StepError> {
        match &self.law {
            Law::Equilibrium(_) => registers::equilibrium(self, measured.state, target.reference),
            Law::FlatOutput(_) => registers::flat_output(self, measured.state, target.reference),
            Law::IntegralAction(law) => integral(law, &self.limits, memory, measured, target),
            Law::AlongTrajectory(law) => along(law, &self.limits, measured, target),
            #[cfg(feature = "actuator-aware")]
            Law::ActuatorAware(law) => actuator_aware(law, memory, measured, target),
            #[cfg(feature = "cascade")]
            Law::Cascade(law) => cascade(law, memory, measured, target),
        }
    }

    /// The observers' update after [`Self::step_unobserved`], with the accelerometer's specific force in the body frame,
    /// m/s^2: observers, where the law has any.
    #[inline(always)]
    pub fn observe(&self, memory: &mut Memory, specific_force_m_s2: Option<&Vector3<f32>>) {
        #[cfg(feature = "cascade")]
        if let Law::Cascade(law) = &self.law {
            law.observe(&mut memory.cascade, specific_force_m_s2);
        }
        #[cfg(not(feature = "cascade"))]
        let _ = (memory, specific_force_m_s2);
    }

    /// Motor forces for the output of a step, at the body rates that it was taken on; those of a law that gives forces as
    /// they are.
    ///
    /// # Errors
    /// [`StepError::NoBodyRates`] and [`StepError::NoActuation`] where a command cannot be carried; [`StepError::State`] for
    /// body rates that are not finite.
    #[inline]
    pub fn carry(&self, memory: &mut Memory, output: &Output, measured: Measured<'_>) -> Result<MotorStep, StepError> {
        let step = carried(self.actuation, output, measured)?;
        if let (Output::Command(_), Some(actuation)) = (output, self.actuation) {
            memory.forces_n = actuation.lag.next(&memory.forces_n, &step.forces_n);
        }
        Ok(step)
    }

    /// Both in one: a step down to the motors.
    ///
    /// # Errors
    /// As [`Self::step`] and [`Self::carry`].
    pub fn step_to_motors(
        &self,
        memory: &mut Memory,
        measured: Measured<'_>,
        target: Target<'_>,
    ) -> Result<MotorStep, StepError> {
        let integral_m_s = memory.integral_m_s;
        let output = self.step(memory, measured, target)?;
        // Forces of a law are carried as they are: only one that may integrate can fail to be.
        self.carry(memory, &output, measured).inspect_err(|_| memory.integral_m_s = integral_m_s)
    }
}

/// Motor forces for an output.
#[inline]
pub(super) fn carried(
    actuation: Option<&Actuation>,
    output: &Output,
    measured: Measured<'_>,
) -> Result<MotorStep, StepError> {
    match output {
        Output::Forces(step) => Ok(*step),
        Output::Command(step) => {
            let body_rates_rad_s = measured.body_rates_rad_s.ok_or(StepError::NoBodyRates)?;
            actuation.ok_or(StepError::NoActuation)?.carried(step, body_rates_rad_s)
        }
    }
}

// Each out of line, so that no law pays for the registers of another. The actuator-aware one, which flies where there is a system
// alone, is inlined: a caller there can compile it for instructions that not every processor has.

#[inline(never)]
fn integral(
    law: &IntegralAction<'_>,
    limits: &Limits,
    memory: &mut Memory,
    measured: Measured<'_>,
    target: Target<'_>,
) -> Result<Output, StepError> {
    let Some(state) = measured.state.normalized() else { return Err(refuse(measured)) };
    let sum = &mut memory.integral_m_s;
    let Some((command, limited)) = limits.saturate(&law.command(sum, &state, target.reference)) else {
        return Err(refuse(measured));
    };
    *sum = law.advanced(sum, measured.state, target.reference, limited);
    Ok(Output::Command(Step { command, limited }))
}

#[inline(never)]
fn along(
    law: &AlongTrajectory<'_>,
    limits: &Limits,
    measured: Measured<'_>,
    target: Target<'_>,
) -> Result<Output, StepError> {
    let Some(state) = measured.state.normalized() else { return Err(refuse(measured)) };
    match limits.saturate(&law.command(target.progress, &state, target.reference)) {
        Some((command, limited)) => Ok(Output::Command(Step { command, limited })),
        None => Err(refuse(measured)),
    }
}

#[cfg(feature = "actuator-aware")]
#[inline(always)]
fn actuator_aware(
    law: &ActuatorAware<'_>,
    memory: &mut Memory,
    measured: Measured<'_>,
    target: Target<'_>,
) -> Result<Output, StepError> {
    let Some(body_rates_rad_s) = measured.body_rates_rad_s else { return Err(StepError::NoBodyRates) };
    let Some(reference) = target.motors else { return Err(StepError::NoForces) };
    let state = measured.state;
    if state.normalized().is_some()
        && let Some((forces_n, limited)) =
            law.step((&mut memory.forces_n, &mut memory.integral_m_s), state, body_rates_rad_s, reference)
    {
        return Ok(Output::Forces(MotorStep { forces_n, limited }));
    }
    // Copies, so that only a refusal has them in memory where this is inlined.
    let copies = (*state, *body_rates_rad_s);
    Err(refuse(Measured::new(&copies.0).with_body_rates(&copies.1)))
}

#[cfg(feature = "cascade")]
#[inline(never)]
fn cascade(
    law: &Cascade,
    memory: &mut Memory,
    measured: Measured<'_>,
    target: Target<'_>,
) -> Result<Output, StepError> {
    let Some(body_rates_rad_s) = measured.body_rates_rad_s else { return Err(StepError::NoBodyRates) };
    let Some((sample, heading)) = target.sample else { return Err(StepError::NoSample) };
    let input = CascadeInput { state: measured.state, body_rates_rad_s, sample, heading, followed: target.followed };
    let Memory { forces_n, cascade, .. } = memory;
    let (forces_n, limited) = law.command(cascade, forces_n, &input)?;
    Ok(Output::Forces(MotorStep { forces_n, limited }))
}

/// Why there is no output. The reference has been checked when it was made.
#[cold]
#[inline(never)]
fn refuse(measured: Measured<'_>) -> StepError {
    let rates = || measured.body_rates_rad_s.and_then(StateError::of_body_rates);
    measured.state.fault().or_else(rates).map_or(StepError::Singular, StepError::State)
}
