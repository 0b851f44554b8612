//! Trajectory files of any accepted form: a path or a text in, what it holds out. The content decides, not the name.
//!
//! - rows of polynomial pieces in the `uav_trajectories` form ([`super::polynomial::csv`]);
//! - control points of a clamped uniform B-spline as JSON or TOML: `degree`, `duration_s` (s) and `control_points_m`
//!   (`[[x, y, z], ...]`, m);
//! - a planning problem as TOML, known by its `waypoints`; it is handed on as text.

use std::path::Path;
use std::{fs, io};

use nalgebra::Vector3;
use serde::Deserialize;

use super::bspline::{BSpline, BSplineError};
use super::polynomial::PiecewisePolynomial;
use super::polynomial::csv::{self, CsvError};

/// What a trajectory file holds.
#[derive(Clone, Debug, PartialEq)]
pub enum TrajectoryFile {
    /// Polynomial pieces, ready to fly.
    Pieces(PiecewisePolynomial),
    /// A B-spline, ready to fly.
    Spline(BSpline),
    /// The text of a planning problem, not looked at any further.
    Plan(String),
}

/// Why a file cannot be used: one line with the file, where in it, the value and what to do.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// Missing, a folder, not permitted.
    #[error("{name}: cannot be read ({reason}); name an existing trajectory file")]
    Unreadable {
        /// The file.
        name: String,
        /// From the operating system.
        reason: io::Error,
    },
    /// Bytes that are not text.
    #[error("{name}: line {line} is not UTF-8; save the file as UTF-8 text")]
    NotUtf8 {
        /// The file.
        name: String,
        /// Line of the first such byte, from 1.
        line: usize,
    },
    /// None of the accepted forms.
    #[error(
        "{name}: {found}; accepted are polynomial pieces as CSV (header duration,x^0,..,yaw^7), control points as JSON or \
         TOML (degree, duration_s, control_points_m), and a plan as TOML (waypoints)"
    )]
    Unrecognised {
        /// The file.
        name: String,
        /// What it looks like instead.
        found: String,
    },
    /// Pieces that cannot be flown.
    #[error("{name}: {reason}")]
    Pieces {
        /// The file.
        name: String,
        /// Line, column, value and remedy.
        reason: CsvError,
    },
    /// Keys that are missing, unknown or of another type, or text that is not JSON or TOML.
    #[error(
        "{name}: line {line}: {reason}; control points are degree (1 to 7), duration_s (s) and control_points_m ([[x, y, z], ...], m)"
    )]
    Keys {
        /// The file.
        name: String,
        /// From 1.
        line: usize,
        /// What is wrong there.
        reason: String,
    },
    /// Control points that do not make a spline.
    #[error("{name}: {reason}")]
    Spline {
        /// The file.
        name: String,
        /// Key, value and remedy.
        reason: BSplineError,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ControlPoints {
    /// What `quatrack plan` writes before the rest.
    #[serde(default)]
    #[expect(dead_code, reason = "a file may say what it is")]
    schema: Option<String>,
    degree: usize,
    duration_s: f64,
    control_points_m: Vec<[f64; 3]>,
}

/// Reads and recognises the file at `path`.
///
/// # Errors
/// [`FileError`], naming the file as `path` does.
pub fn read(path: &Path) -> Result<TrajectoryFile, FileError> {
    let name = path.display().to_string();
    let bytes = match fs::read(path) {
        Ok(bytes) => bytes,
        Err(reason) => return Err(FileError::Unreadable { name, reason }),
    };
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
    if csv::recognises(text) {
        let reason = |reason| FileError::Pieces { name: name.into(), reason };
        return csv::parse(text).map(TrajectoryFile::Pieces).map_err(reason);
    }
    if text.trim_start().starts_with('{') {
        let points = serde_json::from_str(text).map_err(|error| FileError::Keys {
            name: name.into(),
            line: error.line(),
            reason: without_place(&error.to_string()),
        })?;
        return spline(name, points);
    }
    let keys_error = |error: &toml::de::Error| FileError::Keys {
        name: name.into(),
        line: line_at(text.as_bytes(), error.span().map_or(0, |span| span.start)),
        reason: one_line(error.message()),
    };
    let table: toml::Table = match toml::from_str(text) {
        Ok(table) => table,
        // A file that sets something was meant as TOML: say where it fails.
        Err(error) if text.contains('=') => return Err(keys_error(&error)),
        Err(_) => return Err(unrecognised("neither rows of numbers nor keys with values".into())),
    };
    let has = |key: &str| table.contains_key(key);
    match (has("waypoints"), has("control_points_m")) {
        (true, true) => Err(unrecognised("has both waypoints and control_points_m; keep one of them".into())),
        (true, false) => Ok(TrajectoryFile::Plan(text.into())),
        // Without its points, what has a degree was still meant as a spline: the reader names the missing key.
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

fn spline(name: &str, points: ControlPoints) -> Result<TrajectoryFile, FileError> {
    let control_points_m = points.control_points_m.into_iter().map(Vector3::from).collect();
    BSpline::new(points.degree, points.duration_s, control_points_m)
        .map(TrajectoryFile::Spline)
        .map_err(|reason| FileError::Spline { name: name.into(), reason })
}

/// The line, from 1, that holds byte `offset`.
fn line_at(bytes: &[u8], offset: usize) -> usize {
    1 + bytes.iter().take(offset).filter(|byte| **byte == b'\n').count()
}

/// A reader's message with its line breaks taken out.
fn one_line(message: &str) -> String {
    message.split(['\n', '\r']).map(str::trim).filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ")
}

/// A JSON error without the place at its end, which is told apart.
fn without_place(message: &str) -> String {
    one_line(message.rsplit_once(" at line ").map_or(message, |(reason, _)| reason))
}
