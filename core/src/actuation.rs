//! From thrust over mass (m/s^2) and body rates (rad/s) to the forces of a craft's four motors (N), and from motor
//! commands to the forces behind their lag.

use nalgebra::Vector3;

use crate::airframe::Airframe;
use crate::body_rate::BodyRateLoop;
use crate::clock::Rate;
use crate::command::Command;
use crate::error::{StateError, StepError};
use crate::mixer::Wrench;
use crate::motor_lag::{MotorLag, MotorLagError};

/// A craft's way from a command to its motors, at a control rate: body-rate loop, mixer, and the lag by which motor
/// forces are predicted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Actuation {
    pub(crate) lag: MotorLag,
    pub(crate) airframe: Airframe,
    pub(crate) body_rates: BodyRateLoop,
}

impl Actuation {
    /// For a craft whose control steps come at `rate`, with the fastest body-rate loop that its motors' lag allows
    /// ([`BodyRateLoop::behind_lag`]).
    ///
    /// # Errors
    /// [`MotorLagError`] for a lag shorter than two control periods.
    pub const fn new(airframe: &Airframe, rate: Rate) -> Result<Self, MotorLagError> {
        match MotorLag::new(airframe.figures().motor_lag_s, rate) {
            Ok(lag) => Ok(Self::of(airframe, lag)),
            Err(error) => Err(error),
        }
    }

    const fn of(airframe: &Airframe, lag: MotorLag) -> Self {
        let body_rates = BodyRateLoop::behind_lag(airframe);
        Self { lag, airframe: *airframe, body_rates }
    }

    /// The same craft as a design reckons with it: its motors have that lag, and references for it are ahead by half a
    /// control period beside ([`Airframe::commanded_at`]).
    pub const fn reckoning_with(&self, lag: &MotorLag) -> Self {
        Self { body_rates: self.body_rates, ..Self::of(&self.airframe.reckoning_with(lag), *lag) }
    }

    /// With another body-rate loop.
    pub const fn with_body_rates(self, body_rates: BodyRateLoop) -> Self {
        Self { body_rates, ..self }
    }

    /// The craft, for references that reach to its motors.
    pub const fn airframe(&self) -> &Airframe {
        &self.airframe
    }

    /// The lag that motor forces are predicted with.
    pub const fn lag(&self) -> &MotorLag {
        &self.lag
    }

    /// From body rates to torque.
    pub const fn body_rates(&self) -> &BodyRateLoop {
        &self.body_rates
    }

    /// Thrust and torque for a command, at measured body rates (rad/s).
    ///
    /// # Errors
    /// [`StepError`] where a body rate is not finite, or the torque is beyond f32.
    #[inline(always)]
    pub fn wrench(&self, command: &Command, body_rates_rad_s: &Vector3<f32>) -> Result<Wrench, StepError> {
        let wrench = self.body_rates.wrench(command, body_rates_rad_s);
        // The thrust has been looked at when the command was cut.
        let torque = &wrench.torque_n_m;
        if (torque.x + torque.y + torque.z).abs() <= f32::MAX { Ok(wrench) } else { Err(refuse(body_rates_rad_s)) }
    }
}

/// Why a command is not carried: the command itself is finite.
#[cold]
#[inline(never)]
pub(crate) fn refuse(body_rates_rad_s: &Vector3<f32>) -> StepError {
    StateError::of_body_rates(body_rates_rad_s).map_or(StepError::Singular, StepError::State)
}
