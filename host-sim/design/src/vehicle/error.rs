//! Why there is no vehicle, in one line that names the field and the remedy.

use std::path::PathBuf;

/// Why there is no vehicle.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum VehicleError {
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
        /// Which file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// Not TOML, a key that is unknown or missing, or a value of the wrong type.
    #[error("vehicle, line {line}: {reason}")]
    Syntax {
        /// Where, from 1.
        line: usize,
        /// What the parser says, in one line.
        reason: String,
    },
    /// A figure out of range.
    #[error("vehicle: {field} = {value}: must be {must}")]
    Value {
        /// The key with its table.
        field: String,
        /// The figure as read.
        value: f64,
        /// What it must be.
        must: String,
    },
}
