//! Piecewise polynomials: coefficients per piece in, position, heading and their derivatives at a time out.
//!
//! Trajectories on board have this form (degree at most 7, the piece's own time); a B-spline of such a degree becomes one
//! without loss. The text form that other tools write is in [`csv`].

pub mod csv;
mod error;
mod piece;

use std::f64::consts::TAU;

use nalgebra::Vector3;
use quatrack_design::model::flat::FlatSample;

use super::Trajectory;
use super::bspline::BSpline;
pub use error::PolynomialError;
pub use piece::{Coordinate, Piece};

/// Coefficients per coordinate: degree 7, that of the on-board pieces.
pub const COEFFICIENTS: usize = 8;

/// Gap between the end of a piece and the start of the next that is not flown any more, m in position and rad in heading.
///
/// The board refuses a larger step; 1 mm and 0.06 degrees are less than any quadcopter can hold, so that a larger
/// step was not meant to be flown. Files in the wild have 6 decimals: a piece of 1 s then meets its neighbour to `9 *
/// 0.5e-6` at worst, the public figure8.csv to 1.1e-6; but a piece of 3 s to 1.6e-3, one of 5 s to 5e-2. The reader of
/// files takes gaps up to that and closes them ([`PiecewisePolynomial::with_roundings`]).
pub const JOINT_TOLERANCE: f64 = 1e-3;

/// The part of the tolerance that is flown as it is. The board computes joints in 32 bits and must find the rest below
/// its own.
const FLOWN_AS_IT_IS: f64 = 0.995 * JOINT_TOLERANCE;

/// Pieces flown one after the other, without gaps in position or heading.
///
/// The heading is the model's psi in `q = q_tilt(n) q_z(psi)`; other tools' yaw is the same at hover.
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewisePolynomial {
    pieces: Vec<Piece>,
    /// Start of each piece, then the end of the last, s.
    boundaries_s: Vec<f64>,
}

impl PiecewisePolynomial {
    /// A trajectory of these pieces. A heading that starts whole turns from where the piece before it ends is the same
    /// attitude: the turns are taken off the piece, so that the trajectory's heading is continuous.
    ///
    /// # Errors
    /// [`PolynomialError`] for the first thing that cannot be flown. Jumps in velocity and above are not judged here.
    pub fn new(pieces: Vec<Piece>) -> Result<Self, PolynomialError> {
        Self::with_roundings(pieces, &[])
    }

