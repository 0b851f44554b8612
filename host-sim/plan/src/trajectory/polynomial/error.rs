//! Why pieces do not make a trajectory: which piece, which value, the remedy.

use super::{Coordinate, JOINT_TOLERANCE};

/// Why pieces do not make a trajectory. Pieces count from 1.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PolynomialError {
    /// There is nothing to fly.
    #[error("no pieces: a trajectory needs at least one")]
    Empty,
    /// Zero, negative or not a number.
    #[error("piece {piece}: duration = {value} s; must be positive and finite")]
    Duration {
        /// The piece's number, from 1.
        piece: usize,
        /// Its duration, s.
        value: f64,
    },
    /// It does not begin and end where its duration says.
    #[error(
        "piece {piece}: from {start_s} to {end_s} s; must be its duration, and begin where the piece before it ends"
    )]
    Boundaries {
        /// The piece's number, from 1.
        piece: usize,
        /// Its start, s.
        start_s: f64,
        /// Its end, s.
        end_s: f64,
    },
    /// The durations add up to more than a number can hold.
    #[error("the durations add up to more than 1e308 s; shorten the pieces")]
    TotalDuration,
    /// Not a number.
    #[error("piece {piece}: {coordinate}^{power} = {value}; must be a finite number")]
    Coefficient {
        /// The piece's number, from 1.
        piece: usize,
        /// The polynomial.
        coordinate: Coordinate,
        /// The power.
        power: usize,
        /// The coefficient.
        value: f64,
    },
    /// A piece does not start where the one before it ends.
    #[error(
        "{coordinate} jumps by {jump:.6} {} from the end of piece {piece} ({end:.6}) to the start of piece {} \
         ({start:.6}); less than {JOINT_TOLERANCE} {0} can be flown: correct {coordinate}^0 of piece {1} or the duration \
         of piece {piece}",
        coordinate.unit(), piece + 1
    )]
    Jump {
        /// The piece before the jump, from 1.
        piece: usize,
        /// The coordinate that jumps.
        coordinate: Coordinate,
        /// Value at the end of that piece, m or rad.
        end: f64,
        /// Value at the start of the next piece, m or rad.
        start: f64,
        /// Size of the jump, m or rad; for the heading without whole turns.
        jump: f64,
    },
}
