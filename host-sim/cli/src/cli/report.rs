//! `quatrack report`: a campaign's folder in; one HTML page that needs nothing else out.

use std::path::{Path, PathBuf};

use super::campaign::view;
use quatrack_campaign::report::{Paper, page};
use quatrack_campaign::{CampaignError, Folder};

use super::{Failure, output, reproduce};

/// Puts a campaign on one page that opens from disk without a network: the laws' table, distributions, the figures that
/// matter, the worst flights with the commands that fly them again, a replay in space of any two flights at once, and the
/// paper's table and figures, made anew.
///
/// Example:
///   quatrack report my-campaign
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Args {
    /// The campaign's folder.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// The page; report.html in the folder where absent.
    #[arg(long, value_name = "FILE")]
    out: Option<output::File>,
    /// A flight succeeds with at most this position error, m; by default whenever it is not lost.
    #[arg(long, value_name = "X")]
    within_m: Option<f64>,
    /// How many of the worst flights of each law to replay.
    #[arg(long, value_name = "N", default_value_t = 3)]
    worst: usize,
    /// Leave the paper out, whose flights take some seconds.
    #[arg(long)]
    without_paper: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let refused = |error: CampaignError| Failure::input(error);
    let view = view(args.within_m, args.worst)?;
    let folder = Folder::open(&args.folder).map_err(refused)?;
    let trajectories = |name: &str| super::fly::trajectory(name).map_err(|failure| failure.line);
    let campaign = folder.campaign(&trajectories).map_err(refused)?;
    let paper = if args.without_paper { None } else { Some(reproduced()?) };
    let html = page(&folder, &campaign, &view, paper.as_ref()).map_err(refused)?;
    let path = args.out.as_deref().map_or_else(|| args.folder.join("report.html"), Path::to_path_buf);
    output::write(&path, html.as_bytes())?;
    output::print(&format!("wrote {}: {} kB, open it in a browser\n", path.display(), html.len() / 1000))
}

fn reproduced() -> Result<Paper, Failure> {
    let reproduction = reproduce::fly()?;
    let figures = reproduce::figures(&reproduction)?;
    let figures = figures.into_iter().map(|(number, title, svg)| (format!("Fig. {number}: {title}"), svg)).collect();
    Ok(Paper { table: reproduction.to_string(), figures })
}
