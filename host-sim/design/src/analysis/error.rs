//! Refusals of a matrix (wrong shape, empty, not finite, no convergence), found before any question about it is answered.

use nalgebra::DMatrix;
use thiserror::Error;

/// A matrix that cannot be worked with: its name, its fault, a remedy.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MatrixError {
    /// Rows and columns differ where they must agree.
    #[error("{name} is {rows}x{columns}; it must be square")]
    NotSquare {
        /// Name of the matrix.
        name: &'static str,
        /// Its rows.
        rows: usize,
        /// Its columns.
        columns: usize,
    },
    /// A dimension does not fit the other matrices.
    #[error("{name} is {rows}x{columns}; it must be {expected_rows}x{expected_columns} to fit {fits}")]
    Dimension {
        /// Name of the matrix.
        name: &'static str,
        /// Its rows.
        rows: usize,
        /// Its columns.
        columns: usize,
        /// Rows it must have.
        expected_rows: usize,
        /// Columns it must have.
        expected_columns: usize,
        /// The matrix that it must fit.
        fits: &'static str,
    },
    /// No rows or no columns.
    #[error("{name} is empty; it needs at least one row and one column")]
    Empty {
        /// Name of the matrix.
        name: &'static str,
    },
    /// An entry is infinite or not a number.
    #[error("{name}[{row},{column}] is {value}; every entry must be finite")]
    NotFinite {
        /// Name of the matrix.
        name: &'static str,
        /// Row of the entry, from 0.
        row: usize,
        /// Column of the entry, from 0.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// The QR iteration used up its bound.
    #[error(
        "the eigenvalues of {name} were not found in {iterations} QR sweeps; scale the matrix or check its entries"
    )]
    EigenvaluesNotFound {
        /// Name of the matrix.
        name: &'static str,
        /// Sweeps spent on one eigenvalue.
        iterations: usize,
    },
}

/// Refuses an empty matrix and one with an infinite entry or one that is not a number.
pub(crate) fn require_finite(name: &'static str, m: &DMatrix<f64>) -> Result<(), MatrixError> {
    if m.is_empty() {
        return Err(MatrixError::Empty { name });
    }
    for column in 0..m.ncols() {
        for row in 0..m.nrows() {
            let value = m[(row, column)];
            if !value.is_finite() {
                return Err(MatrixError::NotFinite { name, row, column, value });
            }
        }
    }
    Ok(())
}

/// Refuses a matrix that is not square or that [`require_finite`] refuses.
pub(crate) fn require_square(name: &'static str, m: &DMatrix<f64>) -> Result<(), MatrixError> {
    if m.nrows() != m.ncols() {
        return Err(MatrixError::NotSquare { name, rows: m.nrows(), columns: m.ncols() });
    }
    require_finite(name, m)
}
