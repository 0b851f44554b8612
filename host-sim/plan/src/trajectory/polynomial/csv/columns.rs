//! The columns of such a file: a header's names in; the quantity of each column, or the name that is wrong, out.

use std::iter;

use super::{COLUMNS, CsvError};
use crate::trajectory::polynomial::{COEFFICIENTS, Coordinate};
use crate::trajectory::table::{Row, Table, shortened};

/// The quantity of a column.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Place {
    Duration,
    Coefficient(Coordinate, usize),
}

impl Place {
    /// By the name of a column: `duration`, `x^0` to `yaw^7` and beyond, also `x0` and `x_0`.
    pub(super) fn named(name: &str) -> Option<Self> {
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

    pub(super) fn name(self) -> String {
        match self {
            Self::Duration => "duration".into(),
            Self::Coefficient(coordinate, power) => format!("{coordinate}^{power}"),
        }
    }

    /// All columns, in the order of the format.
    pub(super) fn all() -> impl Iterator<Item = Self> {
        let of = |coordinate| (0..COEFFICIENTS).map(move |power| Self::Coefficient(coordinate, power));
        iter::once(Self::Duration).chain(Coordinate::ALL.into_iter().flat_map(of))
    }

    /// The power of a coefficient's column.
    pub(super) fn power(self) -> Option<usize> {
        match self {
            Self::Duration => None,
            Self::Coefficient(_, power) => Some(power),
        }
    }
}

/// The quantities of the columns, by the header; without one in the order of the format.
pub(super) fn places(table: &Table) -> Result<Vec<Place>, CsvError> {
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
