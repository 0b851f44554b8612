//! A command of thrust (m/s^2) and body rates (rad/s) carried to motor forces (N): body-rate loop and mixer.

use nalgebra::Vector3;

use super::output::{MotorStep, Step};
use crate::actuation::{Actuation, refuse};
use crate::error::StepError;

impl Actuation {
    /// Motor forces for a step's command, at measured body rates (rad/s).
    ///
    /// # Errors
    /// As [`Self::wrench`].
    #[inline]
    pub fn carried(&self, step: &Step, body_rates_rad_s: &Vector3<f32>) -> Result<MotorStep, StepError> {
        let wrench = self.body_rates.wrench(&step.command, body_rates_rad_s);
        let Some((forces_n, limited)) = self.airframe.mix(&wrench) else { return Err(refuse(body_rates_rad_s)) };
        Ok(MotorStep { forces_n, limited: limited.with_command(step.limited) })
    }
}
