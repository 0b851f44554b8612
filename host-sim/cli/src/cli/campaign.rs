//! `quatrack campaign`: a scenario with distributions in; rows of thousands of flights, their summary, and any of them flown
//! again, out.

mod merge;
mod replay;
mod summary;

use std::path::{Path, PathBuf};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use quatrack_campaign::definition::Asked;
use quatrack_campaign::row::Outcome;
use quatrack_campaign::summary::View;
use quatrack_campaign::{Campaign, CampaignError, Folder, Shard, fly};
use quatrack_plan::bounded;
use quatrack_plan::trajectory::on_board;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use quatrack_simulation::scenario::Law;
use quatrack_simulation::scenario::file::ScenarioFile;

use super::fly::scenario::reference_note;
use super::scenario::existing_course;
use super::{Failure, output};

/// Flies a scenario thousands of times, with figures drawn from its [vary] table, under each of its laws.
///
/// Run k is the same alone, in any shard and on any number of cores, to the byte. A campaign that was killed goes on where it
/// was when the command is given again.
///
/// Example:
///   quatrack campaign my.toml --runs 1000 --laws quatrack,mellinger,lee --out my-campaign
///   quatrack campaign summary my-campaign
#[derive(clap::Args)]
#[command(verbatim_doc_comment, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Args {
    #[command(subcommand)]
    command: Option<Command>,
    /// The scenario (TOML) with distributions in [vary].
    #[arg(required = true)]
    scenario: Option<PathBuf>,
    /// How many runs; each law flies them all.
    #[arg(long, value_name = "N", required = true)]
    runs: Option<u64>,
    /// Of all draws; the scenario's where absent.
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
    /// Which laws, by their names; by default the scenario's.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    laws: Vec<Law>,
    /// Fly the i-th of n equal parts of the runs.
    #[arg(long, value_name = "I/N", default_value = "1/1")]
    shard: Shard,
    /// Folder for the rows; made, or gone on with.
    #[arg(long, value_name = "DIR", default_value = "campaign")]
    out: PathBuf,
    /// Cores to fly on; all where absent.
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

#[derive(clap::Subcommand)]
enum Command {
    Merge(merge::Args),
    Replay(replay::Args),
    Summary(summary::Args),
}

/// Every error of a campaign is one of its inputs.
fn refused(error: CampaignError) -> Failure {
    Failure::input(error)
}

/// The bounds of a success that a command's flags name.
///
/// # Errors
/// A distance without sense.
pub(crate) fn view(within_m: Option<f64>, worst: usize) -> Result<View, Failure> {
    if within_m.is_some_and(|within| within.is_nan() || within <= 0.0) {
        return Err(Failure::input("--within-m: must be a positive number of metres"));
    }
    Ok(View { within_m, worst })
}

fn trajectories(name: &str) -> Result<PiecewisePolynomial, String> {
    let trajectory = super::fly::trajectory(name).map_err(|failure| failure.line)?;
    on_board::checked(&trajectory).map_err(|error| error.to_string())?;
    Ok(trajectory)
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    match (&args.command, &args.scenario, args.runs) {
        (Some(Command::Merge(args)), ..) => merge::run(args),
        (Some(Command::Replay(args)), ..) => replay::run(args),
        (Some(Command::Summary(args)), ..) => summary::run(args),
        (None, Some(scenario), Some(runs)) => fly_all(args, scenario, runs),
        (None, ..) => Err(Failure::input("nothing to fly: give SCENARIO.toml and --runs N")),
    }
}

/// Refuses a course that is a slip of the keyboard before anything is made of it.
fn existing_course_of(text: &str, path: &Path) -> Result<(), Failure> {
    let origin = path.display().to_string();
    let file = ScenarioFile::parse(text, &origin).map_err(Failure::input)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let written = file.course.as_deref().unwrap_or("eight");
    existing_course(&origin, written, &folder.join(written))
}

fn fly_all(args: &Args, scenario: &Path, runs: u64) -> Result<(), Failure> {
    if runs == 0 || args.threads == Some(0) {
        return Err(Failure::input("--runs and --threads: must be at least 1"));
    }
    let asked = Asked { seed: args.seed, laws: args.laws.clone() };
    // Read once: a pipe has its text once.
    let text = bounded::read_to_string(scenario)
        .map_err(|error| Failure::input(format!("{}: cannot be read ({error})", scenario.display())))?;
    existing_course_of(&text, scenario)?;
    let campaign = Campaign::of_text(&text, scenario, &asked, &trajectories).map_err(refused)?;
    if let (Some(trajectory), Ok(nominal)) = (campaign.trajectory(), campaign.nominal())
        && let Some(note) = reference_note(&nominal.vehicle, trajectory)?
    {
        output::print(&format!("note: {note}\n"))?;
    }
    let folder = Folder::begin(&args.out, &campaign, runs).map_err(refused)?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mine = args.shard.runs(runs);
    let count = mine.end - mine.start;
    let bar = ProgressBar::with_draw_target(Some(count), ProgressDrawTarget::stderr());
    let style = ProgressStyle::with_template("{wide_bar} {pos}/{len} runs, {per_sec}, {eta} left");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.enable_steady_tick(Duration::from_millis(500));
    let begun = std::cell::Cell::new(None);
    let flown = fly::fly(&campaign, &folder, args.shard, args.threads.unwrap_or(cores), &|flown| {
        if begun.get().is_none() {
            begun.set(Some(flown));
            // Runs that were there already say nothing of the rate.
            bar.set_position(flown);
            bar.reset_eta();
        }
        bar.set_position(flown);
    });
    bar.finish_and_clear();
    flown.map_err(refused)?;
    let rows = args.out.join(args.shard.file_name());
    let laws: Vec<&str> = campaign.laws().iter().map(|law| law.name()).collect();
    let before = begun.get().unwrap_or(0);
    let resumed = if before > 0 { format!(", {before} of them before") } else { String::new() };
    output::print(&format!("{count} runs{resumed} of {}: {}\n", laws.join(", "), rows.display()))?;
    note_refused(&folder, args.shard)?;
    if args.shard == Shard::WHOLE {
        folder.write_parquet().map_err(refused)?;
        output::print(&format!("wrote {}\n", args.out.join("rows.parquet").display()))?;
        let dir = args.out.display();
        output::print(&format!("quatrack campaign summary {dir} prints their summary\n"))?;
    }
    Ok(())
}

/// Says how many flights of a shard were refused, and why the first one was.
fn note_refused(folder: &Folder, shard: Shard) -> Result<(), Failure> {
    let (mut flights, mut refused, mut first) = (0_u64, 0_u64, None);
    for row in folder.rows(shard).map_err(self::refused)? {
        let row = row.map_err(self::refused)?;
        flights += 1;
        if row.outcome == Outcome::Refused {
            refused += 1;
            first.get_or_insert((row.run, row.reason));
        }
    }
    let Some((run, reason)) = first else { return Ok(()) };
    output::print(&format!(
        "note: {refused} of {flights} flights were refused, which no share counts; run {run}: {reason}\n"
    ))
}
