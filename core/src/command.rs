//! The command: thrust over mass (m/s^2) and body rates (body frame, rad/s) in, the same within the vehicle's limits out,
//! with a report of each limit that was met.

mod limited;

use core::fmt;
use core::hint::cold_path;

use nalgebra::Vector3;

pub use self::limited::Limited;

/// The paper's input `u = [T p q r]` (2b).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Command {
    /// Thrust divided by mass along the body z axis, m/s^2.
    pub thrust_m_s2: f32,
    /// Body rates `p q r`, rad/s.
    pub body_rates_rad_s: Vector3<f32>,
}

impl Command {
    /// No thrust, no rotation: the command of a stopped craft.
    pub const ZERO: Self = Self { thrust_m_s2: 0.0, body_rates_rad_s: Vector3::new(0.0, 0.0, 0.0) };

    /// Whether all four numbers are finite.
    #[cold]
    pub fn is_finite(&self) -> bool {
        let Self { thrust_m_s2: thrust, body_rates_rad_s: rates } = self;
        is_finite(*thrust) && is_finite(rates.x) && is_finite(rates.y) && is_finite(rates.z)
    }
}

/// The range of commands that a vehicle can follow; built with [`Limits::new`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    thrust_min_m_s2: f32,
    thrust_max_m_s2: f32,
    body_rates_max_rad_s: Vector3<f32>,
}

/// Why limits are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum LimitsError {
    /// `thrust_min_m_s2 <= thrust_max_m_s2` does not hold, or one of them is not a number.
    Thrust {
        /// Lower bound, m/s^2.
        min_m_s2: f32,
        /// Upper bound, m/s^2.
        max_m_s2: f32,
    },
    /// A body rate bound is not a positive number.
    BodyRate {
        /// The bound, rad/s.
        max_rad_s: f32,
    },
}

impl fmt::Display for LimitsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Thrust { min_m_s2, max_m_s2 } => {
                write!(f, "limits: thrust from {min_m_s2} to {max_m_s2} m/s^2 is empty; give the lower bound first")
            }
            Self::BodyRate { max_rad_s } => write!(f, "limits: body rate {max_rad_s} rad/s; must be positive"),
        }
    }
}

impl core::error::Error for LimitsError {}

impl Limits {
    /// The whole range of f32: never binds, and still refuses numbers that are not finite.
    pub const NONE: Self = Self {
        thrust_min_m_s2: f32::MIN,
        thrust_max_m_s2: f32::MAX,
        body_rates_max_rad_s: Vector3::new(f32::MAX, f32::MAX, f32::MAX),
    };

    /// Thrust within `[thrust_min_m_s2, thrust_max_m_s2]`, each body rate within plus or minus its bound.
    ///
    /// # Errors
    /// [`LimitsError`] where the range of thrust is empty or a rate bound is not positive; NaN is refused.
    pub fn new(
        thrust_min_m_s2: f32,
        thrust_max_m_s2: f32,
        body_rates_max_rad_s: Vector3<f32>,
    ) -> Result<Self, LimitsError> {
        let finite = thrust_min_m_s2.is_finite() && thrust_max_m_s2.is_finite();
        if !(finite && thrust_min_m_s2 <= thrust_max_m_s2) {
            return Err(LimitsError::Thrust { min_m_s2: thrust_min_m_s2, max_m_s2: thrust_max_m_s2 });
        }
        match body_rates_max_rad_s.iter().find(|max| !(max.is_finite() && **max > 0.0)) {
            Some(&max_rad_s) => Err(LimitsError::BodyRate { max_rad_s }),
            None => Ok(Self { thrust_min_m_s2, thrust_max_m_s2, body_rates_max_rad_s }),
        }
    }

    /// The tighter of these limits and a table's, each; where nothing is left of the thrust, the table's counts for
    /// nothing.
    #[must_use]
    pub fn within(&self, table: &Self) -> Self {
        let lesser = |a: f32, b: f32| if a < b { a } else { b };
        let (own, rates) = (&self.body_rates_max_rad_s, &table.body_rates_max_rad_s);
        let min = -lesser(-self.thrust_min_m_s2, -table.thrust_min_m_s2);
        let max = lesser(self.thrust_max_m_s2, table.thrust_max_m_s2);
        let is_empty = min > max;
        Self {
            thrust_min_m_s2: if is_empty { self.thrust_min_m_s2 } else { min },
            thrust_max_m_s2: if is_empty { self.thrust_max_m_s2 } else { max },
            body_rates_max_rad_s: Vector3::new(lesser(own.x, rates.x), lesser(own.y, rates.y), lesser(own.z, rates.z)),
        }
    }

    /// Least thrust, m/s^2.
    pub const fn thrust_min_m_s2(&self) -> f32 {
        self.thrust_min_m_s2
    }

