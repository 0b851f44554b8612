//! The air that a craft is told of: drag, and the moment that air flowing past the propellers puts on the body.
//!
//! With the velocity through the air in the body frame, `v_b`, the force is `-d m v_b` (`-d_z m v_b,z` along the thrust) and the
//! moment `(c_x v_b,y, -c_y v_b,x, 0)`. Both were identified from real flights of Crazyflies (arXiv 2603.09908, 2512.14450).

use core::fmt;

/// The air that the craft is told of.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Air {
    /// Linear drag over mass d across the thrust, 1/s.
    pub drag_per_s: f32,
    /// The same along the thrust, over that across it.
    pub drag_along_share: f32,
    /// Moment per velocity `(c_x, c_y)`, N s.
    pub moment_n_s: [f32; 2],
    /// Share of the wind's moment that is told from the accelerometer and fed forward.
    pub gust: f32,
    /// Whether the coefficients are corrected in flight.
    pub learn: bool,
}

/// A figure of the air that is out of range.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum AirError {
    /// Drag outside 0 to [`Air::DRAG_MAX_PER_S`].
    Drag {
        /// 1/s.
        per_s: f32,
    },
    /// Drag along the thrust outside 0 to 2 times that across.
    DragAlong {
        /// Share.
        share: f32,
    },
    /// Moment outside 0 to [`Air::MOMENT_MAX_N_S`].
    Moment {
        /// N s.
        n_s: f32,
    },
    /// A share of the wind outside 0 to 1.
    Gust {
        /// Share.
        share: f32,
    },
}

impl Air {
    /// No air, and none learned: every bit as in vacuum.
    pub const NONE: Self =
        Self { drag_per_s: 0.0, drag_along_share: 1.0, moment_n_s: [0.0; 2], gust: 0.0, learn: false };

    /// Crazyflie 2.1 Brushless: 80 % of the air identified from flights with guards (arXiv 2512.14450).
    pub const BRUSHLESS: Self =
        Self { drag_per_s: 0.353, drag_along_share: 1.0, moment_n_s: [5.6e-4, 7.3e-4], gust: 0.55, learn: true };

    /// Crazyflies with brushed motors: 80 % of the air identified from flights of the 2.1 (arXiv 2603.09908).
    pub const BRUSHED: Self =
        Self { drag_per_s: 0.316, drag_along_share: 1.0, moment_n_s: [3.0e-4, 3.4e-4], gust: 0.55, learn: true };

    /// Largest drag, 1/s.
    pub const DRAG_MAX_PER_S: f32 = 1.0;

    /// Largest moment per velocity, N s.
    pub const MOMENT_MAX_N_S: f32 = 2e-3;

    /// Checks the figures.
    ///
    /// # Errors
    /// [`AirError`] names the first that is out of range.
    pub const fn checked(self) -> Result<Self, AirError> {
        let [cx, cy] = self.moment_n_s;
        if !is_within(self.drag_per_s, Self::DRAG_MAX_PER_S) {
            Err(AirError::Drag { per_s: self.drag_per_s })
        } else if !is_within(self.drag_along_share, 2.0) {
            Err(AirError::DragAlong { share: self.drag_along_share })
        } else if !is_within(cx, Self::MOMENT_MAX_N_S) {
            Err(AirError::Moment { n_s: cx })
        } else if !is_within(cy, Self::MOMENT_MAX_N_S) {
            Err(AirError::Moment { n_s: cy })
        } else if !is_within(self.gust, 1.0) {
            Err(AirError::Gust { share: self.gust })
        } else {
            Ok(self)
        }
    }
}

/// False for NaN.
const fn is_within(value: f32, most: f32) -> bool {
    value >= 0.0 && value <= most
}

impl fmt::Display for AirError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Drag { per_s } => {
                write!(f, "air: drag of {per_s} 1/s; must be within 0 and {}", Air::DRAG_MAX_PER_S)
            }
            Self::DragAlong { share } => write!(f, "air: drag along the thrust {share} times that across; give 0 to 2"),
            Self::Moment { n_s } => {
                write!(f, "air: moment of {n_s} N s; must be within 0 and {}", Air::MOMENT_MAX_N_S)
            }
            Self::Gust { share } => write!(f, "air: {share} of the wind fed forward; give 0 to 1"),
        }
    }
}

impl core::error::Error for AirError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_out_of_range_is_named() {
        assert_eq!(Air::BRUSHLESS.checked(), Ok(Air::BRUSHLESS));
        assert_eq!(Air { drag_per_s: 1.1, ..Air::BRUSHED }.checked(), Err(AirError::Drag { per_s: 1.1 }));
        let moment = Air { moment_n_s: [0.0, -1e-4], ..Air::BRUSHED };
        assert_eq!(moment.checked(), Err(AirError::Moment { n_s: -1e-4 }));
        assert!(Air { gust: f32::NAN, ..Air::BRUSHED }.checked().is_err());
        assert!(Air { drag_along_share: 3.0, ..Air::BRUSHED }.checked().is_err());
    }
}
