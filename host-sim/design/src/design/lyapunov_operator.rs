//! The map `X -> A' X + X A` of a Lyapunov equation and of each Newton step on a Riccati equation: A in, its inverse map
//! out.

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::DesignError;
use super::triangular::{Pencil, solve_by_columns};
use crate::analysis::{ComplexSchur, MatrixError, complex_schur, require_finite};

/// The map `X -> A' X + X A`, ready to be inverted.
pub(super) struct LyapunovOperator {
    schur: ComplexSchur,
}

impl LyapunovOperator {
    pub(super) fn new(a: &DMatrix<f64>) -> Result<Self, MatrixError> {
        require_finite("A", a)?;
        Ok(Self { schur: complex_schur(a)? })
    }

    /// X with `A' X + X A + C = 0` for a symmetric C; not finite if two eigenvalues of A add up to exactly zero.
    pub(super) fn solve(&self, c: &DMatrix<f64>) -> DMatrix<f64> {
        // Column j of T* Y + Y T = -U* C U, with the columns before it known: (T* + t_jj I) y_j = -c_j - sum_(k<j) t_kj y_k.
        solve_by_columns(&self.schur, c, |t, known, column| {
            let j = known.ncols();
            for (k, solved) in known.column_iter().enumerate() {
                let factor = t[(k, j)];
                if factor != Complex64::ZERO {
                    column.axpy(-factor, &solved, Complex64::ONE);
                }
            }
            Pencil { adjoint: Complex64::ONE, identity: t[(j, j)] }
        })
    }

    /// Refuses A if two of its eigenvalues add up to zero within the rounding of A.
    pub(super) fn require_regular(&self, norm: f64) -> Result<(), DesignError> {
        let values = self.schur.eigenvalues();
        let tolerance = values.len() as f64 * f64::EPSILON * norm;
        for (i, first) in values.iter().enumerate() {
            for second in &values[i..] {
                // Eigenvalues of a real matrix come in conjugate pairs: conj(first) is one of them.
                if (first.conj() + second).norm() <= tolerance {
                    return Err(DesignError::OppositeEigenvalues { first: first.conj(), second: *second });
                }
            }
        }
        Ok(())
    }
}
