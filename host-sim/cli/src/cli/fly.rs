//! `quatrack fly`: a scenario; or a controller or a gain table, a trajectory and a rate in; the figures of one flight, and its
//! log, out.

mod course;
mod paper;
mod picture;
mod report;
pub(super) mod scenario;
pub(super) mod table;

use std::path::PathBuf;

use clap::ValueEnum;
use quatrack::{ErrorForm, FeedForward, Law as CoreLaw, Limits, Rate};
use quatrack_plan::trajectory::on_board;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use quatrack_simulation::flight::closed_loop::{Flight, LOST_M, fly_sampled};
use quatrack_simulation::flight::core_loop::CoreLoop;
use quatrack_simulation::flight::reference::Exact;

use super::limits::LimitsChoice;
use super::picture::Picture;
use super::scenario::ScenarioArgs;
use super::transform::TransformArgs;
use super::{Failure, output};
use course::load;
pub(super) use course::{not_on_board, trajectory, transformed};
use paper::{Controller, fly_paper};
use report::{DescribedFlight, report};

/// Flies a scenario with its law, or one trajectory with one controller or gain table.
///
/// With --scenario or --vehicle the law of a scenario flies on a rigid craft with motors, in
/// air where it has some. Every key of the file has a flag, which goes before the file.
///
/// With --controller the paper's model flies, in vacuum, its state known exactly; so it does
/// with --gains, but for tables of the cascade, which are the law of a scenario.
///
/// Exit code 0: flown to the end. 2: an input that cannot be used. 3: the craft was lost; the samples
/// until then are printed and written. It is lost 5 m from its course or reference, or without a finite command.
///
/// Examples:
///   quatrack fly --scenario my.toml --wind-m-s 1,0,0 --out out/windy --plot out/windy.png
///   quatrack fly --vehicle crazyflie-2.1-brushless --air vehicle --law lee --speed-m-s 1.5
///   quatrack fly --controller lqr-e --trajectory mild
///   quatrack fly --controller lqr-e --trajectory my.csv --rate-hz 500 --feed-forward --limits crazyflie-2.1
///   quatrack fly --controller lyap-e --mu 1 --trajectory aggressive --precision f64 --out out/crash
///   quatrack fly --gains gains/generated/sampled-lqr-e.bin --trajectory aggressive --feed-forward
///   quatrack fly --controller lqr-e --trajectory my.csv --time-scale 1.5 --reverse --start 0,0,1
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Args {
    /// Which law and design of the paper.
    #[arg(long, value_enum, ignore_case = true, conflicts_with_all = ["gains", "scenario"])]
    controller: Option<Controller>,
    /// A gain table (.bin), or a design (.toml) whose table is made first. It is flown by the f32 core, at its own rate
    /// and within its own limits; a table of the cascade is the law of a scenario, on the vehicle
    /// that its design names, or --vehicle.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["mu", "law"])]
    gains: Option<PathBuf>,
    /// mild, aggressive, or a file: polynomial pieces (uav_trajectories CSV), control points (JSON or TOML), a plan (TOML,
    /// planned first), or the Crazyflie's compressed form.
    #[arg(long, value_name = "mild|aggressive|FILE", default_value = "", hide_default_value = true)]
    trajectory: String,
    /// Control steps a second, 1 to 10000, commands held in between. Without it a table flies at its own, f32 at 500 Hz
    /// and f64 in continuous time.
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    rate_hz: Option<f64>,
    /// f32 flies the core that runs on the board, f64 the law as the paper writes it.
    #[arg(long, value_enum, default_value_t = Precision::F32)]
    precision: Precision,
    /// Add the reference's own input to the feedback.
    #[arg(long)]
    feed_forward: bool,
    /// How the equilibrium laws form their error: in the heading frame, good for every heading, or as the paper does,
    /// good near heading 0.
    #[arg(long, value_enum, default_value_t = Form::Heading)]
    error_form: Form,
    /// Decay rate of the Lyapunov designs, 1/s.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    mu: Option<f64>,
    /// Cut commands to a vehicle: crazyflie-2.1, crazyflie-2.1-upgrade-kit, crazyflie-2.1-brushless, none, or
    /// THRUST_MIN,THRUST_MAX,RATE_MAX in m/s^2 and rad/s. [default: those of the table, else none]
    #[arg(long, value_name = "V", allow_hyphen_values = true)]
    limits: Option<LimitsChoice>,
    /// Folder for the log of the flight as CSV, created where it is missing.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the figures as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<output::File>,
    /// Of a scenario: write a picture of the flight, its errors, tilt, motor forces and wind, .svg or .png.
    #[arg(long, value_name = "FILE")]
    plot: Option<Picture>,
    /// Of a scenario: write a log as a craft records it, which `quatrack identify` reads (CSV, the columns of cflib).
    #[arg(long, value_name = "FILE")]
    log: Option<output::File>,
    /// Of a scenario: write the flight for Foxglove and PlotJuggler, .mcap. Needs a command built with --features mcap.
    #[arg(long, value_name = "FILE")]
    mcap: Option<output::File>,
    #[command(flatten)]
    transform: TransformArgs,
    #[command(flatten)]
    scenario: ScenarioArgs,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Precision {
    F32,
    F64,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Form {
    Heading,
    Paper,
}

/// Said where no law is asked for.
const NOTHING: &str = "nothing to fly: give --scenario or --vehicle; or --controller or --gains, with --trajectory";

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let on_trajectory = args.controller.is_some() || !args.trajectory.is_empty();
    let of_table = args.gains.is_some() && !args.scenario.any_but_vehicle();
    if args.gains.is_none() && args.controller.is_none() || args.gains.is_some() && !(on_trajectory && of_table) {
        return scenario::run(args);
    }
    args.refuse_scenario()?;
    let rate = args.rate_hz.map(checked_rate).transpose()?;
    let flown = match (&args.gains, args.controller) {
        (Some(path), _) => table::fly(args, path, rate)?,
        (None, Some(controller)) => fly_paper(args, controller, rate)?,
        (None, None) => return Err(Failure::input(NOTHING)),
    };
    report(args, &flown)
}

fn checked_rate(hz: f64) -> Result<Rate, Failure> {
    let whole = (hz.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&hz)).then_some(hz as u32);
    whole.and_then(Rate::from_hz).ok_or_else(|| {
        Failure::input(format!(
            "--rate-hz {hz}: must be a whole number from {} to {} control steps a second",
            Rate::MIN_HZ,
            Rate::MAX_HZ
        ))
    })
}

fn default_rate() -> Result<Rate, Failure> {
    checked_rate(500.0)
}

impl Args {
    fn feed_forward(&self) -> FeedForward {
        if self.feed_forward { FeedForward::With } else { FeedForward::Without }
    }

    fn error_form(&self) -> ErrorForm {
        match self.error_form {
            Form::Heading => ErrorForm::HeadingFrame,
            Form::Paper => ErrorForm::Paper,
        }
    }
}

/// Flies a law of the core.
fn fly_law(
    args: &Args,
    law: CoreLaw<'_>,
    trajectory: &PiecewisePolynomial,
    rate: Rate,
    limits: Limits,
) -> Result<Flight, Failure> {
    let pieces = on_board::checked(trajectory).map_err(|error| not_on_board(&args.trajectory, &error))?;
    let mut core = CoreLoop::new(&pieces, rate, law, limits)
        .map_err(|error| Failure::input(format!("{}: {error}", args.trajectory)))?;
    Ok(fly_sampled(&Exact(trajectory), rate.hz(), LOST_M, |tick, _, x| core.step(tick, x)))
}
