//! The output of a step, in SI units: a wrench for the firmware's mixer, or the four motors' forces.

use quatrack::MotorForces;
use quatrack::mixer::Wrench;

/// The output of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Output {
    /// For the firmware's mixer.
    Wrench(Wrench),
    /// Straight to the motors, N.
    Forces(MotorForces),
}

impl Output {
    /// Motors off.
    pub const OFF: Self = Self::Forces([0.0; 4]);
}
