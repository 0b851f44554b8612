//! Why there is no scenario, in one line that names file, key, value, range and remedy.

use std::path::PathBuf;

use quatrack::ReferenceError;
use quatrack::airframe::AirframeError;
use quatrack::estimator::EstimatorError;

use crate::plant::PlantError;

/// Why there is no scenario.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// The file cannot be read.
    #[error("{}: cannot be read ({reason})", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's message.
        reason: String,
    },
    /// Not TOML, a key that is unknown or missing, or a value of the wrong type.
    #[error("{origin}, line {line}, `{text}`: {reason}")]
    Syntax {
        /// The file or flag that it is of.
        origin: String,
        /// The line, from 1.
        line: usize,
        /// The text there.
        text: String,
        /// The parser's message, in one line.
        reason: String,
    },
    /// A value without sense.
    #[error("{origin}: {key} = {value}: must be {must}")]
    Value {
        /// The file or flag that it is of.
        origin: String,
        /// The key with its table.
        key: &'static str,
        /// The value as read.
        value: String,
        /// Its required range, in words.
        must: String,
    },
    /// A vehicle or a trajectory that cannot be had.
    #[error("{origin}: {key}: {reason}")]
    Named {
        /// The file or flag that it is of.
        origin: String,
        /// The key.
        key: &'static str,
        /// Why not, with the remedy.
        reason: String,
    },
    /// A figure of the plant that is out of range.
    #[error("{origin}: {error}")]
    Plant {
        /// The file or flag that it is of.
        origin: String,
        /// The fault, and the remedy.
        #[source]
        error: PlantError,
    },
}

/// Why a flight does not start.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StartError {
    /// The craft's figures.
    #[error(transparent)]
    Plant(#[from] PlantError),
    /// The core takes no such vehicle.
    #[error("the core refuses the vehicle: {0}")]
    Airframe(#[from] AirframeError),
    /// The filter's figures or start.
    #[error("the filter does not start: {0}")]
    Filter(#[from] EstimatorError),
    /// No thrust gives the acceleration at the start.
    #[error("the course cannot be flown from its start: {0}")]
    Start(#[from] ReferenceError),
}
