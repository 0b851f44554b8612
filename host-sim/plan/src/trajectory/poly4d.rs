//! Trajectories as the Crazyflie stores them: polynomial pieces in; `poly4d` of 132 bytes, and their values, out.
//!
//! Layout and evaluation are those of Bitcraze's crazyflie-firmware: `struct poly4d` in `pptraj.h`; `piecewise_eval`,
//! `poly4d_eval`, `polyval` and `polyder` in `pptraj.c`; the size of the memory in `crtp_commander_high_level.c`. The
//! arithmetic is theirs too, step by step in `f32`; where their compiler fuses a product and a sum, last bits differ.
//!
//! The fourth polynomial is the heading psi of `q = q_tilt(n) q_z(psi)` here and passes through the firmware unchanged.
//! The firmware's own controllers read it as Z-Y-X yaw, which is the same at hover.

use nalgebra::Vector3;
use quatrack_design::model::flat::FlatSample;

use super::polynomial::{COEFFICIENTS, Coordinate, Piece, PiecewisePolynomial, PolynomialError};

use super::Trajectory;

/// Size of a piece in the memory, bytes: four polynomials and a duration.
pub const PIECE_BYTES: usize = (4 * COEFFICIENTS + 1) * size_of::<f32>();

/// The memory for trajectories, bytes.
pub const MEMORY_BYTES: usize = 4096;

/// Most pieces that it holds.
pub const PIECES_MAX: usize = MEMORY_BYTES / PIECE_BYTES;

/// One piece as stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Poly4d {
    /// Of x, y, z (m/s^k) and heading (rad/s^k); ascending powers of the seconds since the piece began.
    pub coefficients: [[f32; COEFFICIENTS]; 4],
    /// Its duration, s.
    pub duration_s: f32,
}

/// Why pieces cannot be stored.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// More than the memory holds.
    #[error("{0} pieces of {PIECE_BYTES} bytes: the Crazyflie's memory holds {PIECES_MAX}; fit them with fewer")]
    TooManyPieces(usize),
    /// They fit, but in `f32` they are no trajectory any more.
    #[error("as 32-bit numbers: {0}")]
    Rounded(#[source] PolynomialError),
}

/// A trajectory in the Crazyflie's memory.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredTrajectory {
    /// The pieces, at least one.
    pieces: Vec<Poly4d>,
    /// The same numbers in f64.
    polynomials: PiecewisePolynomial,
}

impl StoredTrajectory {
    /// Rounds a trajectory to the stored numbers.
    ///
    /// # Errors
    /// [`StoreError`] if it does not fit, in number or in range.
    pub fn new(trajectory: &PiecewisePolynomial) -> Result<Self, StoreError> {
        if trajectory.pieces().len() > PIECES_MAX {
            return Err(StoreError::TooManyPieces(trajectory.pieces().len()));
        }
        let pieces: Vec<Poly4d> = trajectory.pieces().iter().map(Poly4d::rounded).collect();
        let polynomials =
            PiecewisePolynomial::new(pieces.iter().map(Poly4d::widened).collect()).map_err(StoreError::Rounded)?;
        Ok(Self { pieces, polynomials })
    }

    /// The pieces, in the order of flight.
    pub fn pieces(&self) -> &[Poly4d] {
        &self.pieces
    }

    /// The same numbers in f64: as a file holds them, and the Crazyflie's tools read them, without another rounding.
    pub fn polynomials(&self) -> &PiecewisePolynomial {
        &self.polynomials
    }

    /// Its size in the memory, bytes.
    pub fn bytes(&self) -> usize {
        self.pieces.len() * PIECE_BYTES
    }
}

impl Trajectory for StoredTrajectory {
    fn duration_s(&self) -> f64 {
        self.polynomials.duration_s()
    }

    /// The time is rounded to `f32` first, as the firmware's is. Before the start it rests there.
    fn at(&self, t_s: f64) -> FlatSample {
        if t_s < 0.0 {
            return at_rest(&self.pieces[0].evaluate(0.0));
        }
        let mut t = t_s as f32;
        for piece in &self.pieces {
            if t <= piece.duration_s {
                return piece.evaluate(t);
            }
            t -= piece.duration_s;
        }
        let last = &self.pieces[self.pieces.len() - 1];
        at_rest(&last.evaluate(last.duration_s))
    }
}

impl Poly4d {
    fn rounded(piece: &Piece) -> Self {
        Self { coefficients: piece.coefficients.map(|c| c.map(|v| v as f32)), duration_s: piece.duration_s as f32 }
    }

    fn widened(&self) -> Piece {
        Piece { duration_s: self.duration_s.into(), coefficients: self.coefficients.map(|c| c.map(f64::from)) }
    }

    /// The bytes in memory, little endian: x, y, z, heading, duration.
    pub fn to_bytes(&self) -> [u8; PIECE_BYTES] {
        let numbers = self.coefficients.as_flattened().iter().chain([&self.duration_s]);
        let mut bytes = [0; PIECE_BYTES];
        for (place, number) in bytes.chunks_exact_mut(size_of::<f32>()).zip(numbers) {
            place.copy_from_slice(&number.to_le_bytes());
        }
        bytes
    }

    /// The flat output `t_s` seconds after the piece began, as the firmware computes it.
    pub fn evaluate(&self, t_s: f32) -> FlatSample {
        let mut polynomials = self.coefficients;
        let mut orders = [[0.0; 4]; 4];
        for values in &mut orders {
            *values = polynomials.map(|coefficients| f64::from(horner(&coefficients, t_s)));
            polynomials.iter_mut().for_each(differentiate);
        }
        let vector = |order: usize| {
            let [x, y, z, _] = orders[order];
            Vector3::new(x, y, z)
        };
        FlatSample {
            position_m: vector(0),
            velocity_m_s: vector(1),
            acceleration_m_s2: vector(2),
            jerk_m_s3: vector(3),
            heading_rad: orders[0][Coordinate::Yaw as usize],
            heading_rate_rad_s: orders[1][Coordinate::Yaw as usize],
        }
    }
}

fn horner(coefficients: &[f32; COEFFICIENTS], t: f32) -> f32 {
    coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * t + coefficient)
}

/// The derivative's coefficients in place, each product rounded.
fn differentiate(coefficients: &mut [f32; COEFFICIENTS]) {
    for power in 1..COEFFICIENTS {
        coefficients[power - 1] = power as f32 * coefficients[power];
    }
    coefficients[COEFFICIENTS - 1] = 0.0;
}

fn at_rest(sample: &FlatSample) -> FlatSample {
    let zero = Vector3::zeros();
    FlatSample { velocity_m_s: zero, acceleration_m_s2: zero, jerk_m_s3: zero, heading_rate_rad_s: 0.0, ..*sample }
}
