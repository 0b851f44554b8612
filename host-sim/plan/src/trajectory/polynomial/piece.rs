//! One piece of a trajectory: its coefficients in; position, heading and their derivatives at a time out.

use std::fmt;

use super::COEFFICIENTS;

/// The four polynomials of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinate {
    /// Position, m.
    X,
    /// Position, m.
    Y,
    /// Position, m.
    Z,
    /// Heading, rad.
    Yaw,
}

impl Coordinate {
    /// In the order of [`Piece::coefficients`].
    pub const ALL: [Self; 4] = [Self::X, Self::Y, Self::Z, Self::Yaw];

    /// SI unit of its value.
    pub fn unit(self) -> &'static str {
        if self == Self::Yaw { "rad" } else { "m" }
    }
}

impl fmt::Display for Coordinate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::Yaw => "yaw",
        })
    }
}

/// One polynomial per coordinate over `0 <= t <= duration_s`, t counted from the start of the piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Length in time, s; positive and finite.
    pub duration_s: f64,
    /// Of x, y, z and heading; ascending powers: entry k in m/s^k, for the heading rad/s^k.
    pub coefficients: [[f64; COEFFICIENTS]; 4],
}

impl Piece {
    /// The `order`-th derivative of a coordinate at `t_s` from the piece's start; SI.
    pub fn derivative(&self, coordinate: Coordinate, order: usize, t_s: f64) -> f64 {
        // Horner; factor k (k-1) .. (k-order+1) of the k-th power.
        let coefficients = &self.coefficients[coordinate as usize];
        (order..COEFFICIENTS).rev().fold(0.0, |sum, k| {
            let factor: f64 = (k - order + 1..=k).map(|i| i as f64).product();
            sum * t_s + factor * coefficients[k]
        })
    }

    /// Adds a step by `size` over the piece's duration, without velocity, acceleration or jerk at its ends.
    pub(super) fn step_smoothly(&mut self, coordinate: Coordinate, size: f64) {
        // The polynomial of degree 7 from 0 to 1 whose first three derivatives are 0 at both.
        let step = [35.0, -84.0, 70.0, -20.0];
        for (power, share) in (4..).zip(step) {
            self.coefficients[coordinate as usize][power as usize] += size * share / self.duration_s.powi(power);
        }
    }
}