    /// The same where the pieces' numbers are rounded: joint `i`, behind piece `i`, may be `roundings[i]` apart in x, y, z
    /// and heading. A gap larger than the board flies is closed: the piece before it takes the gap up in a smooth step
    /// that leaves its derivatives to the third at both ends unchanged.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn with_roundings(mut pieces: Vec<Piece>, roundings: &[[f64; 4]]) -> Result<Self, PolynomialError> {
        validate(&pieces)?;
        for i in 1..pieces.len() {
            let rounding = roundings.get(i - 1).copied().unwrap_or_default();
            for coordinate in Coordinate::ALL {
                let before = &pieces[i - 1];
                let end = before.derivative(coordinate, 0, before.duration_s);
                let start = pieces[i].coefficients[coordinate as usize][0];
                let turns = if coordinate == Coordinate::Yaw { ((start - end) / TAU).round() } else { 0.0 };
                let jump = start - end - TAU * turns;
                // Written so that NaN is refused.
                if jump.abs() <= FLOWN_AS_IT_IS {
                } else if jump.abs() <= rounding[coordinate as usize] {
                    pieces[i - 1].step_smoothly(coordinate, jump);
                } else {
                    return Err(PolynomialError::Jump { piece: i, coordinate, end, start, jump: jump.abs() });
                }
                if turns != 0.0 {
                    pieces[i].coefficients[coordinate as usize][0] = start - TAU * turns;
                }
            }
        }
        Self::joined(pieces)
    }

    /// A trajectory of pieces that meet.
    pub(crate) fn joined(pieces: Vec<Piece>) -> Result<Self, PolynomialError> {
        validate(&pieces)?;
        let mut boundaries_s = vec![0.0];
        let mut end_s = 0.0;
        for piece in &pieces {
            end_s += piece.duration_s;
            boundaries_s.push(end_s);
        }
        if end_s.is_finite() { Ok(Self { pieces, boundaries_s }) } else { Err(PolynomialError::TotalDuration) }
    }

    /// A trajectory that was taken apart into its [`Self::pieces`] and [`Self::boundaries_s`], the same to the bit: the ends of a
    /// spline's pieces are not their durations added up. Its joints are those that were looked at before, and are not judged.
    ///
    /// # Errors
    /// [`PolynomialError`] for pieces without a number or a duration, and for boundaries that are not theirs.
    pub fn put_together(pieces: Vec<Piece>, boundaries_s: &[f64]) -> Result<Self, PolynomialError> {
        validate(&pieces)?;
        let first = boundaries_s.first().copied().unwrap_or(f64::NAN);
        let joined = |piece: usize, start_s: f64, end_s: f64| {
            let want_s = start_s + pieces[piece].duration_s;
            (end_s - want_s).abs() <= 1e-9 * want_s && (piece > 0 || first == 0.0)
        };
        let ends = (0..pieces.len()).map(|piece| {
            let of = |index: usize| boundaries_s.get(index).copied().unwrap_or(f64::NAN);
            (piece, of(piece), of(piece + 1))
        });
        match ends.into_iter().find(|(piece, start_s, end_s)| !joined(*piece, *start_s, *end_s)) {
            Some((piece, start_s, end_s)) => Err(PolynomialError::Boundaries { piece: piece + 1, start_s, end_s }),
            None => Ok(Self { boundaries_s: boundaries_s[..=pieces.len()].to_vec(), pieces }),
        }
    }

    /// The same curve as `spline`, to rounding: one piece per span. It takes exactly as long.
    ///
    /// # Errors
    /// [`PolynomialError::Coefficient`] if the spline is so large or so short that a coefficient overflows.
    pub fn from_bspline(spline: &BSpline) -> Result<Self, PolynomialError> {
        let spans = spline.spans();
        let duration_s = spline.duration_s() / spans as f64;
        // Added up, the durations would miss the spline's end by a rounding error or more; so may `d * n / n`.
        let starts_s = (0..spans).map(|span| spline.duration_s() * span as f64 / spans as f64);
        let boundaries_s: Vec<f64> = starts_s.chain([spline.duration_s()]).collect();
        let mut pieces = vec![Piece { duration_s, coefficients: [[0.0; COEFFICIENTS]; 4] }; spans];
        let mut factorial = 1.0;
        for power in 0..=spline.degree() {
            // Taylor: the coefficient is the derivative at the span's start over the factorial.
            factorial *= power.max(1) as f64;
            let points = spline.derivative_control_points(power);
            for (span, piece) in pieces.iter_mut().enumerate() {
                let basis = spline.basis(power, span, boundaries_s[span]);
                let derivative: Vector3<f64> = basis.iter().zip(&points[span..]).map(|(b, p)| p * *b).sum();
                for (coefficients, value) in piece.coefficients.iter_mut().zip(derivative.iter()) {
                    coefficients[power] = value / factorial;
                }
                let heading = spline.heading_derivative_in(power, span, boundaries_s[span]);
                piece.coefficients[Coordinate::Yaw as usize][power] = heading / factorial;
            }
        }
        // A spline is continuous however large it is: its joints need no judgement against a length in metres.
        validate(&pieces)?;
        Ok(Self { pieces, boundaries_s })
    }

    /// The pieces, in the order of flight.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Start of each piece, then the end of the last, s.
    pub fn boundaries_s(&self) -> &[f64] {
        &self.boundaries_s
    }

    /// The `order`-th derivative of a coordinate at a time, SI; at rest outside the trajectory's duration.
    pub fn derivative(&self, coordinate: Coordinate, order: usize, t_s: f64) -> f64 {
        let at_rest = !(0.0..=self.duration_s()).contains(&t_s);
        if at_rest && order > 0 {
            return 0.0;
        }
        let (piece, start_s) = self.piece_at(t_s);
        // Rounding of the boundaries never takes a piece past its own end.
        piece.derivative(coordinate, order, (t_s - start_s).max(0.0).min(piece.duration_s))
    }

    /// The piece flown at `t_s` and its start, s; at a joint the later piece, at and after the end the last.
    fn piece_at(&self, t_s: f64) -> (&Piece, f64) {
        let last = self.pieces.len() - 1;
        let index = self.boundaries_s[1..=last].partition_point(|end_s| *end_s <= t_s);
        (&self.pieces[index], self.boundaries_s[index])
    }
}

/// Whether there are pieces, and each has a duration and coefficients that are numbers.
fn validate(pieces: &[Piece]) -> Result<(), PolynomialError> {
    if pieces.is_empty() {
        return Err(PolynomialError::Empty);
    }
    for (index, piece) in pieces.iter().enumerate() {
        let value = piece.duration_s;
        if !(value > 0.0 && value.is_finite()) {
            return Err(PolynomialError::Duration { piece: index + 1, value });
        }
        for coordinate in Coordinate::ALL {
            let coefficients = &piece.coefficients[coordinate as usize];
            if let Some(power) = coefficients.iter().position(|c| !c.is_finite()) {
                let value = coefficients[power];
                return Err(PolynomialError::Coefficient { piece: index + 1, coordinate, power, value });
            }
        }
    }
    Ok(())
}

impl Trajectory for PiecewisePolynomial {
    fn duration_s(&self) -> f64 {
        self.boundaries_s[self.pieces.len()]
    }

    fn at(&self, t_s: f64) -> FlatSample {
        let value = |coordinate, order| self.derivative(coordinate, order, t_s);
        let vector = |order| Vector3::from([Coordinate::X, Coordinate::Y, Coordinate::Z].map(|c| value(c, order)));
        FlatSample {
            position_m: vector(0),
            velocity_m_s: vector(1),
            acceleration_m_s2: vector(2),
            jerk_m_s3: vector(3),
            heading_rad: value(Coordinate::Yaw, 0),
            heading_rate_rad_s: value(Coordinate::Yaw, 1),
        }
    }
}
