//! Why a trajectory file cannot be used.

use std::io;

use crate::bounded::MOST_BYTES;
use crate::trajectory::bspline::BSplineError;
use crate::trajectory::polynomial::PolynomialError;
use crate::trajectory::polynomial::csv::CsvError;

/// Why a file cannot be used: one line with the file, where in it, the value and the remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// Missing, a folder, not permitted.
    #[error("{name}: cannot be read ({reason}); name an existing trajectory file")]
    Unreadable {
        /// The file.
        name: String,
        /// From the operating system.
        #[source]
        reason: io::Error,
    },
    /// Longer than any trajectory, or without an end.
    #[error("{name}: longer than {} MB, or a device without an end; name a trajectory file", MOST_BYTES >> 20)]
    TooLong {
        /// The file.
        name: String,
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
         TOML (degree, duration_s, control_points_m), a plan as TOML (waypoints), and the Crazyflie's compressed form"
    )]
    Unrecognised {
        /// The file.
        name: String,
        /// The form found instead.
        found: String,
    },
    /// Pieces that cannot be flown.
    #[error("{name}: {reason}")]
    Pieces {
        /// The file.
        name: String,
        /// Line, column, value and remedy.
        #[source]
        reason: CsvError,
    },
    /// Places to pass, which say nothing of how.
    #[error(
        "{name}: rows of waypoints{}, no trajectory yet; `quatrack plan {name}{} --toml planned.toml` plans one, which is \
         flown by --trajectory planned.toml",
        if *.timed { " with times" } else { "" },
        if *.timed { "" } else { " --speed-max-m-s 1 --acceleration-max-m-s2 2" }
    )]
    Waypoints {
        /// The file.
        name: String,
        /// Whether they have times.
        timed: bool,
    },
    /// A flight that was recorded or sampled.
    #[error(
        "{name}: rows of a flight sampled over time ({columns}), no trajectory; take some rows as waypoints, with the columns \
         t,x,y,z alone, and plan them with `quatrack plan`"
    )]
    Samples {
        /// The file.
        name: String,
        /// Its columns, shortened.
        columns: String,
    },
    /// Curves that do not follow each other.
    #[error("{name}: {reason}")]
    Curves {
        /// The file.
        name: String,
        /// The fault.
        #[source]
        reason: PolynomialError,
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
        /// The fault there.
        reason: String,
    },
    /// Control points that do not make a spline.
    #[error("{name}: {reason}")]
    Spline {
        /// The file.
        name: String,
        /// Key, value and remedy.
        #[source]
        reason: BSplineError,
    },
}
