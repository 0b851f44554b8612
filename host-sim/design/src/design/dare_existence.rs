//! Whether the discrete Riccati equation has a stabilising solution: tests that name the mode for which it has none.
//!
//! In flow A, the factor F of the input and Q, n x n, n x m and n x n; out flows an eigenvalue in a [`DesignError`].

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::DesignError;
use crate::analysis::{eigenvalues, moves, staircase};

/// States up to which a singular value decomposition per unstable eigenvalue costs little.
const MAX_PBH_STATES: usize = 40;

/// Refuses a pair whose input does not reach a mode on or outside the unit circle.
pub(super) fn require_stabilisable(a: &DMatrix<f64>, factor: &DMatrix<f64>) -> Result<(), DesignError> {
    let n = a.nrows();
    let tolerance = n as f64 * f64::EPSILON * a.norm().max(1.0);
    let stairs = staircase(a, factor)?;
    if stairs.uncontrollable > 0 {
        let unreached = stairs.uncontrollable_a();
        for eigenvalue in eigenvalues(&unreached)? {
            if eigenvalue.norm() >= 1.0 - tolerance || on_circle(&unreached, eigenvalue, tolerance) {
                return Err(DesignError::NotStabilisable { eigenvalue });
            }
        }
    }
    if n > MAX_PBH_STATES {
        return Ok(());
    }
    // The size of B says nothing about the states that it reaches.
    let input = factor * (a.norm().max(1.0) / factor.norm().max(f64::MIN_POSITIVE));
    let mut unstable = eigenvalues(a)?;
    // Of a pair of conjugates, one tells; the eigenvalues of a triangular matrix may be all the same.
    unstable.retain(|value| value.norm() >= 1.0 - tolerance && value.im >= 0.0);
    unstable.dedup();
    for eigenvalue in unstable {
        if !moves(a, &input, eigenvalue)? {
            return Err(DesignError::NotStabilisable { eigenvalue });
        }
    }
    Ok(())
}

/// Refuses a Q that does not see a mode of A on the unit circle.
pub(super) fn require_detectable(a: &DMatrix<f64>, q: &DMatrix<f64>) -> Result<(), DesignError> {
    let stairs = staircase(&a.transpose(), q)?;
    if stairs.uncontrollable == 0 {
        return Ok(());
    }
    let unseen = stairs.uncontrollable_a();
    let tolerance = unseen.nrows() as f64 * f64::EPSILON * a.norm().max(1.0);
    for eigenvalue in eigenvalues(&unseen)? {
        if on_circle(&unseen, eigenvalue, tolerance) {
            return Err(DesignError::NotDetectableSampled { eigenvalue: eigenvalue / eigenvalue.norm() });
        }
    }
    Ok(())
}

/// Whether the point of the circle beside `eigenvalue` is an eigenvalue of `m` up to a change of `m` by `tolerance`.
fn on_circle(m: &DMatrix<f64>, eigenvalue: Complex64, tolerance: f64) -> bool {
    if (eigenvalue.norm() - 1.0).abs() > 1e-2 {
        return false;
    }
    let point = eigenvalue / eigenvalue.norm();
    let mut shifted = m.map(|value| Complex64::new(value, 0.0));
    for i in 0..m.nrows() {
        shifted[(i, i)] -= point;
    }
    // The inverse's Frobenius norm bounds the smallest singular value from below within sqrt(n).
    shifted.try_inverse().is_none_or(|inverse| {
        let norm = inverse.norm();
        !norm.is_finite() || norm * tolerance >= 1.0
    })
}
