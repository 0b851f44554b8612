//! `quatrack campaign summary`: a campaign's folder in; the summary of each law out.

use std::path::PathBuf;

use quatrack_campaign::Folder;
use quatrack_campaign::picture::svg;
use quatrack_campaign::summary::Summary;

use super::{refused, view};
use crate::cli::picture::{self, Picture};
use crate::cli::{Failure, output};

/// Summarises a campaign, also while it flies: success of each law with Wilson's interval of 95 %, errors at 50, 95 and
/// 99 %, the worst flights with the command that flies each again, and which figure matters most.
#[derive(clap::Args)]
pub(super) struct Args {
    /// The campaign's folder.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// A flight succeeds with at most this position error, m; by default whenever it is not lost.
    #[arg(long, value_name = "X")]
    within_m: Option<f64>,
    /// How many of the worst flights to name for each law.
    #[arg(long, value_name = "N", default_value_t = 3)]
    worst: usize,
    /// Write a picture of the share of successes over each drawn figure, .svg or .png.
    #[arg(long, value_name = "FILE")]
    picture: Option<Picture>,
    /// Write all of it as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<output::File>,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let view = view(args.within_m, args.worst)?;
    let folder = Folder::open(&args.folder).map_err(refused)?;
    let summary = Summary::of(&folder, &view).map_err(refused)?;
    output::print(&summary.to_string())?;
    if let Some(path) = &args.picture {
        picture::write(path, &svg(&folder, &view).map_err(refused)?)?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    if let Some(path) = &args.json {
        output::write_json(path, &summary)?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    Ok(())
}
