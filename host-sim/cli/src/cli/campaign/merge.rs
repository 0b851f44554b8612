//! `quatrack campaign merge`: the shards of a campaign in; one folder, or which shard is missing, out.

use std::path::PathBuf;

use quatrack_campaign::Folder;
use quatrack_campaign::merge::{Found, beside, join, look};

use super::{refused, trajectories};
use crate::cli::{Failure, output};

/// Puts the shards of a campaign together, as if one machine had flown it. A shard that is missing or not flown to its end is
/// named, with exit code 1.
#[derive(clap::Args)]
pub(super) struct Args {
    /// Folders that hold shards.
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Where all rows go; the first folder where absent.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let folders: Vec<Folder> =
        args.folders.iter().map(|path| Folder::open(path)).collect::<Result<_, _>>().map_err(refused)?;
    let shards = match look(&folders).map_err(refused)? {
        Found::Whole(shards) => shards,
        Found::Missing(missing) => {
            let named: Vec<String> = missing
                .iter()
                .map(|missing| match missing.flown {
                    [0, all] => format!("{} is missing ({all} runs)", missing.shard),
                    [flown, all] => format!("{} ends after {flown} of {all} runs", missing.shard),
                })
                .collect();
            let remedy = "fly it by --shard and merge again";
            return Err(Failure::verdict(format!("shard {}; {remedy}", named.join(", shard "))));
        }
    };
    let Some(first) = folders.first() else { return Ok(()) };
    let campaign = first.campaign(&trajectories).map_err(refused)?;
    let out = args.out.as_deref().unwrap_or(first.path());
    let out = beside(first, out, &campaign).map_err(refused)?;
    let runs = join(&shards, &out).map_err(refused)?;
    let rows = out.path().join("rows.csv");
    let columns = out.path().join("rows.parquet");
    output::print(&format!("{runs} runs of {} shards: {} and {}\n", shards.len(), rows.display(), columns.display()))
}
