//! Singular values by one-sided Jacobi rotations, and the numerical rank read from them.
//!
//! Jacobi finds small singular values of badly scaled columns to full relative accuracy, which a rank decision needs,
//! and its sweeps are bounded (Demmel and Veselic 1992).

use nalgebra::DMatrix;
use num_complex::Complex64;
use serde::Serialize;

/// Sweeps after which the columns are taken as they are: 5 to 10 are usual.
const MAX_SWEEPS: usize = 60;

/// A rank and the singular values that decided it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NumericalRank {
    /// Singular values above `tolerance`.
    pub rank: usize,
    /// Largest singular value that is not counted as zero is above this; absolute, in the units of the matrix.
    pub tolerance: f64,
    /// All singular values, largest first.
    pub singular_values: Vec<f64>,
}

/// Singular values of a matrix of any shape, largest first, `min(rows, columns)` of them.
pub fn singular_values(m: &DMatrix<f64>) -> Vec<f64> {
    let mut u = if m.nrows() >= m.ncols() { m.clone() } else { m.transpose() };
    let columns = u.ncols();
    for _ in 0..MAX_SWEEPS {
        let mut rotated = false;
        for i in 0..columns {
            for j in i + 1..columns {
                let (alpha, beta) = (u.column(i).norm_squared(), u.column(j).norm_squared());
                let gamma = u.column(i).dot(&u.column(j));
                if gamma == 0.0 || gamma.abs() <= f64::EPSILON * (alpha * beta).sqrt() {
                    continue;
                }
                rotated = true;
                let zeta = (beta - alpha) / (2.0 * gamma);
                let t = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
                let c = 1.0 / t.hypot(1.0);
                let s = c * t;
                for row in 0..u.nrows() {
                    let (x, y) = (u[(row, i)], u[(row, j)]);
                    u[(row, i)] = c * x - s * y;
                    u[(row, j)] = s * x + c * y;
                }
            }
        }
        if !rotated {
            break;
        }
    }
    let mut values: Vec<f64> = u.column_iter().map(|column| column.norm()).collect();
    values.sort_by(|x, y| y.total_cmp(x));
    values
}

/// Rank by the singular values: those above `max(rows, columns) * eps * sigma_max` count.
///
/// The tolerance is the size of the rounding errors with which such a matrix can be known at all.
pub fn numerical_rank(m: &DMatrix<f64>) -> NumericalRank {
    let values = singular_values(m);
    let largest = values.first().copied().unwrap_or(0.0);
    rank_above(values, m.nrows().max(m.ncols()) as f64 * f64::EPSILON * largest)
}

/// Rank by a tolerance that the caller states.
pub(crate) fn rank_above(singular_values: Vec<f64>, tolerance: f64) -> NumericalRank {
    let rank = singular_values.iter().filter(|value| **value > tolerance).count();
    NumericalRank { rank, tolerance, singular_values }
}

/// Singular values of a complex matrix: those of `[re -im; im re]`, each of which comes twice.
pub(crate) fn complex_singular_values(m: &DMatrix<Complex64>) -> Vec<f64> {
    let (rows, columns) = m.shape();
    let embedded = DMatrix::from_fn(2 * rows, 2 * columns, |i, j| {
        let value = m[(i % rows, j % columns)];
        match (i < rows, j < columns) {
            (true, true) | (false, false) => value.re,
            (true, false) => -value.im,
            (false, true) => value.im,
        }
    });
    singular_values(&embedded).into_iter().step_by(2).collect()
}
