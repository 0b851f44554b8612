//! A campaign on disk: its definition, rows as CSV by shard, and all rows as Parquet.
//!
//! ```text
//! campaign.json     quatrack/campaign/1: seed, runs, laws, drawn figures, digest
//! scenario.toml     the scenario with its distributions; the files that it names lie beside it
//! rows.csv          a line for each flight in the order of runs; of shards rows-I-of-N.csv
//! rows.parquet      the same, once all runs are there
//! ```

mod card;
mod columns;
mod partial;
mod rows_on_disk;

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use quatrack_plan::bounded;

use crate::definition::{Asked, Campaign, Trajectories};
use crate::error::CampaignError;
use crate::row::Row;
use crate::shard::Shard;
pub use card::{Card, SCHEMA};
use partial::{Partial, write};
pub use rows_on_disk::Growing;

/// Rows in memory at a time.
const BLOCK: usize = 4096;

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
            let before = card::read(&card_path)?;
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
            folder.is_still()?;
            // It has not all runs any more.
            let columns = path.join("rows.parquet");
            if columns.exists() {
                fs::remove_file(&columns)
                    .map_err(|error| CampaignError::file(&columns, "cannot be removed", &error))?;
            }
        } else if let Err(refused) = folder.refuse_others_files(campaign) {
            // Unless a shard that begins at the same time has come first.
            return if card_path.exists() { Self::begin(path, campaign, runs) } else { Err(refused) };
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

    /// Refuses a folder with files of the campaign's names that are not its own. Those of a shard that begins beside this one are.
    fn refuse_others_files(&self, campaign: &Campaign) -> Result<(), CampaignError> {
        let own = campaign.files().iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice()));
        for (name, bytes) in own.chain([("scenario.toml", campaign.text().as_bytes())]) {
            let there = self.path.join(name);
            if there.exists() && bounded::read(&there).ok().as_deref() != Some(bytes) {
                let reason = "is there and would be replaced by the campaign's own; choose another --out";
                return Err(CampaignError::folder(&there, reason));
            }
        }
        if let Some(shard) = self.shard_files()?.first() {
            let reason = "is there without a campaign.json; choose another --out";
            return Err(CampaignError::folder(&self.path.join(shard.file_name()), reason));
        }
        Ok(())
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
        Ok(Self { path: path.to_owned(), card: card::read(&card)? })
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

    /// The files of rows that a summary reads: the whole campaign's, or all shards', in their order.
    ///
    /// # Errors
    /// [`CampaignError`] where there are none, or shards of different numbers, whose runs would count twice.
    pub fn parts(&self) -> Result<Vec<Shard>, CampaignError> {
        let shards = self.shard_files()?;
        if shards.contains(&Shard::WHOLE) {
            return Ok(vec![Shard::WHOLE]);
        }
        let Some(first) = shards.first() else {
            return Err(CampaignError::folder(&self.path, "holds no rows; fly the campaign first"));
        };
        if let Some(other) = shards.iter().find(|other| other.count() != first.count()) {
            let reason = format!("holds shard {other} beside others of {}; move one kind away", first.count());
            return Err(CampaignError::folder(&self.path, reason));
        }
        Ok(shards)
    }

    /// Shards whose rows are here, in their order.
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
        found.sort_unstable();
        Ok(found)
    }

    /// Puts the rows of shards, in their order, in the place of those of the whole campaign: all of them, or none.
    ///
    /// # Errors
    /// [`CampaignError`], also where the shards have not all runs.
    pub fn replace_rows(&self, shards: &[(Shard, &Self)]) -> Result<(), CampaignError> {
        let path = self.path.join(Shard::WHOLE.file_name());
        self.is_still()?;
        let (partial, mut file) = Partial::beside(&path)?;
        let refused = |error: std::io::Error| CampaignError::file(&path, "cannot be written", &error);
        file.write_all(self.header().as_bytes()).map_err(refused)?;
        let mut count = 0;
        for (shard, folder) in shards {
            let mut rows = folder.rows(*shard)?.peekable();
            while rows.peek().is_some() {
                let block: Vec<Row> = rows.by_ref().take(BLOCK).collect::<Result<_, _>>()?;
                count += block.len() as u64;
                file.write_all(&Row::to_csv(&block)).map_err(refused)?;
            }
        }
        let all = self.card.runs * self.card.laws.len() as u64;
        if count != all {
            let reason = format!("the shards have {count} rows of {all}; fly them to their end and merge again");
            return Err(CampaignError::folder(&path, reason));
        }
        file.sync_all().map_err(refused)?;
        partial.rename(&path).map_err(refused)
    }

    /// Writes all rows as Parquet.
    ///
    /// # Errors
    /// [`CampaignError`].
    pub fn write_parquet(&self) -> Result<(), CampaignError> {
        columns::write(&self.path.join("rows.parquet"), &self.card.drawn, self.rows(Shard::WHOLE)?)
    }
}
