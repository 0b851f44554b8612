//! A Lyapunov function of the closed loop, and its decrease checked after it was rounded.
//!
//! In flows a stable closed loop; out flow the extreme eigenvalues of P and of the decrease. In coordinates balanced by
//! powers of two, P solves the equation with the identity on its right; then the decrease is formed anew from the
//! rounded P, and counts only where it exceeds its rounding.

use nalgebra::DMatrix;
use serde::Serialize;

use super::CertifyError;
use crate::analysis::{balance, eigenvalues};
use crate::design::{lyapunov, stein};

/// Evidence that `x' P x` decreases along the loop.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Decrease {
    /// Whether P > 0 and the decrease exceeds its rounding.
    pub holds: bool,
    /// Smallest eigenvalue of P over its largest.
    pub p_smallest_over_largest: f64,
    /// Smallest eigenvalue of `-(A' P + P A)`, or of `P - A' P A`, over its largest; 1 but for rounding. Of gains over time
    /// the least share of V that a control step takes off.
    pub decrease_smallest_over_largest: f64,
    /// Largest change of an eigenvalue of the decrease by rounding, over the largest eigenvalue.
    pub rounding: f64,
}

/// For `x' = A x`.
pub(super) fn continuous(a: &DMatrix<f64>) -> Result<Decrease, CertifyError> {
    let a = balance(a).0;
    let p = lyapunov(&a, &DMatrix::identity(a.nrows(), a.nrows()))?.x;
    let moved = &p * &a;
    judged(&p, &-(&moved + moved.transpose()), 2.0 * p.norm() * a.norm())
}

/// For `x+ = A x`.
pub(super) fn sampled(a: &DMatrix<f64>) -> Result<Decrease, CertifyError> {
    let a = balance(a).0;
    let p = stein(&a, &DMatrix::identity(a.nrows(), a.nrows()))?.x;
    let moved = a.transpose() * &p * &a;
    judged(&p, &(&p - (&moved + moved.transpose()) * 0.5), p.norm() * (1.0 + a.norm_squared()))
}

fn judged(p: &DMatrix<f64>, decrease: &DMatrix<f64>, terms: f64) -> Result<Decrease, CertifyError> {
    // Sorted by real part; symmetric matrices have no other.
    let of_p = eigenvalues(p)?;
    let of_decrease = eigenvalues(decrease)?;
    let (Some(p_least), Some(p_most)) = (of_p.first(), of_p.last()) else { return Ok(Decrease::none()) };
    let (Some(least), Some(most)) = (of_decrease.first(), of_decrease.last()) else { return Ok(Decrease::none()) };
    let rounding = 2.0 * p.nrows() as f64 * f64::EPSILON * terms / most.re;
    let share = least.re / most.re;
    Ok(Decrease {
        holds: p_least.re > p.nrows() as f64 * f64::EPSILON * p_most.re && most.re > 0.0 && share > rounding,
        p_smallest_over_largest: p_least.re / p_most.re,
        decrease_smallest_over_largest: share,
        rounding,
    })
}

impl Decrease {
    fn none() -> Self {
        Self {
            holds: false,
            p_smallest_over_largest: 0.0,
            decrease_smallest_over_largest: 0.0,
            rounding: f64::INFINITY,
        }
    }
}
