//! Whether a stabilising solution exists: tests that name the mode for which it does not.
//!
//! In flow the equation, before or after it was solved; out flows an eigenvalue in a [`DesignError`]. Rank decisions are
//! made by the staircase, never at computed eigenvalues, which for a Jordan block are off by a root of the rounding.

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::DesignError;
use super::equation::Equation;
use super::newton::Refined;
use crate::analysis::{balance, eigenvalues, moves, staircase};

/// States up to which a singular value decomposition per unstable eigenvalue costs little.
const MAX_PBH_STATES: usize = 40;
/// In messages.
pub(super) const EQUATION: &str = "the Riccati equation";

/// Refuses a Q with a negative eigenvalue, after its diagonal has been brought to about 1.
pub(super) fn require_positive_semidefinite(q: &DMatrix<f64>) -> Result<(), DesignError> {
    let n = q.nrows();
    let scale: Vec<f64> =
        q.diagonal().iter().map(|d| if *d > 0.0 { (-0.5 * d.log2()).round().exp2() } else { 1.0 }).collect();
    let scaled = DMatrix::from_fn(n, n, |i, j| q[(i, j)] * scale[i] * scale[j]);
    // Sorted by real part.
    let smallest = eigenvalues(&scaled)?[0].re;
    if smallest >= -10.0 * n as f64 * f64::EPSILON * scaled.norm() {
        return Ok(());
    }
    let eigenvalue = eigenvalues(q)?[0].re;
    Err(DesignError::NotPositiveSemidefinite { eigenvalue: if eigenvalue < 0.0 { eigenvalue } else { smallest } })
}

/// Refuses a pair whose input does not reach an unstable or marginal mode.
///
/// By the staircase, and for up to [`MAX_PBH_STATES`] states by the PBH test at each unstable eigenvalue too: where a
/// step of the staircase hangs on a weak coupling, the rounding behind it can hide an unreached simple mode.
pub(super) fn require_stabilisable(equation: &Equation) -> Result<(), DesignError> {
    let stairs = staircase(&equation.a.hi, &equation.factor.hi)?;
    let n = equation.states();
    let norm = equation.a.hi.norm();
    if stairs.uncontrollable > 0 {
        let unreached = stairs.uncontrollable_a();
        let tolerance = unreached.nrows() as f64 * f64::EPSILON * norm;
        for eigenvalue in eigenvalues(&unreached)?.into_iter().rev() {
            if eigenvalue.re >= -tolerance || on_axis(&unreached, eigenvalue, tolerance) {
                return Err(DesignError::NotStabilisable { eigenvalue: snapped(eigenvalue, tolerance) });
            }
        }
    }
    if n > MAX_PBH_STATES {
        return Ok(());
    }
    let tolerance = n as f64 * f64::EPSILON * norm;
    // The size of B says nothing about the states that it reaches.
    let size = if norm > 0.0 { norm } else { 1.0 };
    let input = &equation.factor.hi * (size / equation.factor.hi.norm().max(f64::MIN_POSITIVE));
    let mut unstable = eigenvalues(&equation.a.hi)?;
    // Of a pair of conjugates, one tells; the eigenvalues of a triangular matrix may be all the same.
    unstable.retain(|value| value.re >= -tolerance && value.im >= 0.0);
    unstable.dedup();
    for eigenvalue in unstable {
        if !moves(&equation.a.hi, &input, eigenvalue)? {
            return Err(DesignError::NotStabilisable { eigenvalue: snapped(eigenvalue, tolerance) });
        }
    }
    Ok(())
}

