//! Errors of the estimator: the figure, its value and the range that it should have.

use core::fmt;

/// A number that the estimator is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum EstimatorFigure {
    /// [`super::EstimatorConfig::drag_per_s`], 1/s.
    Drag,
    /// [`super::EstimatorConfig::acceleration_noise`], m/s^2 per root hertz.
    AccelerationNoise,
    /// [`super::EstimatorConfig::gyro_noise`], rad/s per root hertz.
    GyroNoise,
    /// [`super::EstimatorConfig::deviation_min`] or [`super::EstimatorConfig::deviation_max`].
    DeviationLimit,
    /// A figure of [`super::EstimatorConfig::at_start`].
    DeviationAtStart,
    /// Body rates of the gyroscope, rad/s.
    BodyRates,
    /// Specific force of the accelerometer, m/s^2.
    SpecificForce,
    /// Time to predict over, s.
    Period,
    /// Angle that the craft turns by within one prediction, rad.
    Turn,
    /// A position, a coordinate of it, or a distance, m.
    Position,
    /// A velocity, m/s.
    Velocity,
    /// Squared norm of an attitude's quaternion.
    AttitudeNorm,
    /// Standard deviation of a measurement, in its unit.
    MeasurementDeviation,
}

impl EstimatorFigure {
    const fn name(self) -> &'static str {
        match self {
            Self::Drag => "drag per mass, 1/s",
            Self::AccelerationNoise => "acceleration noise, m/s^2 per root hertz",
            Self::GyroNoise => "gyroscope noise, rad/s per root hertz",
            Self::DeviationLimit => "limit of the standard deviations",
            Self::DeviationAtStart => "standard deviation at the start",
            Self::BodyRates => "body rate, rad/s",
            Self::SpecificForce => "specific force, m/s^2 (an accelerometer in g?)",
            Self::Period => "time to predict over, s",
            Self::Turn => "turn within one prediction, rad (predict more often)",
            Self::Position => "position or distance, m",
            Self::Velocity => "velocity, m/s",
            Self::AttitudeNorm => "squared norm of the attitude (scalar first?)",
            Self::MeasurementDeviation => "standard deviation of the measurement",
        }
    }
}

/// Why the estimator refused its input.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum EstimatorError {
    /// A figure is not a number or not within its range. The estimate stays as it was.
    OutOfRange {
        /// The figure.
        figure: EstimatorFigure,
        /// Its value.
        value: f32,
        /// Least that is taken.
        min: f32,
        /// Most that is taken.
        max: f32,
    },
    /// The step would have left the range of the numbers or of a craft. The estimate stays as it was, with the
    /// covariance of a start: it trusts the next measurements again.
    Restarted,
}

impl fmt::Display for EstimatorError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange { figure, value, min, max } => {
                write!(f, "estimator: {} is {value}; give {min} to {max}", figure.name())
            }
            Self::Restarted => {
                f.write_str("estimator: the estimate ran away; its covariance starts anew, measure a pose")
            }
        }
    }
}

impl core::error::Error for EstimatorError {}

/// Lets a value pass that lies within the range; NaN does not.
pub(super) const fn within(figure: EstimatorFigure, value: f32, min: f32, max: f32) -> Result<(), EstimatorError> {
    if value >= min && value <= max { Ok(()) } else { Err(EstimatorError::OutOfRange { figure, value, min, max }) }
}

/// The same for every one of several values, within plus and minus the most.
#[inline]
pub(super) fn all_within(figure: EstimatorFigure, values: [f32; 3], max: f32) -> Result<(), EstimatorError> {
    let [x, y, z] = values;
    within(figure, x, -max, max)?;
    within(figure, y, -max, max)?;
    within(figure, z, -max, max)
}
