//! The `uav_trajectories` text form of piecewise polynomials: text in, checked pieces out, and back.
//!
//! One row per piece: duration, then the ascending coefficients of x, y, z and yaw, 33 columns, SI. As found in the
//! wild: `duration` or `Duration`, the header as a `#` comment or missing, commas, semicolons or tabs, decimal commas,
//! quotes, an index in front, columns in another order or without those that are 0, blank lines, CRLF, a byte order mark.

use std::iter;

use super::super::table::{Row, Separator, Table, finite, shortened};
use super::{COEFFICIENTS, Coordinate, Piece, PiecewisePolynomial, PolynomialError};

const COLUMNS: usize = 1 + 4 * COEFFICIENTS;

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

/// The quantity of a column.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    Duration,
    Coefficient(Coordinate, usize),
}

impl Place {
    /// By the name of a column: `duration`, `x^0` to `yaw^7` and beyond, also `x0` and `x_0`.
    fn named(name: &str) -> Option<Self> {
        let name = name.to_lowercase();
        if name == "duration" {
            return Some(Self::Duration);
        }
        let letters = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let power = name[letters.len()..].parse().ok().filter(|power| *power < 100)?;
        let letters = letters.trim_end_matches(['^', '_']);
        let coordinate = Coordinate::ALL.into_iter().find(|coordinate| coordinate.to_string() == letters)?;
        Some(Self::Coefficient(coordinate, power))
    }

    fn name(self) -> String {
        match self {
            Self::Duration => "duration".into(),
            Self::Coefficient(coordinate, power) => format!("{coordinate}^{power}"),
        }
    }

    /// All columns, in the order of the format.
    fn all() -> impl Iterator<Item = Self> {
        let of = |coordinate| (0..COEFFICIENTS).map(move |power| Self::Coefficient(coordinate, power));
        iter::once(Self::Duration).chain(Coordinate::ALL.into_iter().flat_map(of))
    }
}

/// Whether a table holds such pieces: by a name of its header; without one by its columns, 33 or those of a higher degree.
pub(in crate::trajectory) fn recognises(table: &Table) -> bool {
    match &table.header {
        Some(header) => header.cells.iter().any(|name| Place::named(name).is_some()),
        None => table.columns() > 8,
    }
}

/// Reads the text of a whole file.
///
/// # Errors
/// [`CsvError`] for the first line that cannot be used.
pub fn parse(text: &str) -> Result<PiecewisePolynomial, CsvError> {
    Table::of(text).map_or(Err(CsvError::Empty), |table| read(&table))
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
            PolynomialError::Duration { piece, .. } | PolynomialError::Coefficient { piece, .. } => piece,
            PolynomialError::Jump { piece, .. } => piece + 1,
        };
        CsvError::Pieces { line: table.rows[piece - 1].line, reason }
    })
}

impl Place {
    fn power(self) -> Option<usize> {
        match self {
            Self::Duration => None,
            Self::Coefficient(_, power) => Some(power),
        }
    }
}

/// The quantities of the columns, by the header; without one in the order of the format.
fn places(table: &Table) -> Result<Vec<Place>, CsvError> {
    let Some(Row { line, cells }) = &table.header else {
        let columns = table.columns();
        // Of a higher degree, if it is the same for all four.
        let per_coordinate = columns.saturating_sub(1) / 4;
        if columns > COLUMNS && columns == 1 + 4 * per_coordinate {
            let of = |coordinate| (0..per_coordinate).map(move |power| Place::Coefficient(coordinate, power));
            return Ok(iter::once(Place::Duration).chain(Coordinate::ALL.into_iter().flat_map(of)).collect());
        }
        return Ok(Place::all().collect());
    };
    let mut places = Vec::new();
    for (name, column) in cells.iter().zip(1..) {
        match Place::named(name) {
            Some(place) if !places.contains(&place) => places.push(place),
            _ => return Err(CsvError::Header { line: *line, column, found: shortened(name) }),
        }
    }
    let required = [Coordinate::X, Coordinate::Y, Coordinate::Z].map(|coordinate| Place::Coefficient(coordinate, 0));
    match iter::once(Place::Duration).chain(required).find(|place| !places.contains(place)) {
        Some(missing) => Err(CsvError::Missing { line: *line, missing: missing.name() }),
        None => Ok(places),
    }
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

/// Most that is taken for rounding at a joint, m or rad: a craft still follows the smooth step that closes it.
const LARGEST_ROUNDING: f64 = 0.05;

/// How finely the numbers of a file are written.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Decimals {
    /// Most digits behind the point.
    places: i32,
    /// Most digits from the first that is not 0.
    significant: i32,
}

