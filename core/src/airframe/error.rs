//! The figure that makes no craft, in; the sentence that names it, with the remedy, out.

use core::fmt;

/// A figure of a craft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AirframeFigure {
    /// [`super::AirframeFigures::mass_kg`].
    Mass,
    /// [`super::AirframeFigures::inertia_kg_m2`].
    Inertia,
    /// [`super::AirframeFigures::lever_arm_m`].
    LeverArm,
    /// [`super::AirframeFigures::torque_per_thrust_m`].
    TorquePerThrust,
    /// [`super::AirframeFigures::motor_lag_s`].
    MotorLag,
}

/// Why figures are no craft.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum AirframeError {
    /// A figure is not between a millionth (a billionth for the inertia) and a thousand of its SI unit: check the units.
    OutOfRange {
        /// The figure.
        figure: AirframeFigure,
        /// Its value.
        value: f32,
    },
    /// A moment of inertia exceeds the sum of the other two, which no body's does.
    Inertia {
        /// The largest moment, kg m^2.
        largest_kg_m2: f32,
        /// The sum of the others, kg m^2.
        others_kg_m2: f32,
    },
    /// `0 <= force_min_n < force_max_n` does not hold, or the motors cannot hold the weight within it.
    Force {
        /// Least force of a motor, N.
        min_n: f32,
        /// Most force, N.
        max_n: f32,
        /// A quarter of the weight, which has to lie between them, N.
        hover_n: f32,
    },
}

impl fmt::Display for AirframeFigure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Mass => "mass (kg)",
            Self::Inertia => "moment of inertia (kg m^2)",
            Self::LeverArm => "lever arm (m)",
            Self::TorquePerThrust => "torque per thrust (m)",
            Self::MotorLag => "motor lag (s)",
        })
    }
}

impl fmt::Display for AirframeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange { figure, value } => {
                write!(f, "airframe: {figure} is {value}; give it positive and in SI units")
            }
            Self::Inertia { largest_kg_m2, others_kg_m2 } => write!(
                f,
                "airframe: a moment of inertia, {largest_kg_m2} kg m^2, exceeds the sum of the others, {others_kg_m2}; \
                 check their order"
            ),
            Self::Force { min_n, max_n, hover_n } => write!(
                f,
                "airframe: motors of {min_n} to {max_n} N do not hold the weight, {hover_n} N each; check mass and forces"
            ),
        }
    }
}

impl core::error::Error for AirframeError {}
