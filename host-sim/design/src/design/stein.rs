//! The discrete Lyapunov (Stein) equation `A' X A - X + Q = 0`.
//!
//! In flow A and a symmetric Q, n x n; out flows X with its residual. Bartels and Stewart's way, for the discrete
//! equation after Kitagawa (1977): with the complex Schur form `A = U T U*` it becomes triangular and is solved column by
//! column; corrections with residuals in 32 digits then refine X to the last digit of an f64. It has one solution exactly
//! if no product of two eigenvalues of A is 1; otherwise [`DesignError::ReciprocalEigenvalues`].

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::double_double::DoubleMatrix;
use super::triangular::{Pencil, solve_by_columns};
use super::{DesignError, require_symmetric};
use crate::analysis::{ComplexSchur, MatrixError, complex_schur, require_finite, require_square};

/// Corrections at most: 2 or 3 are usual.
const MAX_CORRECTIONS: usize = 20;

/// Solution of `A' X A - X + Q = 0`.
#[derive(Debug, Clone)]
pub struct SteinSolution {
    /// X, n x n, symmetric.
    pub x: DMatrix<f64>,
    /// Frobenius norm of the residual of X over the sum of the norms of the terms, evaluated in 32 digits.
    pub relative_residual: f64,
    /// Last correction over X: how well X is known before it is rounded to f64.
    pub last_correction: f64,
}

/// Solves `A' X A - X + Q = 0` for a symmetric Q.
///
/// A need not be stable.
///
/// # Errors
/// [`DesignError::Matrix`] for matrices that do not fit or are not finite, [`DesignError::NotSymmetric`],
/// [`DesignError::ReciprocalEigenvalues`], [`DesignError::Inaccurate`] if the corrections do not settle.
pub fn stein(a: &DMatrix<f64>, q: &DMatrix<f64>) -> Result<SteinSolution, DesignError> {
    require_square("A", a)?;
    let q = require_symmetric("Q", q, a.nrows())?;
    let operator = SteinOperator::new(a)?;
    operator.require_regular()?;
    let precise_a = DoubleMatrix::new(a.clone());
    let residual = |x: &DoubleMatrix| {
        let moved = precise_a.transposed().times(&x.times(&precise_a));
        let mut value = moved.minus(x);
        value.add(&q);
        (value.symmetrised(), moved.hi.norm() + x.hi.norm() + q.norm())
    };
    let inaccurate = |residual| DesignError::Inaccurate { equation: "the discrete Lyapunov equation", residual };
    let mut x = DoubleMatrix::new(operator.solve(&q));
    let mut last_correction = f64::INFINITY;
    for _ in 0..MAX_CORRECTIONS {
        let correction = operator.solve(&residual(&x).0.hi);
        let relative = correction.norm() / x.hi.norm().max(f64::MIN_POSITIVE);
        if !relative.is_finite() {
            return Err(inaccurate(f64::NAN));
        }
        if relative > 0.5 * last_correction {
            break;
        }
        x.add(&correction);
        last_correction = relative;
        if relative < 1e-20 {
            break;
        }
    }
    let (value, terms) = residual(&DoubleMatrix::new(x.hi.clone()));
    let relative_residual = if terms == 0.0 { 0.0 } else { value.hi.norm() / terms };
    if last_correction > 1e-12 || !relative_residual.is_finite() {
        return Err(inaccurate(relative_residual));
    }
    Ok(SteinSolution { x: x.hi, relative_residual, last_correction })
}

/// The map `X -> A' X A - X`, ready to be inverted.
pub(super) struct SteinOperator {
    schur: ComplexSchur,
}

impl SteinOperator {
    pub(super) fn new(a: &DMatrix<f64>) -> Result<Self, MatrixError> {
        require_finite("A", a)?;
        Ok(Self { schur: complex_schur(a)? })
    }

    /// X with `A' X A - X + C = 0` for a symmetric C; not finite if two eigenvalues of A multiply to exactly 1.
    pub(super) fn solve(&self, c: &DMatrix<f64>) -> DMatrix<f64> {
        // Column j of T* Y T - Y = -U* C U: (t_jj T* - I) y_j = -c_j - T* sum_(k<j) t_kj y_k.
        solve_by_columns(&self.schur, c, |t, known, column| {
            let j = known.ncols();
            let mut before = vec![Complex64::ZERO; t.nrows()];
            for (k, solved) in known.column_iter().enumerate() {
                let factor = t[(k, j)];
                for (sum, value) in before.iter_mut().zip(solved.iter()) {
                    *sum += factor * value;
                }
            }
            for i in 0..t.nrows() {
                let moved: Complex64 = (0..=i).map(|k| t[(k, i)].conj() * before[k]).sum();
                column[i] -= moved;
            }
            Pencil { adjoint: t[(j, j)], identity: -Complex64::ONE }
        })
    }

    /// Refuses A if the product of two of its eigenvalues is 1 within its rounding.
    fn require_regular(&self) -> Result<(), DesignError> {
        let values = self.schur.eigenvalues();
        for (i, first) in values.iter().enumerate() {
            for second in &values[i..] {
                // Eigenvalues of a real matrix come in conjugate pairs: conj(first) is one of them.
                let product = first.conj() * second;
                let tolerance = values.len() as f64 * f64::EPSILON * product.norm().max(1.0);
                if (product - 1.0).norm() <= tolerance {
                    return Err(DesignError::ReciprocalEigenvalues { first: first.conj(), second: *second });
                }
            }
        }
        Ok(())
    }
}