/// Refuses a Q that does not see a mode of A on the imaginary axis.
pub(super) fn require_detectable(equation: &Equation) -> Result<(), DesignError> {
    let stairs = staircase(&equation.a.hi.transpose(), &equation.q.hi)?;
    if stairs.uncontrollable == 0 {
        return Ok(());
    }
    let unseen = stairs.uncontrollable_a();
    let tolerance = unseen.nrows() as f64 * f64::EPSILON * equation.a.hi.norm();
    for eigenvalue in eigenvalues(&unseen)? {
        if on_axis(&unseen, eigenvalue, tolerance) {
            let eigenvalue = snapped(Complex64::new(0.0, eigenvalue.im.abs()), tolerance);
            return Err(DesignError::NotDetectable { eigenvalue });
        }
    }
    Ok(())
}

/// An eigenvalue to be named: parts that are zero up to rounding are zero.
fn snapped(eigenvalue: Complex64, tolerance: f64) -> Complex64 {
    let part = |value: f64| if value.abs() <= tolerance { 0.0 } else { value };
    Complex64::new(part(eigenvalue.re), part(eigenvalue.im))
}

/// Whether the point of the axis beside `eigenvalue` is an eigenvalue of `m` up to a change of `m` by `tolerance`.
///
/// The distance of a computed eigenvalue from the axis would not tell: a double one is off by the root of the rounding.
fn on_axis(m: &DMatrix<f64>, eigenvalue: Complex64, tolerance: f64) -> bool {
    if eigenvalue.re.abs() > 1e-2 * m.norm() {
        return false;
    }
    let mut shifted = m.map(|value| Complex64::new(value, 0.0));
    for i in 0..m.nrows() {
        shifted[(i, i)] -= Complex64::new(0.0, eigenvalue.im);
    }
    // The inverse's Frobenius norm bounds the smallest singular value from below within sqrt(n).
    shifted.try_inverse().is_none_or(|inverse| {
        let norm = inverse.norm();
        !norm.is_finite() || norm * tolerance >= 1.0
    })
}

/// The pole nearest to the axis, if it is on it as far as the entries of the Hamiltonian are known.
///
/// Decided in three scalings, since one in which the matrix is far from singular settles that it is not: the equation's
/// own, the one in which X has a unit diagonal, and the balanced one.
pub(super) fn marginal_pole(equation: &Equation, refined: &Refined, nearest: Complex64) -> Option<Complex64> {
    let h = equation.hamiltonian();
    let n = equation.states();
    let unit = |i: usize| {
        let diagonal = refined.x.hi[(i % n, i % n)].abs();
        let d = if diagonal > 0.0 { diagonal.sqrt().recip() } else { 1.0 };
        if i < n { d } else { 1.0 / d }
    };
    let unit_diagonal = DMatrix::from_fn(2 * n, 2 * n, |i, j| h[(i, j)] / unit(i) * unit(j));
    let on_axis_in = |scaled: &DMatrix<f64>| {
        let tolerance = 10.0 * scaled.nrows() as f64 * f64::EPSILON * scaled.norm();
        on_axis(scaled, nearest, tolerance)
    };
    [&h, &unit_diagonal, &balance(&h).0].into_iter().all(on_axis_in).then(|| Complex64::new(0.0, nearest.im.abs()))
}

/// Why there is no solution: an eigenvalue on the axis, or only too little accuracy.
pub(super) fn no_solution(equation: &Equation, residual: f64) -> DesignError {
    let inaccurate = DesignError::Inaccurate { equation: EQUATION, residual };
    let h = balance(&equation.hamiltonian()).0;
    let tolerance = 10.0 * h.nrows() as f64 * f64::EPSILON * h.norm();
    let Ok(mut nearest) = eigenvalues(&h) else { return inaccurate };
    nearest.retain(|value| value.im >= 0.0);
    nearest.sort_by(|x, y| x.re.abs().total_cmp(&y.re.abs()));
    // The few that are nearest to the axis: each costs an inverse.
    nearest
        .iter()
        .take(4)
        .find(|value| on_axis(&h, **value, tolerance))
        .map_or(inaccurate, |value| DesignError::HamiltonianOnAxis { eigenvalue: Complex64::new(0.0, value.im) })
}
