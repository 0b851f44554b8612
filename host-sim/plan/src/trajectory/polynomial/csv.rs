//! The `uav_trajectories` text form of piecewise polynomials: text in, checked pieces out, and back.
//!
//! One row per piece: duration, then the ascending coefficients of x, y, z and yaw, 33 columns, SI. As found in the
//! wild: `duration` or `Duration`, the header as a `#` comment or missing, trailing commas, blank lines, `#` lines,
//! spaces, CRLF, a byte order mark.

use super::{COEFFICIENTS, Coordinate, Piece, PiecewisePolynomial, PolynomialError};

const COLUMNS: usize = 1 + 4 * COEFFICIENTS;

/// Why a text is not such a file. Lines and columns count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CsvError {
    /// No row with a piece.
    #[error("no pieces: needs one row of {COLUMNS} numbers per piece (duration, then x^0..x^7, y^0.., z^0.., yaw^0..)")]
    Empty,
    /// A header with other columns or another order.
    #[error(
        "line {line}, column {column}: the header has {found:?} where this format has {expected:?}; reorder the columns"
    )]
    Header {
        /// Which line.
        line: usize,
        /// Which column.
        column: usize,
        /// The text there.
        found: String,
        /// What should.
        expected: String,
    },
    /// A row that is too short or too long.
    #[error(
        "line {line}: {found} columns; needs {COLUMNS} (duration, then 8 coefficients each of x, y, z and yaw; write 0 \
         for what is not used)"
    )]
    Columns {
        /// Which line.
        line: usize,
        /// How many columns it has, trailing commas not counted.
        found: usize,
    },
    /// A cell that is not a finite number.
    #[error("line {line}, {column}: {found:?} is not a finite number; write one such as 0.25")]
    Number {
        /// Which line.
        line: usize,
        /// Name of the column.
        column: String,
        /// The text there, shortened.
        found: String,
    },
    /// A duration that is zero or negative.
    #[error("line {line}, duration: {value} s; must be positive: remove the row or correct it")]
    Duration {
        /// Which line.
        line: usize,
        /// The duration, s.
        value: f64,
    },
    /// The rows are pieces, but not a trajectory.
    #[error("line {line}: {reason}")]
    Pieces {
        /// The line of the piece in question; of the later one at a jump.
        line: usize,
        /// What is wrong.
        reason: PolynomialError,
    },
}

/// `duration`, `x^0` .. `yaw^7`.
fn column_name(column: usize) -> String {
    match column.checked_sub(1) {
        None => "duration".into(),
        Some(i) => format!("{}^{}", Coordinate::ALL[i / COEFFICIENTS % 4], i % COEFFICIENTS),
    }
}

/// The cells of a row without the empty ones that trailing commas leave, each with spaces taken off.
fn cells(row: &str) -> Vec<&str> {
    let end = row.trim_end_matches(|c: char| c == ',' || c.is_whitespace()).len();
    row[..end].split(',').map(str::trim).collect()
}

/// Content lines with their numbers: no blank lines, no comments.
fn content(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    (text.lines().enumerate())
        .map(|(i, line)| (i + 1, line.trim()))
        .filter(|(_, line)| !line.trim_matches(',').is_empty() && !line.starts_with('#'))
}

fn is_header(row: &str) -> bool {
    cells(row)[0].eq_ignore_ascii_case("duration")
}

/// Whether the first line with content looks like this format: its header, or a row that starts with a number.
pub fn recognises(text: &str) -> bool {
    content(text)
        .next()
        .is_some_and(|(_, line)| is_header(line) || (line.contains(',') && cells(line)[0].parse::<f64>().is_ok()))
}

/// Reads the text of a whole file.
///
/// # Errors
/// [`CsvError`] for the first line that cannot be used.
pub fn parse(text: &str) -> Result<PiecewisePolynomial, CsvError> {
    let mut pieces = Vec::new();
    let mut lines = Vec::new();
    for (i, (line, row)) in content(text).enumerate() {
        if i == 0 && is_header(row) {
            check_header(line, row)?;
            continue;
        }
        pieces.push(parse_piece(line, row)?);
        lines.push(line);
    }
    PiecewisePolynomial::new(pieces).map_err(|reason| {
        let piece = match reason {
            PolynomialError::Empty => return CsvError::Empty,
            PolynomialError::TotalDuration => lines.len(),
            PolynomialError::Duration { piece, .. } | PolynomialError::Coefficient { piece, .. } => piece,
            PolynomialError::Jump { piece, .. } => piece + 1,
        };
        CsvError::Pieces { line: lines[piece - 1], reason }
    })
}

fn check_header(line: usize, row: &str) -> Result<(), CsvError> {
    let names = cells(row);
    for (column, found) in names.iter().enumerate().take(COLUMNS) {
        let expected = column_name(column);
        if !found.eq_ignore_ascii_case(&expected) {
            return Err(CsvError::Header { line, column: column + 1, found: shortened(found), expected });
        }
    }
    if names.len() == COLUMNS { Ok(()) } else { Err(CsvError::Columns { line, found: names.len() }) }
}

fn parse_piece(line: usize, row: &str) -> Result<Piece, CsvError> {
    let cells = cells(row);
    if cells.len() != COLUMNS {
        return Err(CsvError::Columns { line, found: cells.len() });
    }
    let mut numbers = [0.0; COLUMNS];
    for (column, (number, cell)) in numbers.iter_mut().zip(&cells).enumerate() {
        *number = cell.parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(|| CsvError::Number {
            line,
            column: column_name(column),
            found: shortened(cell),
        })?;
    }
    let [duration_s, rest @ ..] = numbers;
    if duration_s <= 0.0 {
        return Err(CsvError::Duration { line, value: duration_s });
    }
    let mut coefficients = [[0.0; COEFFICIENTS]; 4];
    coefficients.as_flattened_mut().copy_from_slice(&rest);
    Ok(Piece { duration_s, coefficients })
}

/// As much of a cell as fits an error of one line.
fn shortened(cell: &str) -> String {
    const LONGEST: usize = 40;
    if cell.chars().count() <= LONGEST { cell.into() } else { cell.chars().take(LONGEST).chain(['\u{2026}']).collect() }
}

/// The trajectory as such a file, with every digit it takes to read back the same.
pub fn write(trajectory: &PiecewisePolynomial) -> String {
    let names: Vec<String> = (0..COLUMNS).map(column_name).collect();
    let mut text = names.join(",");
    text.push('\n');
    for piece in trajectory.pieces() {
        let mut cells = vec![piece.duration_s.to_string()];
        cells.extend(piece.coefficients.as_flattened().iter().map(f64::to_string));
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    text
}
