//! The `uav_trajectories` text form of piecewise polynomials: text in, checked pieces out, and back.
//!
//! One row per piece: duration, then the ascending coefficients of x, y, z and yaw, 33 columns, SI. As found in the
//! wild: `duration` or `Duration`, the header as a `#` comment or missing, commas, semicolons or tabs, decimal commas,
//! quotes, an index in front, columns in another order or without those that are 0, blank lines, CRLF, a byte order mark.

mod columns;
mod decimals;
mod error;

use super::super::table::{Row, Separator, Table, finite, shortened};
use super::{COEFFICIENTS, Piece, PiecewisePolynomial, PolynomialError};
use columns::{Place, places};
use decimals::Decimals;
pub use error::CsvError;

const COLUMNS: usize = 1 + 4 * COEFFICIENTS;

/// Whether a table holds such pieces: by a name of its header; without one by its columns, 33 or those of a higher degree.
pub(in crate::trajectory) fn recognises(table: &Table) -> bool {
    match &table.header {
        Some(header) => header.cells.iter().any(|name| Place::named(name).is_some()),
        None => table.columns() > 8,
    }
}

/// Whether a name of a column is one that pieces have.
pub(in crate::trajectory) fn is_name(name: &str) -> bool {
    Place::named(name).is_some()
}

/// Reads the text of a whole file.
///
/// # Errors
/// [`CsvError`] for the first line that cannot be used.
pub fn parse(text: &str) -> Result<PiecewisePolynomial, CsvError> {
    Table::of_named(text, is_name).map_or(Err(CsvError::Empty), |table| read(&table))
}

/// Reads a table.
pub(in crate::trajectory) fn read(table: &Table) -> Result<PiecewisePolynomial, CsvError> {
    let places = places(table)?;
    let pieces: Vec<Piece> = table.rows.iter().map(|row| piece(table, &places, row)).collect::<Result<_, _>>()?;
    if let Some(degree) = places.iter().filter_map(|place| place.power()).max().filter(|power| *power >= COEFFICIENTS) {
        let line = table.header.as_ref().or_else(|| table.rows.first()).map_or(1, |row| row.line);
        let beyond = |row: &Row| {
            let cells = places.iter().zip(&row.cells).filter(|(place, _)| place.power() >= Some(COEFFICIENTS));
            cells.into_iter().all(|(_, cell)| finite(cell) == Some(0.0))
        };
        return Err(CsvError::Degree { line, degree, zero: table.rows.iter().all(beyond) });
    }
    let decimals = Decimals::of(table);
    let roundings: Vec<[f64; 4]> =
        pieces.windows(2).map(|pair| decimals.roundings_at_joint(&pair[0], &pair[1])).collect();
    PiecewisePolynomial::with_roundings(pieces, &roundings).map_err(|reason| {
        let piece = match reason {
            PolynomialError::Empty => return CsvError::Empty,
            PolynomialError::TotalDuration => table.rows.len(),
            PolynomialError::Duration { piece, .. }
            | PolynomialError::Boundaries { piece, .. }
            | PolynomialError::Coefficient { piece, .. } => piece,
            PolynomialError::Jump { piece, .. } => piece + 1,
        };
        CsvError::Pieces { line: table.rows[piece - 1].line, reason }
    })
}

fn piece(table: &Table, places: &[Place], Row { line, cells }: &Row) -> Result<Piece, CsvError> {
    let (line, found) = (*line, cells.len());
    if found != places.len() {
        let of_format = places.len() == COLUMNS;
        let decimal_commas = table.separator == Separator::Comma && found > places.len() + 4;
        return Err(if of_format {
            CsvError::Columns { line, found, decimal_commas }
        } else {
            CsvError::Ragged { line, found, expected: places.len() }
        });
    }
    let mut piece = Piece { duration_s: 0.0, coefficients: [[0.0; COEFFICIENTS]; 4] };
    for (place, cell) in places.iter().zip(cells) {
        let value =
            finite(cell).ok_or_else(|| CsvError::Number { line, column: place.name(), found: shortened(cell) })?;
        match *place {
            Place::Duration => piece.duration_s = value,
            Place::Coefficient(coordinate, power) => {
                if let Some(coefficient) = piece.coefficients[coordinate as usize].get_mut(power) {
                    *coefficient = value;
                }
            }
        }
    }
    if piece.duration_s <= 0.0 {
        return Err(CsvError::Duration { line, value: piece.duration_s });
    }
    Ok(piece)
}

/// The trajectory as such a file, with every digit it takes to read back the same.
pub fn write(trajectory: &PiecewisePolynomial) -> String {
    let names: Vec<String> = Place::all().map(Place::name).collect();
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
