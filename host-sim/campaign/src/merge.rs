//! Shards to one folder: folders in; the rows of all runs in their order out, or which shard is missing.

use std::path::Path;

use crate::error::CampaignError;
use crate::folder::Folder;
use crate::shard::Shard;

/// A shard that is not whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Missing {
    /// The shard.
    pub shard: Shard,
    /// Its runs that are there, of all.
    pub flown: [u64; 2],
}

/// Where every shard is, or which are missing.
#[derive(Debug)]
pub enum Found<'a> {
    /// All are whole: the folder of each, in their order.
    Whole(Vec<(Shard, &'a Folder)>),
    /// Some are not.
    Missing(Vec<Missing>),
}

/// Looks for every shard in the folders.
///
/// # Errors
/// [`CampaignError`] where the folders are not of one campaign, or its shards not of one number.
pub fn look(folders: &[Folder]) -> Result<Found<'_>, CampaignError> {
    let Some(first) = folders.first() else { return Err(CampaignError::Asked("no folder to merge".to_owned())) };
    let mut shards = Vec::new();
    for folder in folders {
        if folder.card() != first.card() {
            let reason = format!("is not of the same campaign as {}; leave it out", first.path().display());
            return Err(CampaignError::folder(folder.path(), reason));
        }
        shards.extend(folder.shard_files()?.into_iter().map(|shard| (shard, folder)));
    }
    // The result of an earlier merge is not one of the shards.
    if shards.iter().any(|(shard, _)| *shard != Shard::WHOLE) {
        shards.retain(|(shard, _)| *shard != Shard::WHOLE);
    }
    let Some(count) = shards.first().map(|(shard, _)| shard.count()) else {
        return Err(CampaignError::folder(first.path(), "holds no rows; fly the campaign first"));
    };
    if let Some((other, folder)) = shards.iter().find(|(shard, _)| shard.count() != count) {
        let reason = format!("holds shard {other} beside others of {count}; leave out one kind");
        return Err(CampaignError::folder(folder.path(), reason));
    }
    let (mut whole, mut missing) = (Vec::new(), Vec::new());
    let runs = first.card().runs;
    for shard in Shard::all(count) {
        let all = shard.runs(runs).count() as u64;
        let mut most = 0;
        let mut found = None;
        for (_, folder) in shards.iter().filter(|(there, _)| *there == shard) {
            let flown = folder.flown(shard)?;
            most = most.max(flown);
            if flown == all {
                found = Some(*folder);
            }
        }
        match found {
            Some(folder) => whole.push((shard, folder)),
            None => missing.push(Missing { shard, flown: [most, all] }),
        }
    }
    Ok(if missing.is_empty() { Found::Whole(whole) } else { Found::Missing(missing) })
}

/// Writes the rows of all shards into a folder of the same campaign, as if they had been flown there, and as Parquet.
///
/// # Errors
/// [`CampaignError`].
pub fn join(shards: &[(Shard, &Folder)], out: &Folder) -> Result<u64, CampaignError> {
    let is_there = matches!(shards, [(Shard::WHOLE, folder)] if is_same(folder.path(), out.path()));
    if !is_there {
        out.replace_rows(shards)?;
    }
    out.write_parquet()?;
    Ok(out.card().runs)
}

/// Whether two paths lead to one folder.
fn is_same(a: &Path, b: &Path) -> bool {
    let [a, b] = [a, b].map(|path| path.canonicalize().ok());
    a.is_some() && a == b
}

/// A folder for the campaign of another, to merge into.
///
/// # Errors
/// [`CampaignError`].
pub fn beside(first: &Folder, out: &Path, campaign: &crate::Campaign) -> Result<Folder, CampaignError> {
    Folder::begin(out, campaign, first.card().runs)
}
