//! Limits of the cascade's outer loop on the way to a distant goal: speed over ground and up and down (m/s), and tilt.
//! The law is linear, and would tilt too far without them.

use core::fmt;

/// Bounds of the outer loop's output, beyond the reference's own motion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CascadeLimits {
    /// Speed over ground with which a position error is made good, m/s.
    pub speed_m_s: f32,
    /// The same up and down, m/s.
    pub climb_m_s: f32,
    /// Tangent of the largest tilt; a reference that tilts farther may.
    pub tilt_tangent: f32,
}

/// A limit that is not a number within its range.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum CascadeLimitsError {
    /// Speed outside 0.1 to 10 m/s.
    Speed {
        /// m/s.
        m_s: f32,
    },
    /// Climb outside 0.1 to 10 m/s.
    Climb {
        /// m/s.
        m_s: f32,
    },
    /// Tangent of the tilt outside 0.1 to 4: 6 to 76 degrees.
    Tilt {
        /// Its tangent.
        tangent: f32,
    },
}

impl CascadeLimits {
    /// 1.8 m/s over ground, 1.5 m/s up and down, 54.5 degrees.
    pub const STANDARD: Self = Self { speed_m_s: 1.8, climb_m_s: 1.5, tilt_tangent: 1.402 };

    /// Checks the figures.
    ///
    /// # Errors
    /// [`CascadeLimitsError`] names the first that is out of range.
    pub const fn checked(self) -> Result<Self, CascadeLimitsError> {
        let Self { speed_m_s, climb_m_s, tilt_tangent } = self;
        if !(speed_m_s >= 0.1 && speed_m_s <= 10.0) {
            Err(CascadeLimitsError::Speed { m_s: speed_m_s })
        } else if !(climb_m_s >= 0.1 && climb_m_s <= 10.0) {
            Err(CascadeLimitsError::Climb { m_s: climb_m_s })
        } else if !(tilt_tangent >= 0.1 && tilt_tangent <= 4.0) {
            Err(CascadeLimitsError::Tilt { tangent: tilt_tangent })
        } else {
            Ok(self)
        }
    }
}

impl fmt::Display for CascadeLimitsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Speed { m_s } => write!(f, "limits: speed of {m_s} m/s; give 0.1 to 10"),
            Self::Climb { m_s } => write!(f, "limits: climb of {m_s} m/s; give 0.1 to 10"),
            Self::Tilt { tangent } => write!(f, "limits: tangent of the tilt {tangent}; give 0.1 to 4"),
        }
    }
}

impl core::error::Error for CascadeLimitsError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_out_of_range_is_named() {
        let standard = CascadeLimits::STANDARD;
        assert_eq!(standard.checked(), Ok(standard));
        // 54.5 degrees.
        assert!((f64::from(standard.tilt_tangent).atan().to_degrees() - 54.5).abs() < 0.01);
        let still = CascadeLimits { speed_m_s: 0.0, ..standard };
        assert_eq!(still.checked(), Err(CascadeLimitsError::Speed { m_s: 0.0 }));
        assert!(CascadeLimits { climb_m_s: f32::NAN, ..standard }.checked().is_err());
        assert!(CascadeLimits { tilt_tangent: 5.0, ..standard }.checked().is_err());
    }
}
