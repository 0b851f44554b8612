//! Why pieces are no trajectory: one variant for each reason, with the piece.

use core::fmt;

/// Why pieces are no trajectory; pieces are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum TrajectoryError {
    /// There are none.
    Empty,
    /// A piece of no duration.
    NoDuration {
        /// The piece's number.
        piece: usize,
    },
    /// Longer than [`super::MAX_DURATION_NS`] in all.
    TooLong {
        /// The piece with which the limit is passed.
        piece: usize,
    },
    /// A coefficient is infinite or not a number, or the polynomial leaves the range of f32.
    NonFinite {
        /// The piece's number.
        piece: usize,
    },
    /// Position or heading jumps where a piece begins.
    Jump {
        /// The piece that begins there.
        piece: usize,
        /// How far it is from the end of the one before, m or rad.
        size: f32,
    },
}

impl fmt::Display for TrajectoryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("trajectory: no pieces"),
            Self::NoDuration { piece } => write!(f, "trajectory: piece {piece} has no duration"),
            Self::TooLong { piece } => write!(f, "trajectory: longer than an hour with piece {piece}; split it"),
            Self::NonFinite { piece } => write!(f, "trajectory: piece {piece} holds a value that is not finite"),
            Self::Jump { piece, size } => {
                write!(f, "trajectory: piece {piece} begins {size} m or rad from the end of the one before")
            }
        }
    }
}

impl core::error::Error for TrajectoryError {}
