//! Why there is no campaign, in one line that names the fault, its place and the remedy.

use std::path::PathBuf;

use quatrack_simulation::scenario::{LawError, ScenarioError};

/// Why there is no campaign.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CampaignError {
    /// The scenario has no sense, also without its distributions.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// A distribution without sense.
    #[error("{origin}: vary.{key}: {reason}")]
    Vary {
        /// The figure's key.
        origin: String,
        /// The figure.
        key: String,
        /// Why not, with the remedy.
        reason: String,
    },
    /// A law does not fly the vehicle.
    #[error("{0}; leave it out of --laws or of laws = [...]")]
    Law(#[from] LawError),
    /// A trajectory that cannot be had.
    #[error("{name}: {reason}")]
    Trajectory {
        /// Its name.
        name: String,
        /// Why not.
        reason: String,
    },
    /// A number of runs or a shard without sense.
    #[error("{0}")]
    Asked(String),
    /// The system refuses a file.
    #[error("{}: {failure} ({reason})", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The failed access, in words.
        failure: &'static str,
        /// The system's message.
        reason: String,
    },
    /// A folder that holds something else.
    #[error("{}: {reason}", path.display())]
    Folder {
        /// The file.
        path: PathBuf,
        /// The fault, with the remedy.
        reason: String,
    },
}

impl CampaignError {
    /// The error of a system's refusal.
    pub(crate) fn file(path: &std::path::Path, failure: &'static str, reason: &dyn std::fmt::Display) -> Self {
        Self::File { path: path.to_owned(), failure, reason: reason.to_string() }
    }

    /// The error of a folder's contents.
    pub(crate) fn folder(path: &std::path::Path, reason: impl Into<String>) -> Self {
        Self::Folder { path: path.to_owned(), reason: reason.into() }
    }
}
