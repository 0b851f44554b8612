//! Gain matrices: rows of numbers in, a matrix that is known to be finite and to use every error out.

use core::fmt;

use nalgebra::SMatrix;

/// A constant feedback gain: `M` outputs from `N` errors, finite, every column with an entry that is not zero.
///
/// Because of the last condition a step looks at its outputs alone: an error that is not finite shows in one of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain<const M: usize, const N: usize> {
    rows: [[f32; N]; M],
}

/// Why a matrix is no gain.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum GainError {
    /// An entry is infinite or not a number.
    NonFinite {
        /// Row, from 0.
        row: usize,
        /// Column, from 0.
        column: usize,
    },
    /// An error that no output answers to: a broken sensor would go unnoticed.
    UnusedError {
        /// The column of zeros, from 0.
        column: usize,
    },
}

impl fmt::Display for GainError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NonFinite { row, column } => write!(f, "gain: entry ({row}, {column}) is not finite"),
            Self::UnusedError { column } => write!(f, "gain: column {column} is zero; every error must have an answer"),
        }
    }
}

impl core::error::Error for GainError {}

impl GainError {
    /// For tables in the source: a bad one does not compile when it initialises a constant.
    pub(crate) const fn refuse_to_compile(&self) -> ! {
        match self {
            Self::NonFinite { .. } => panic!("the gain table holds an entry that is not finite"),
            Self::UnusedError { .. } => panic!("the gain table has a column of zeros"),
        }
    }
}

impl<const M: usize, const N: usize> Gain<M, N> {
    /// Checks a matrix given by rows.
    ///
    /// # Errors
    /// [`GainError`] names the entry or column.
    pub const fn new(rows: [[f32; N]; M]) -> Result<Self, GainError> {
        const { assert!(N <= 64, "each column has a bit of a u64") };
        match fault(rows.as_flattened(), N) {
            None => Ok(Self { rows }),
            Some(fault) => Err(fault),
        }
    }

    /// The rows.
    pub const fn rows(&self) -> &[[f32; N]; M] {
        &self.rows
    }

    /// The matrix, `M` by `N`.
    pub fn matrix(&self) -> SMatrix<f32, M, N> {
        SMatrix::<f32, N, M>::from(self.rows).transpose()
    }

    /// `K e`, row by row in a loop: small, for gains that have no structure of their own. The sums run in the order of the
    /// columns: a matrix library may choose another one on another target, and with it other last bits.
    #[cold]
    pub(crate) fn times(&self, error: &[f32; N]) -> [f32; M] {
        let mut product = [0.0; M];
        for (sum, row) in product.iter_mut().zip(&self.rows) {
            *sum = inner_product(row, error);
        }
        product
    }

    /// `-K`; twice gives back every bit.
    pub(crate) const fn negated(&self) -> Self {
        let mut rows = self.rows;
        let mut row = 0;
        while row < M {
            let mut column = 0;
            while column < N {
                rows[row][column] = -rows[row][column];
                column += 1;
            }
            row += 1;
        }
        Self { rows }
    }

    /// Whether every entry outside the listed ones, as (row, column), is zero.
    pub(crate) const fn is_zero_outside(&self, entries: &[(usize, usize)]) -> bool {
        is_zero_outside(self.rows.as_flattened(), N, entries)
    }
}

/// On slices, of whose length the compiler knows nothing and therefore unrolls nothing.
#[inline(never)]
fn inner_product(row: &[f32], error: &[f32]) -> f32 {
    row.iter().zip(error).fold(0.0, |sum, (k, e)| sum + k * e)
}

// Tables are checked once, when they are compiled or loaded: one function for all dimensions, and loops that stay loops.

/// The first entry, by rows, that is not finite, else the first column without an entry.
#[inline(never)]
const fn fault(entries: &[f32], columns: usize) -> Option<GainError> {
    let (mut rest, mut row, mut column) = (entries, 0, 0);
    // A bit for each column.
    let mut used: u64 = 0;
    while let Some((entry, after)) = rest.split_first() {
        if !entry.is_finite() {
            return Some(GainError::NonFinite { row, column });
        }
        used |= ((*entry != 0.0) as u64) << (column & 63);
        (row, column) = next(row, column, columns);
        rest = after;
    }
    let unused = used.trailing_ones() as usize;
    if unused < columns { Some(GainError::UnusedError { column: unused }) } else { None }
}

#[inline(never)]
const fn is_zero_outside(entries: &[f32], columns: usize, listed: &[(usize, usize)]) -> bool {
    let (mut rest, mut row, mut column) = (entries, 0, 0);
    while let Some((entry, after)) = rest.split_first() {
        if *entry != 0.0 && !contains(listed, row, column) {
            return false;
        }
        (row, column) = next(row, column, columns);
        rest = after;
    }
    true
}

const fn contains(listed: &[(usize, usize)], row: usize, column: usize) -> bool {
    let mut rest = listed;
    while let Some((place, after)) = rest.split_first() {
        if place.0 == row && place.1 == column {
            return true;
        }
        rest = after;
    }
    false
}

/// The place after (row, column), by rows.
const fn next(row: usize, column: usize, columns: usize) -> (usize, usize) {
    if column + 1 < columns { (row, column + 1) } else { (row + 1, 0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn product_is_the_matrix_product() {
        let gain = Gain::new([[1.0, 2.0, 3.0], [-4.0, 0.5, 0.0]]).unwrap();
        assert_eq!(gain.times(&[1.0, 10.0, 100.0]), [321.0, 1.0]);
        assert_eq!(gain.matrix()[(1, 0)], -4.0);
        assert_eq!(gain.matrix()[(0, 2)], 3.0);
    }

    #[test]
    fn references_that_cannot_be_flown_are_named() {
        assert_eq!(Gain::new([[1.0, f32::NAN]]), Err(GainError::NonFinite { row: 0, column: 1 }));
        assert_eq!(Gain::new([[1.0, 0.0], [2.0, -0.0]]), Err(GainError::UnusedError { column: 1 }));
    }
}
