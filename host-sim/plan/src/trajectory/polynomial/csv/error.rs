//! Why a text is no file of polynomial pieces: the line, the column and the text there, in one line.

use super::COLUMNS;
use crate::trajectory::polynomial::PolynomialError;

/// Why a text is not such a file. Lines and columns count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CsvError {
    /// No row with a piece.
    #[error("no pieces: needs one row of {COLUMNS} numbers per piece (duration, then x^0..x^7, y^0.., z^0.., yaw^0..)")]
    Empty,
    /// A header with a column of another name, or one name twice.
    #[error(
        "line {line}, column {column}: the header has {found:?}; columns are duration, then x^0 to x^7, y^0 to \
        y^7, z^0 to z^7 and yaw^0 to yaw^7, each once"
    )]
    Header {
        /// The line, from 1.
        line: usize,
        /// The column.
        column: usize,
        /// The text there.
        found: String,
    },
    /// A header without a column that must be there.
    #[error("line {line}: the header has no {missing}; only yaw and the higher powers may be left out, and are 0 then")]
    Missing {
        /// The line, from 1.
        line: usize,
        /// The column.
        missing: String,
    },
    /// Polynomials of a higher degree than is flown.
    #[error(
        "line {line}: polynomials of degree {degree}; at most degree 7 is flown, on board and by the Crazyflie: {}",
        if *.zero { "all coefficients above x^7 are 0 here, so leave those columns out" } else {
            "fit the pieces anew with 8 coefficients each"
        }
    )]
    Degree {
        /// The line, from 1.
        line: usize,
        /// The degree.
        degree: usize,
        /// Whether the coefficients of all higher powers are 0.
        zero: bool,
    },
    /// A row that is too short or too long.
    #[error("line {line}: {found} columns; needs {COLUMNS} (duration, then 8 coefficients each of x, y, z and yaw; write 0 \
         for powers that are not used){}", if *.decimal_commas {
        "; if its numbers have decimal commas, separate the columns by semicolons"
    } else { "" })]
    Columns {
        /// The line, from 1.
        line: usize,
        /// How many columns it has, trailing separators not counted.
        found: usize,
        /// Whether commas both separate the columns and may be decimal.
        decimal_commas: bool,
    },
    /// A row with another number of columns than the header.
    #[error("line {line}: {found} columns where the header has {expected}")]
    Ragged {
        /// The line, from 1.
        line: usize,
        /// Its number of columns.
        found: usize,
        /// The header's number of columns.
        expected: usize,
    },
    /// A cell that is not a finite number.
    #[error("line {line}, {column}: {found:?} is not a finite number; write one such as 0.25")]
    Number {
        /// The line, from 1.
        line: usize,
        /// Name of the column.
        column: String,
        /// The text there, shortened.
        found: String,
    },
    /// A duration that is zero or negative.
    #[error("line {line}, duration: {value} s; must be positive: remove the row or correct it")]
    Duration {
        /// The line, from 1.
        line: usize,
        /// The duration, s.
        value: f64,
    },
    /// The rows are pieces, but not a trajectory.
    #[error("line {line}: {reason}")]
    Pieces {
        /// The line of the piece in question; of the later one at a jump.
        line: usize,
        /// The fault.
        #[source]
        reason: PolynomialError,
    },
}
