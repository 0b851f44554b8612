//! The output of a step: thrust and body rates, or the forces of the motors.

use crate::command::{Command, Limited};
use crate::mixer::MotorLimited;
use crate::motor_lag::MotorForces;

/// The output of a controller's step, as its law has it; [`super::Controller::carry`] makes motor forces of either.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Output {
    /// Thrust and body rates.
    Command(Step),
    /// Motor forces.
    Forces(MotorStep),
}

/// Thrust and body rates of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Step {
    /// The command, finite and within the limits.
    pub command: Command,
    /// The limits that cut it.
    pub limited: Limited,
}

/// Motor forces of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MotorStep {
    /// Commanded forces of M1 to M4, N, finite and within the motors' range.
    pub forces_n: MotorForces,
    /// The limits that cut them, the command's included.
    pub limited: MotorLimited,
}

impl Output {
    /// The command, if the law gives one.
    #[inline]
    pub const fn command(&self) -> Option<&Step> {
        match self {
            Self::Command(step) => Some(step),
            Self::Forces(_) => None,
        }
    }

    /// The limits that cut the output.
    #[inline]
    pub const fn limited(&self) -> MotorLimited {
        match self {
            Self::Command(step) => MotorLimited::of_command(step.limited),
            Self::Forces(step) => step.limited,
        }
    }
}