    /// Most thrust, m/s^2.
    pub const fn thrust_max_m_s2(&self) -> f32 {
        self.thrust_max_m_s2
    }

    /// Largest body rates `p q r`, rad/s.
    pub const fn body_rates_max_rad_s(&self) -> Vector3<f32> {
        self.body_rates_max_rad_s
    }

    /// The command cut to the limits and the cuts; nothing where a number is not finite.
    #[inline]
    pub fn saturate(&self, command: &Command) -> Option<(Command, Limited)> {
        let Command { thrust_m_s2: thrust, body_rates_rad_s: rates } = *command;
        // A sum is finite only if all of its terms are; the converse fails only near the end of f32.
        if !is_finite((thrust + rates.x) + (rates.y + rates.z)) && !command.is_finite() {
            return None;
        }
        let max = &self.body_rates_max_rad_s;
        let mut limited = Limited::NOTHING;
        let thrust = within(thrust, self.thrust_min_m_s2, self.thrust_max_m_s2, 1, &mut limited);
        let p = within_size(rates.x, max.x, 2, &mut limited);
        let q = within_size(rates.y, max.y, 4, &mut limited);
        let r = within_size(rates.z, max.z, 8, &mut limited);
        let rates = Vector3::new(f32::from_bits(p), f32::from_bits(q), f32::from_bits(r));
        Some((Command { thrust_m_s2: thrust, body_rates_rad_s: rates }, limited))
    }
}

// `f32::min` and `max` would be library calls on the Cortex-M4.

/// A finite value cut to `[min, max]`, noted as `bit` where it was.
#[inline(always)]
fn within(value: f32, min: f32, max: f32, bit: u8, limited: &mut Limited) -> f32 {
    let bound = if value > max {
        max
    } else if value < min {
        min
    } else {
        return value;
    };
    cold_path();
    limited.note(bit);
    bound
}

/// The bits of a finite value cut to `[-max, max]`, likewise. All of it is done in the integer unit, where it takes fewer
/// instructions.
#[inline(always)]
fn within_size(value: f32, max: f32, bit: u8, limited: &mut Limited) -> u32 {
    let (bits, max) = (value.to_bits(), max.to_bits());
    if bits << 1 <= max << 1 {
        return bits;
    }
    cold_path();
    limited.note(bit);
    bits & SIGN | max & !SIGN
}

/// The sign bit.
const SIGN: u32 = 1 << 31;

/// The bits without the sign against those of infinity.
#[inline(always)]
fn is_finite(value: f32) -> bool {
    value.to_bits() << 1 < f32::INFINITY.to_bits() << 1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn command(thrust_m_s2: f32, p: f32, q: f32, r: f32) -> Command {
        Command { thrust_m_s2, body_rates_rad_s: Vector3::new(p, q, r) }
    }

    fn limits() -> Limits {
        Limits::new(2.0, 16.0, Vector3::new(10.0, 10.0, 3.0)).unwrap()
    }

    #[test]
    fn a_command_on_the_limits_is_untouched() {
        let edge = command(16.0, -10.0, 10.0, 3.0);
        assert_eq!(limits().saturate(&edge), Some((edge, Limited::NOTHING)));
    }

    #[test]
    fn each_part_is_cut_and_reported_alone() {
        let (cut, limited) = limits().saturate(&command(1.0, 11.0, 0.0, -4.0)).unwrap();
        assert_eq!(cut, command(2.0, 10.0, 0.0, -3.0));
        assert_eq!((limited.thrust(), limited.body_rates()), (true, [true, false, true]));
        assert_eq!(Limited::from_bits(limited.bits()), limited);
        assert!(limited.any());
    }

    #[test]
    fn numbers_that_are_not_finite_are_never_a_command() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for i in 0..4 {
                let mut values = [9.81, 0.0, 0.0, 0.0];
                values[i] = bad;
                let [t, p, q, r] = values;
                assert_eq!(limits().saturate(&command(t, p, q, r)), None);
                assert_eq!(Limits::NONE.saturate(&command(t, p, q, r)), None);
            }
        }
    }

    #[test]
    fn empty_and_unordered_limits_are_refused() {
        let rates = Vector3::new(1.0, 1.0, 1.0);
        assert_eq!(Limits::new(2.0, 1.0, rates), Err(LimitsError::Thrust { min_m_s2: 2.0, max_m_s2: 1.0 }));
        assert!(Limits::new(f32::NAN, 1.0, rates).is_err());
        let zero = Limits::new(0.0, 1.0, Vector3::new(1.0, 0.0, 1.0));
        assert_eq!(zero, Err(LimitsError::BodyRate { max_rad_s: 0.0 }));
    }
}
