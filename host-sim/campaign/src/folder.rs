//! A campaign on disk: its definition, rows as CSV by shard, and all rows as Parquet.
//!
//! ```text
//! campaign.json     quatrack/campaign/1: seed, runs, laws, drawn figures, digest
//! scenario.toml     the scenario with its distributions; the files that it names lie beside it
//! rows.csv          a line for each flight in the order of runs; of shards rows-I-of-N.csv
//! rows.parquet      the same, once all runs are there
//! ```

mod columns;
mod rows_on_disk;

use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use quatrack_plan::bounded;
use serde::{Deserialize, Serialize};

use crate::definition::{Asked, Campaign, Trajectories};
use crate::error::CampaignError;
use crate::shard::Shard;
pub use rows_on_disk::Growing;

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

/// A campaign's folder.
#[derive(Clone, Debug)]
pub struct Folder {
    path: PathBuf,
    card: Card,
}

impl Folder {
    /// For a campaign: a new one, or the one that it was begun in. More runs than before are flown after those.
    ///
    /// # Errors
    /// [`CampaignError::Folder`] where something else is there.
    pub fn begin(path: &Path, campaign: &Campaign, runs: u64) -> Result<Self, CampaignError> {
        let card = Card {
            schema: SCHEMA.to_owned(),
            seed: campaign.seed(),
            runs,
            laws: campaign.laws().iter().map(|law| law.name().to_owned()).collect(),
            drawn: campaign.drawn_names(),
            digest: campaign.digest(),
        };
        fs::create_dir_all(path).map_err(|error| CampaignError::file(path, "cannot create this folder", &error))?;
        let folder = Self { path: path.to_owned(), card };
        let card_path = path.join("campaign.json");
        if card_path.exists() {
            let before = read_card(&card_path)?;
            if (Card { runs, ..before.clone() }) != folder.card {
                return Err(CampaignError::folder(
                    path,
                    format!(
                        "holds another campaign (seed {}, {}); choose another --out",
                        before.seed,
                        before.laws.join(", ")
                    ),
                ));
            }
            if before.runs > runs {
                return Err(CampaignError::folder(
                    path,
                    format!("has {} runs, more than --runs {runs}; choose another --out", before.runs),
                ));
            }
            if before.runs == runs {
                return Ok(folder);
            }
            if folder.shard_files()?.iter().any(|shard| *shard != Shard::WHOLE) {
                return Err(CampaignError::folder(
                    path,
                    format!("holds shards of {} runs; give --runs {0}, or choose another --out", before.runs),
                ));
            }
        }
        for (name, bytes) in campaign.files() {
            write(&path.join(name), bytes)?;
        }
        write(&path.join("scenario.toml"), campaign.text().as_bytes())?;
        let mut card = serde_json::to_string_pretty(&folder.card).unwrap_or_default();
        card.push('\n');
        write(&card_path, card.as_bytes())?;
        Ok(folder)
    }

    /// One that is there.
    ///
    /// # Errors
    /// [`CampaignError`] where there is none.
    pub fn open(path: &Path) -> Result<Self, CampaignError> {
        let card = path.join("campaign.json");
        if !card.exists() {
            return Err(CampaignError::folder(path, "no campaign is here (no campaign.json); give the --out of one"));
        }
        Ok(Self { path: path.to_owned(), card: read_card(&card)? })
    }

    /// The campaign that it flies.
    ///
    /// # Errors
    /// [`CampaignError`], also where the scenario was changed since.
    pub fn campaign(&self, trajectories: Trajectories<'_>) -> Result<Campaign, CampaignError> {
        let path = self.path.join("scenario.toml");
        let campaign = Campaign::read(&path, &Asked::default(), trajectories)?;
        if campaign.digest() != self.card.digest {
            let reason = "has changed since the first run; put back the old file, or fly another campaign";
            return Err(CampaignError::folder(&path, reason));
        }
        Ok(campaign)
    }

    /// Its definition without the scenario.
    pub fn card(&self) -> &Card {
        &self.card
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Shards whose rows are here.
    ///
    /// # Errors
    /// [`CampaignError::File`].
    pub fn shard_files(&self) -> Result<Vec<Shard>, CampaignError> {
        let refused = |error| CampaignError::file(&self.path, "cannot be read", &error);
        let mut found = Vec::new();
        for entry in fs::read_dir(&self.path).map_err(refused)? {
            let name = entry.map_err(refused)?.file_name();
            let name = name.to_string_lossy();
            found.extend(if name == "rows.csv" { Some(Shard::WHOLE) } else { Shard::of_file(&name) });
        }
        Ok(found)
    }

    /// Writes all rows as Parquet.
    ///
    /// # Errors
    /// [`CampaignError`].
    pub fn write_parquet(&self) -> Result<(), CampaignError> {
        columns::write(&self.path.join("rows.parquet"), &self.card.drawn, self.rows(Shard::WHOLE)?)
    }
}

fn read_card(path: &Path) -> Result<Card, CampaignError> {
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

/// Writes a file under a name of this process beside it and renames it: shards that begin at once do not meet.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), CampaignError> {
    let mut partial = path.as_os_str().to_owned();
    partial.push(format!(".{}.partial", std::process::id()));
    let partial = PathBuf::from(partial);
    let written = (|| {
        let mut file = File::create(&partial)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        fs::rename(&partial, path)
    })();
    written.map_err(|error: std::io::Error| {
        let _ = fs::remove_file(&partial);
        CampaignError::file(path, "cannot be written", &error)
    })
}
