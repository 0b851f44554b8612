//! Trajectories on board: f64 pieces in; f32 pieces as the board stores them out, and back.

use quatrack::Piece;
use quatrack::trajectory::TrajectoryError;

use super::polynomial::{self, Coordinate, PiecewisePolynomial, PolynomialError};

/// Why a board does not fly a trajectory that a file may hold. Pieces count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OnBoardError {
    /// So far from the origin that 32-bit numbers cannot tell a millimetre.
    #[error(
        "{coordinate} is {value:.0} {0} in piece {piece}, where 32-bit numbers are {spacing:.2} m{0} apart: pieces do not meet \
         to 1 m{0} on board; move the origin", coordinate.unit()
    )]
    Coarse {
        /// The piece's number.
        piece: usize,
        /// The coordinate.
        coordinate: Coordinate,
        /// Its largest value at the piece's ends, m or rad.
        value: f64,
        /// How far apart two numbers of 32 bits are there, a thousandth of m or rad.
        spacing: f64,
    },
    /// Anything else that the board's own check finds.
    #[error("piece {piece}: {reason}")]
    Refused {
        /// The piece's number.
        piece: usize,
        /// The fault.
        reason: &'static str,
    },
}

/// The pieces as a board stores them, if it flies them.
///
/// # Errors
/// [`OnBoardError`] names the piece, the fault and the remedy.
pub fn checked(trajectory: &PiecewisePolynomial) -> Result<Vec<Piece>, OnBoardError> {
    let pieces = pieces(trajectory);
    let refused = |index: usize, reason| Err(OnBoardError::Refused { piece: index + 1, reason });
    let index = match quatrack::Trajectory::new(&pieces) {
        Ok(_) => return Ok(pieces),
        Err(TrajectoryError::Jump { piece, .. }) => piece,
        Err(TrajectoryError::NoDuration { piece }) => {
            return refused(piece, "shorter than half a nanosecond; join it to the next");
        }
        Err(TrajectoryError::TooLong { piece }) => {
            return refused(piece, "ends later than an hour after the start; split the trajectory");
        }
        Err(TrajectoryError::NonFinite { piece }) => {
            return refused(piece, "its coefficients leave the range of 32-bit numbers");
        }
        Err(_) => return refused(0, "the board's check refuses it"),
    };
    // The joint met in 64 bits. The largest term of both sides there is the one that 32 bits cannot hold.
    let before = &trajectory.pieces()[index.saturating_sub(1)];
    let size = |coordinate: Coordinate| {
        let terms = before.coefficients[coordinate as usize].iter().zip(0..);
        terms.map(|(c, power)| (c * before.duration_s.powi(power)).abs()).fold(0.0, f64::max)
    };
    let largest = Coordinate::ALL.into_iter().max_by(|a, b| size(*a).total_cmp(&size(*b))).unwrap_or(Coordinate::X);
    let value = size(largest);
    let spacing = 1e3 * (f64::from((value as f32).next_up()) - f64::from(value as f32));
    Err(OnBoardError::Coarse { piece: index + 1, coordinate: largest, value, spacing })
}

/// A trajectory as the board stores it. Piece boundaries are rounded to a nanosecond from the start, so that their
/// rounding does not add up.
pub fn pieces(trajectory: &PiecewisePolynomial) -> Vec<Piece> {
    let mut end_s = 0.0;
    let mut start_ns = 0_u64;
    trajectory
        .pieces()
        .iter()
        .map(|piece| {
            end_s += piece.duration_s;
            let end_ns = (end_s * 1e9).round() as u64;
            let duration_ns = end_ns - start_ns;
            start_ns = end_ns;
            let [x, y, z, heading] = piece.coefficients.map(|c| c.map(|value| value as f32));
            Piece { duration_ns, x, y, z, heading }
        })
        .collect()
}

/// Pieces of the board as a trajectory, every number as it is stored; [`pieces`] gives them back.
///
/// # Errors
/// [`PolynomialError`] for pieces that do not follow each other.
pub fn trajectory(pieces: &[Piece]) -> Result<PiecewisePolynomial, PolynomialError> {
    let piece = |piece: &Piece| polynomial::Piece {
        duration_s: piece.duration_ns as f64 * 1e-9,
        coefficients: [&piece.x, &piece.y, &piece.z, &piece.heading].map(|c| c.map(f64::from)),
    };
    PiecewisePolynomial::new(pieces.iter().map(piece).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::polynomial;

    fn hop(from_m: f64) -> PiecewisePolynomial {
        let mut first = polynomial::Piece { duration_s: 0.7, coefficients: [[0.0; 8]; 4] };
        first.coefficients[0][..2].copy_from_slice(&[from_m, 0.3711]);
        let mut second = first;
        second.coefficients[0][0] = first.derivative(Coordinate::X, 0, 0.7);
        let mut third = first;
        third.coefficients[0][0] = second.derivative(Coordinate::X, 0, 0.7);
        PiecewisePolynomial::new(vec![first, second, third]).unwrap()
    }

    #[test]
    fn joints_that_32_bits_cannot_resolve_are_named_with_the_remedy() {
        assert!(checked(&hop(10.0)).is_ok());
        let line = checked(&hop(50_000.0)).unwrap_err().to_string();
        // Between 2^15 and 2^16 a number of 24 bits steps by 2^-8.
        assert!(line.starts_with("x is 50000 m in piece "), "{line}");
        assert!(line.contains("32-bit numbers are 3.91 mm apart") && line.contains("move the origin"), "{line}");
    }
}
