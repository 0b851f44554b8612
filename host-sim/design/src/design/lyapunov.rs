//! The continuous Lyapunov equation `A' X + X A + Q = 0`, and the paper's designs (15) and (17), which rest on it.
//!
//! In flow A and a symmetric Q (or a controllable pair and a decay rate); out flows X with its residual (or P and
//! `K = B' P / 2`).
//!
//! **Equation.** Bartels and Stewart (1972): with the complex Schur form `A = U T U*` the equation becomes triangular
//! and is solved column by column. A is balanced first, and the solution refined with residuals in 32 digits. It has
//! one solution exactly if no two eigenvalues of A add up to zero; otherwise [`DesignError::OppositeEigenvalues`].
//!
//! **Design.** `P A + A' P - P B B' P = -2 mu P` is linear in `Y = P^-1`:
//! `(A + mu I) Y + Y (A + mu I)' = B B'`. P > 0 exists for a controllable pair if every eigenvalue of A has real part
//! above -mu; the paper's statement "for any mu > 0" holds for its own models, all of whose eigenvalues are 0. The
//! closed loop `A - B K`, K = B' P / 2, satisfies `(A - B K)' P + P (A - B K) = -2 mu P`: every pole has real part
//! exactly -mu. Since `P B B' P` is quadratic, P is refined by Newton's method on the equation as printed.

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::double_double::DoubleMatrix;
use super::equation::Equation;
use super::lyapunov_operator::LyapunovOperator;
use super::newton::refine;
use super::{DesignError, require_symmetric};
use crate::analysis::{balance, eigenvalues, require_square, staircase};

/// Solution of `A' X + X A + Q = 0`.
#[derive(Debug, Clone)]
pub struct LyapunovSolution {
    /// X, n x n, symmetric.
    pub x: DMatrix<f64>,
    /// Frobenius norm of the residual of X over the sum of the norms of the terms, evaluated in 32 digits.
    pub relative_residual: f64,
    /// Last correction over X: how well X is known before it is rounded to f64.
    pub last_correction: f64,
}

/// A state feedback that gives every closed-loop pole the same real part, (LYAP-F) and (LYAP-E).
#[derive(Debug, Clone)]
pub struct DecayRateDesign {
    /// P > 0 of (15), n x n.
    pub p: DMatrix<f64>,
    /// `K = B' P / 2`, m x n, for u = -K x.
    pub gain: DMatrix<f64>,
    /// Eigenvalues of `A - B K`, 1/s.
    pub poles: Vec<Complex64>,
    /// Relative residual of P in (15), evaluated in 32 digits.
    pub relative_residual: f64,
}

/// Solves `A' X + X A + Q = 0` for a symmetric Q.
///
/// A need not be stable.
///
/// # Errors
/// [`DesignError::Matrix`] for matrices that do not fit or are not finite, [`DesignError::NotSymmetric`],
/// [`DesignError::OppositeEigenvalues`], [`DesignError::Inaccurate`] if the refinement does not settle.
pub fn lyapunov(a: &DMatrix<f64>, q: &DMatrix<f64>) -> Result<LyapunovSolution, DesignError> {
    require_square("A", a)?;
    let n = a.nrows();
    let q = require_symmetric("Q", q, n)?;
    let given = Equation::new(a.clone(), DoubleMatrix::new(DMatrix::zeros(n, 0)), q);
    let mut equation = given.clone();
    let (balanced, scale) = balance(a);
    equation.q.hi = DMatrix::from_fn(n, n, |i, j| given.q.hi[(i, j)] * scale[i] * scale[j]);
    equation.a.hi = balanced;
    equation.scale = scale;
    let operator = LyapunovOperator::new(&equation.a.hi)?;
    operator.require_regular(equation.a.hi.norm())?;
    let refined = refine(&equation, DoubleMatrix::new(operator.solve(&equation.q.hi)), f64::INFINITY)
        .filter(|refined| refined.last_correction < 1e-12)
        .ok_or(DesignError::Inaccurate { equation: "the Lyapunov equation", residual: f64::NAN })?;
    let x = equation.unscaled(&refined.x).hi;
    Ok(LyapunovSolution { relative_residual: given.relative_residual(&x), x, last_correction: refined.last_correction })
}

/// The paper's design (15), (17): P > 0 with `P A + A' P - P B B' P = -2 mu P` and K = B' P / 2.
///
/// # Errors
/// [`DesignError::Matrix`] for matrices that do not fit or are not finite, [`DesignError::DecayRate`],
/// [`DesignError::NotControllable`], [`DesignError::AlreadyFaster`] if mu does not exceed the fastest decay of the
/// plant itself, [`DesignError::Inaccurate`].
pub fn decay_rate_design(a: &DMatrix<f64>, b: &DMatrix<f64>, mu: f64) -> Result<DecayRateDesign, DesignError> {
    if !(mu.is_finite() && mu > 0.0) {
        return Err(DesignError::DecayRate { mu });
    }
    let stairs = staircase(a, b)?;
    if stairs.uncontrollable > 0 {
        let unreached = eigenvalues(&stairs.uncontrollable_a())?;
        return Err(DesignError::NotControllable { eigenvalue: unreached[unreached.len() - 1] });
    }
    let n = a.nrows();
    let shifted = a + DMatrix::identity(n, n) * mu;
    let open_loop = eigenvalues(a)?;
    // Sorted by real part: the first one decays fastest.
    if open_loop[0].re + mu <= n as f64 * f64::EPSILON * shifted.norm() {
        return Err(DesignError::AlreadyFaster { mu, eigenvalue: open_loop[0] });
    }
    let given = Equation::new(shifted, DoubleMatrix::new(b.clone()), DMatrix::zeros(n, n));
    let equation = given.clone().balanced();
    let inaccurate = |residual| DesignError::Inaccurate { equation: "equation (15)", residual };
    // (A + mu I) Y + Y (A + mu I)' - F F' = 0 is the Lyapunov equation of the transpose.
    let inverse = LyapunovOperator::new(&equation.a.hi.transpose())?
        .solve(&(-(&equation.factor.hi * equation.factor.hi.transpose())));
    let start = inverse.try_inverse().ok_or_else(|| inaccurate(f64::INFINITY))?;
    let refined = refine(&equation, DoubleMatrix::new(start).symmetrised(), f64::INFINITY)
        .ok_or_else(|| inaccurate(f64::INFINITY))?;
    let p = equation.unscaled(&refined.x);
    let relative_residual = given.relative_residual(&p.hi);
    if refined.last_correction > 1e-12 || !relative_residual.is_finite() {
        return Err(inaccurate(relative_residual));
    }
    let gain = given.factor.transposed().times(&p).hi * 0.5;
    // A - B K is (A + mu I - B B' P + A - mu I) / 2, but forming it from K gives the poles of the gain as it is flown.
    let poles = eigenvalues(&(a - b * &gain))?;
    Ok(DecayRateDesign { p: p.hi, gain, poles, relative_residual })
}
