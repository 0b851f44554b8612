//! `quatrack campaign replay`: a campaign's folder, a run and a law in; that flight's figures, log, picture and scenario out.

use std::path::PathBuf;

use quatrack_campaign::Folder;
use quatrack_simulation::scenario::{Law, Scenario};

use super::{refused, trajectories};
use crate::cli::fly::scenario::{Outputs, fly_and_print};
use crate::cli::picture::Picture;
use crate::cli::transform::TransformArgs;
use crate::cli::{Failure, output};

/// Flies one flight of a campaign again, the same to the bit, and shows it. Exit code 3 where the craft is lost, as it was.
#[derive(clap::Args)]
pub(super) struct Args {
    /// The campaign's folder.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// The run's number.
    #[arg(long, value_name = "K")]
    run: u64,
    /// The law; the campaign's first where absent.
    #[arg(long, value_name = "NAME")]
    law: Option<Law>,
    /// Folder for the log of the flight as CSV, created where it is missing.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the figures as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<output::File>,
    /// Write a picture of the flight, .svg or .png.
    #[arg(long, value_name = "FILE")]
    plot: Option<Picture>,
    /// Write the flight for Foxglove and PlotJuggler, .mcap. Needs a command built with --features mcap.
    #[arg(long, value_name = "FILE")]
    mcap: Option<output::File>,
    /// Write the run's scenario, with every figure as it was drawn, for `fly --scenario` and others. It names files beside it
    /// as the campaign's folder has them.
    #[arg(long, value_name = "FILE")]
    scenario_out: Option<output::File>,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let folder = Folder::open(&args.folder).map_err(refused)?;
    let campaign = folder.campaign(&trajectories).map_err(refused)?;
    let runs = folder.card().runs;
    if args.run >= runs {
        return Err(Failure::input(format!("--run {}: the campaign has runs 0 to {}", args.run, runs - 1)));
    }
    let law = args.law.or(campaign.laws().first().copied()).unwrap_or_default();
    if let Some(path) = &args.scenario_out {
        let own = args.folder.join("scenario.toml");
        if path.canonicalize().is_ok_and(|path| own.canonicalize().is_ok_and(|own| own == path)) {
            let reason = "is the scenario of the whole campaign; name another file beside it";
            return Err(Failure::input(format!("--scenario-out {}: {reason}", path.display())));
        }
        let (mut table, ..) = campaign.table(args.run);
        table.insert("law".to_owned(), law.name().into());
        output::write(path, table.to_string().as_bytes())?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    let scenario = Scenario { law, ..campaign.run(args.run).scenario.map_err(Failure::input)? };
    args.out.as_deref().map_or(Ok(()), output::create_dir)?;
    let (figures, recording) = fly_and_print(&scenario, &TransformArgs::default())?;
    let outputs = Outputs {
        dir: args.out.as_deref(),
        json: args.json.as_deref(),
        plot: args.plot.as_deref(),
        log: None,
        mcap: args.mcap.as_deref(),
    };
    outputs.write(&scenario, figures, &recording)
}