impl Decimals {
    fn of(table: &Table) -> Self {
        let mut most = Self { places: 0, significant: 1 };
        for cell in table.rows.iter().flat_map(|row| &row.cells) {
            let (mantissa, exponent) = cell.split_once(['e', 'E']).unwrap_or((cell, "0"));
            let exponent: i32 = exponent.parse().unwrap_or(0);
            let behind = mantissa.split_once(['.', ',']).map_or("", |(_, behind)| behind);
            let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
            let digits = digits.trim_start_matches('0');
            most.places = most.places.max(behind.len() as i32 - exponent);
            most.significant = most.significant.max(digits.len() as i32);
        }
        most
    }

    /// How far a number can be from the one that was written, at most: half a unit of the last place. Where more places
    /// are written than there are digits in any number, numbers were cut to significant digits instead.
    fn rounding(self, value: f64) -> f64 {
        let fixed = 0.5 * 10_f64.powi(-self.places);
        if self.places <= self.significant || value == 0.0 {
            return fixed;
        }
        let first = value.abs().log10().floor() as i32;
        fixed.max(0.5 * 10_f64.powi(first + 1 - self.significant))
    }

    /// How far two pieces that met can be apart at their joint by the rounding of their numbers, for each coordinate.
    /// Numbers of few places were written by hand, and a coordinate at rest is meant to be.
    fn roundings_at_joint(self, before: &Piece, after: &Piece) -> [f64; 4] {
        const FEWEST_PLACES: i32 = 4;
        let t_s = before.duration_s;
        Coordinate::ALL.map(|coordinate| {
            let coefficients = &before.coefficients[coordinate as usize];
            if self.places < FEWEST_PLACES || coefficients[1..].iter().all(|coefficient| *coefficient == 0.0) {
                return 0.0;
            }
            let of_coefficients =
                coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * t_s + self.rounding(*coefficient));
            let of_duration = before.derivative(coordinate, 1, t_s).abs() * self.rounding(t_s);
            let sum = of_coefficients + of_duration + self.rounding(after.coefficients[coordinate as usize][0]);
            sum.min(LARGEST_ROUNDING)
        })
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn decimals(row: &str) -> Decimals {
        Decimals::of(&Table::of(row).unwrap())
    }

    #[test]
    fn rounding_is_that_of_fixed_places_or_of_significant_digits() {
        // C's %.6f and its %g with six digits.
        assert_eq!(decimals("2.000000,-123.456789,0.000100"), Decimals { places: 6, significant: 9 });
        assert_eq!(decimals("2,-123.457,0.0123457,1e-05"), Decimals { places: 7, significant: 6 });
        let (fixed, significant) = (decimals("123.456789"), decimals("123.457,0.0123457"));
        assert_eq!((fixed.rounding(123.4), fixed.rounding(0.1)), (0.5e-6, 0.5e-6));
        assert_eq!((significant.rounding(123.4), significant.rounding(0.02)), (0.5e-3, 0.5e-7));
        // Seven powers of 2 s, half a millionth each, on top of the next piece's own half.
        let piece = Piece { duration_s: 2.0, coefficients: [[0.1; COEFFICIENTS]; 4] };
        let rest = Piece { duration_s: 2.0, coefficients: [[0.0; COEFFICIENTS]; 4] };
        let rounding = fixed.roundings_at_joint(&piece, &rest)[0];
        let velocity_m_s = piece.derivative(Coordinate::X, 1, 2.0);
        assert!((rounding - 0.5e-6 * (255.0 + velocity_m_s + 1.0)).abs() < 1e-18);
    }
}
