//! `campaign.json`: the definition of a campaign without its scenario.

use std::path::Path;

use quatrack_plan::bounded;
use serde::{Deserialize, Serialize};

use crate::error::CampaignError;

/// The schema that the file states.
pub const SCHEMA: &str = "quatrack/campaign/1";

/// The definition of a campaign without its scenario.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Card {
    /// [`SCHEMA`].
    pub schema: String,
    /// The campaign's seed.
    pub seed: u64,
    /// How many runs; each law flies them all.
    pub runs: u64,
    /// The laws, in the order of their rows.
    pub laws: Vec<String>,
    /// Names of the drawn figures, in the order of their columns.
    pub drawn: Vec<String>,
    /// SHA-256 of all that rows depend on.
    pub digest: String,
}

/// Reads one.
pub(super) fn read(path: &Path) -> Result<Card, CampaignError> {
    let text = bounded::read_to_string(path).map_err(|error| CampaignError::file(path, "cannot be read", &error))?;
    let card: Card = serde_json::from_str(&text)
        .map_err(|error| CampaignError::folder(path, format!("is no campaign ({error})")))?;
    if card.schema != SCHEMA || card.laws.is_empty() {
        return Err(CampaignError::folder(
            path,
            format!("is {}, not {SCHEMA}; read it with the version that wrote it", card.schema),
        ));
    }
    Ok(card)
}
