//! Why a vehicle cannot be had, in one line that names the file or the field and the remedy.

use std::path::PathBuf;

use quatrack_design::vehicle::VehicleError;

/// Why a vehicle cannot be had by its name or from its file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VehicleFileError {
    /// Not one of the built-in names.
    #[error("vehicle {name}: unknown; the built-in ones are {known}, others are files ending in .toml")]
    Unknown {
        /// The name as given.
        name: String,
        /// The built-in names.
        known: String,
    },
    /// The file cannot be read.
    #[error("{}: cannot be read ({reason})", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's message.
        reason: String,
    },
    /// A vehicle that TOML does not hold.
    #[error("vehicle: cannot be written as TOML ({reason})")]
    Unwritable {
        /// The writer's message.
        reason: String,
    },
    /// Not TOML, a key that is unknown or missing, or a value of the wrong type.
    #[error("vehicle, line {line}: {reason}")]
    Syntax {
        /// The line, from 1.
        line: usize,
        /// The parser's message, in one line.
        reason: String,
    },
    /// An error in a file.
    #[error("{}: {error}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The error.
        #[source]
        error: Box<VehicleFileError>,
    },
    /// A name or a figure that no vehicle has.
    #[error(transparent)]
    Refused(#[from] VehicleError),
}
