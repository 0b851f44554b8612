//! Trajectory files of any accepted form: a path or a text in, its contents out. The content decides, not the name.
//!
//! - rows of polynomial pieces in the `uav_trajectories` form ([`super::polynomial::csv`]);
//! - control points of a clamped uniform B-spline as JSON or TOML: `degree`, `duration_s` (s) and `control_points_m`
//!   (`[[x, y, z], ...]`, m);
//! - several such curves flown one after the other, as `curves = [...]`;
//! - a planning problem as TOML, known by its `waypoints`; it is handed on as text;
//! - bytes in the Crazyflie's compressed form ([`super::compressed`]).

mod control_points;
mod error;

use std::io;
use std::path::Path;

use super::bspline::BSpline;
use super::compressed;
use super::polynomial::PiecewisePolynomial;
use super::polynomial::csv;
use super::table::Table;
use super::waypoints::{self, Kind};
use crate::bounded;
use crate::quote::{line_at, line_of};
use control_points::{curves, spline};
pub use error::FileError;

/// The contents of a trajectory file.
#[derive(Clone, Debug, PartialEq)]
pub enum TrajectoryFile {
    /// Polynomial pieces, ready to fly.
    Pieces(PiecewisePolynomial),
    /// A B-spline, ready to fly.
    Spline(BSpline),
    /// The text of a planning problem, not looked at any further.
    Plan(String),
}

/// The bytes of a file or device, as far as a trajectory or a plan can be long.
///
/// # Errors
/// [`FileError::Unreadable`] and [`FileError::TooLong`].
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, FileError> {
    bounded::read(path).map_err(|reason| {
        let name = path.display().to_string();
        match reason.kind() {
            io::ErrorKind::FileTooLarge => FileError::TooLong { name },
            _ => FileError::Unreadable { name, reason },
        }
    })
}

/// The same as text.
///
/// # Errors
/// Those of [`read_bytes`], and [`FileError::NotUtf8`].
pub fn read_text(path: &Path) -> Result<String, FileError> {
    String::from_utf8(read_bytes(path)?).map_err(|error| {
        let line = line_at(error.as_bytes(), error.utf8_error().valid_up_to());
        FileError::NotUtf8 { name: path.display().to_string(), line }
    })
}

/// Reads and recognises the file at `path`.
///
/// # Errors
/// [`FileError`], naming the file as `path` does.
pub fn read(path: &Path) -> Result<TrajectoryFile, FileError> {
    let name = path.display().to_string();
    let bytes = read_bytes(path)?;
    // No text has a byte of 0; short numbers in the compressed form nearly always do, and they fill it to its end.
    if bytes.contains(&0)
        && let Ok(pieces) = compressed::from_bytes(&bytes)
    {
        return Ok(TrajectoryFile::Pieces(pieces));
    }
    match std::str::from_utf8(&bytes) {
        Ok(text) => parse(&name, text),
        Err(error) => Err(FileError::NotUtf8 { name, line: line_at(&bytes, error.valid_up_to()) }),
    }
}

/// Recognises the `text` of a file called `name`.
///
/// # Errors
/// [`FileError`]; never [`FileError::Unreadable`] or [`FileError::NotUtf8`].
pub fn parse(name: &str, text: &str) -> Result<TrajectoryFile, FileError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let unrecognised = |found: String| FileError::Unrecognised { name: name.into(), found };
    if text.trim().is_empty() {
        return Err(unrecognised("the file is empty".into()));
    }
    let is_name = |name: &str| csv::is_name(name) || waypoints::is_name(name);
    if let Some(table) = Table::of_named(text, is_name).filter(looks_like_rows) {
        return rows(name, &table);
    }
    if text.trim_start().starts_with('{') {
        let keys_error = |error: &serde_json::Error| FileError::Keys {
            name: name.into(),
            line: error.line(),
            reason: without_place(&error.to_string()),
        };
        let value: serde_json::Value = serde_json::from_str(text).map_err(|error| keys_error(&error))?;
        return if value.get("curves").is_some() {
            curves(name, serde_json::from_str(text).map_err(|error| keys_error(&error))?)
        } else {
            spline(name, serde_json::from_str(text).map_err(|error| keys_error(&error))?)
        };
    }
    let keys_error = |error: &toml::de::Error| FileError::Keys {
        name: name.into(),
        line: line_of(text, error),
        reason: one_line(error.message()),
    };
    let table: toml::Table = match toml::from_str(text) {
        Ok(table) => table,
        // A file that sets something was meant as TOML: say where it fails.
        Err(error) if text.contains('=') => return Err(keys_error(&error)),
        Err(_) => return Err(unrecognised("neither rows of numbers nor keys with values".into())),
    };
    let has = |key: &str| table.contains_key(key);
    if has("curves") {
        return curves(name, toml::from_str(text).map_err(|error| keys_error(&error))?);
    }
    match (has("waypoints"), has("control_points_m")) {
        (true, true) => Err(unrecognised("has both waypoints and control_points_m; keep one of them".into())),
        (true, false) => Ok(TrajectoryFile::Plan(text.into())),
        // Without its points, a file with a degree was still meant as a spline: the reader names the missing key.
        (false, points) if points || has("degree") => {
            spline(name, toml::from_str(text).map_err(|error| keys_error(&error))?)
        }
        (false, _) if table.is_empty() => Err(unrecognised("nothing but comments".into())),
        (false, _) => {
            let keys: Vec<&str> = table.keys().map(String::as_str).take(5).collect();
            Err(unrecognised(one_line(&format!("has only the keys {}", keys.join(", ")))))
        }
    }
}

/// Whether a table is rows of numbers, rather than keys or prose: its header names columns of pieces or waypoints, or its
/// first row has a number in the first two columns.
fn looks_like_rows(table: &Table) -> bool {
    match &table.header {
        Some(_) => csv::recognises(table) || waypoints::recognise(table).is_some(),
        None => {
            let first = table.rows.first().map_or(&[][..], |row| &row.cells[..]);
            first.len() > 1 && first[..2].iter().any(|cell| super::table::number(cell).is_some())
        }
    }
}

fn rows(name: &str, table: &Table) -> Result<TrajectoryFile, FileError> {
    let name = name.to_owned();
    match waypoints::recognise(table).filter(|_| table.header.is_none() || !csv::recognises(table)) {
        Some(Kind::Waypoints { timed }) => Err(FileError::Waypoints { name, timed }),
        Some(Kind::Samples) => {
            let columns = match &table.header {
                Some(header) => super::table::shortened(&header.cells.join(",")),
                None => format!("{} columns without names", table.columns()),
            };
            Err(FileError::Samples { name, columns })
        }
        None => csv::read(table).map(TrajectoryFile::Pieces).map_err(|reason| FileError::Pieces { name, reason }),
    }
}

/// A reader's message with its line breaks taken out.
fn one_line(message: &str) -> String {
    message.split(['\n', '\r']).map(str::trim).filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ")
}

/// A JSON error without the place at its end, which is told apart.
fn without_place(message: &str) -> String {
    one_line(message.rsplit_once(" at line ").map_or(message, |(reason, _)| reason))
}
