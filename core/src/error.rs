//! All errors, one small enum for each place where input comes in; every variant carries the offending value and names
//! the remedy.

use core::fmt;

use nalgebra::Vector3;

/// A group of numbers in a state or a flat sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Field {
    /// Position, m.
    Position,
    /// Attitude quaternion.
    Attitude,
    /// Velocity, m/s.
    Velocity,
    /// Acceleration, m/s^2.
    Acceleration,
    /// Jerk, m/s^3.
    Jerk,
    /// Heading, rad.
    Heading,
    /// Heading rate, rad/s.
    HeadingRate,
    /// Measured body rates, rad/s.
    BodyRates,
    /// Snap and crackle, m/s^4 and m/s^5.
    SnapAndCrackle,
    /// Second and third derivative of the heading, rad/s^2 and rad/s^3.
    HeadingDerivatives,
}

impl fmt::Display for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Position => "position",
            Self::Attitude => "attitude",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
            Self::Heading => "heading",
            Self::HeadingRate => "heading rate",
            Self::BodyRates => "body rates",
            Self::SnapAndCrackle => "snap or crackle",
            Self::HeadingDerivatives => "heading acceleration or jerk",
        })
    }
}

/// The first number that is not finite and its place, from groups of three numbers in the order of `fields`.
///
/// On slices and out of line: it is small, and no caller needs it to be fast.
#[cold]
#[inline(never)]
pub(crate) fn first_non_finite(fields: &[Field], values: &[f32]) -> Option<(Field, f32)> {
    let (index, value) = values.iter().enumerate().find(|(_, value)| !value.is_finite())?;
    fields.get(index / 3).map(|field| (*field, *value))
}

/// Why an estimated state cannot be flown on.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StateError {
    /// A component is infinite or not a number: distrust the estimator.
    NonFinite {
        /// The field.
        field: Field,
        /// The value found.
        value: f32,
    },
    /// The quaternion is no rotation: check its scaling and order (scalar first).
    QuaternionNorm {
        /// Its squared norm, which should be 1.
        norm_squared: f32,
    },
}

/// Why a flat output is no flyable reference.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ReferenceError {
    /// A component is infinite or not a number: distrust the planner or the link.
    NonFinite {
        /// The field.
        field: Field,
        /// The value found.
        value: f32,
    },
    /// Free fall: without thrust the attitude is not determined. Plan with a thrust bound.
    NoThrust {
        /// The thrust that the acceleration asks for, m/s^2.
        thrust_m_s2: f32,
    },
    /// The thrust would point down: the tilt of 180 degrees has no heading. Plan with a tilt bound.
    Inverted {
        /// Vertical component of the thrust's direction.
        axis_z: f32,
    },
    /// A heading or a `q3` that the flat map cannot reach at this tilt: `|q3| > cos(tilt / 2)`.
    HeadingInfeasible {
        /// The third vector component of the quaternion that was asked for.
        q3: f32,
    },
}

/// Why a step gave no command. The caller must not hold the last one: stop the motors or level.
///
/// Boards send it: its variants keep their order, with every feature and without.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StepError {
    /// The state is the reason.
    State(StateError),
    /// State and reference are sound, but the law asks for an attitude at which the flat map is singular (free fall,
    /// thrust downwards, heading half a turn off), or for numbers beyond the range of f32.
    Singular,
    /// The measurement has no body rates, and motor forces take them.
    NoBodyRates,
    /// The law gives motor forces, and the target has none.
    NoForces,
    /// The law makes a reference of its own, and the target has no sample for it.
    NoSample,
    /// Nothing is known of the motors that a command is to be carried to.
    NoActuation,
}

impl StateError {
    /// The fault of measured body rates, if they have one.
    #[cold]
    pub(crate) fn of_body_rates(body_rates_rad_s: &Vector3<f32>) -> Option<Self> {
        let bad = body_rates_rad_s.iter().find(|rate| !rate.is_finite())?;
        Some(Self::NonFinite { field: Field::BodyRates, value: *bad })
    }
}

impl fmt::Display for StateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NonFinite { field, value } => write!(f, "state: {field} holds {value}; distrust the estimator"),
            Self::QuaternionNorm { norm_squared } => write!(
                f,
                "state: attitude has the squared norm {norm_squared}, not 1; check its scaling and order (scalar first)"
            ),
        }
    }
}

impl fmt::Display for ReferenceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NonFinite { field, value } => write!(f, "reference: {field} holds {value}; distrust its source"),
            Self::NoThrust { thrust_m_s2 } => {
                write!(f, "reference: thrust {thrust_m_s2} m/s^2 is free fall; plan with a thrust bound")
            }
            Self::Inverted { axis_z } => {
                write!(f, "reference: thrust axis points down ({axis_z}); plan with a tilt bound")
            }
            Self::HeadingInfeasible { q3 } => write!(f, "reference: q3 = {q3} is out of reach at this tilt"),
        }
    }
}

impl fmt::Display for StepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::State(error) => error.fmt(f),
            Self::Singular => f.write_str("law: the asked acceleration has no attitude; stop or level"),
            Self::NoBodyRates => f.write_str("controller: motor forces take body rates; measure them"),
            Self::NoForces => f.write_str("controller: the law gives motor forces; make the target with them"),
            Self::NoSample => {
                f.write_str("controller: the cascade makes its own reference; make the target with a sample")
            }
            Self::NoActuation => f.write_str("controller: nothing is known of the motors; give it an actuation"),
        }
    }
}

impl core::error::Error for StateError {}
impl core::error::Error for ReferenceError {}
impl core::error::Error for StepError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::State(error) => Some(error),
            _ => None,
        }
    }
}
