//! What a step puts out, in SI units: a wrench for the firmware's mixer, or the four motors' forces.

use quatrack::MotorForces;
use quatrack::mixer::Wrench;

use crate::craft::Craft;

/// What a step puts out.
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

    /// As forces, N.
    pub fn forces_n(&self, craft: &Craft) -> MotorForces {
        match self {
            Self::Forces(forces) => *forces,
            Self::Wrench(wrench) => craft.airframe.mix(wrench).map_or([0.0; 4], |(forces, _)| forces),
        }
    }
}
