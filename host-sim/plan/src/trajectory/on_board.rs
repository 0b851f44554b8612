//! Trajectories on board: f64 pieces in; f32 pieces as the board stores them out, and back.

use quatrack::Piece;

use super::polynomial::{self, PiecewisePolynomial, PolynomialError};

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
