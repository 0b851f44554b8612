//! `quatrack fly`: a scenario; or a controller or a gain table, a trajectory and a rate in; the figures of one flight, and its
//! log, out.

mod picture;
pub(super) mod scenario;
pub(super) mod table;

use std::fmt;
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use quatrack::{Equilibrium, ErrorForm, FeedForward, FlatOutput, Law as CoreLaw, Limits, Rate};
use quatrack_design::design::DesignError;
use quatrack_design::design::codegen::rounded;
use quatrack_design::design::synthesis::{self, EquilibriumWeights, FlatWeights, PAPER_MU};
use quatrack_plan::plan;
use quatrack_plan::trajectory::Trajectory;
use quatrack_plan::trajectory::bspline::BSpline;
use quatrack_plan::trajectory::file::{self, TrajectoryFile};
use quatrack_plan::trajectory::on_board::{self, OnBoardError};
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use quatrack_simulation::flight::closed_loop::{Flight, HeldCommand, Solver, fly_continuous, fly_sampled};
use quatrack_simulation::flight::core_loop::{self, CoreLoop};
use quatrack_simulation::flight::law::{EquilibriumGain, Feedback, FlatOutputGain, Law};
use quatrack_simulation::flight::log;
use quatrack_simulation::flight::metrics::Metrics;
use quatrack_simulation::flight::reference::{Exact, Reference};
use quatrack_simulation::flight::reference_check::ReferenceCheck;
use quatrack_simulation::integrator::Method;
use serde::Serialize;

use super::limits::LimitsChoice;
use super::scenario::ScenarioArgs;
use super::transform::TransformArgs;
use super::{Failure, output};

/// Flies a scenario with its law, or one trajectory with one controller or gain table.
///
/// With --scenario or --vehicle the law of a scenario flies on a rigid craft with motors, in
/// air where it has some. Every key of the file has a flag, which goes before the file.
///
/// With --controller the paper's model flies, in vacuum, its state known exactly; so it does
/// with --gains, but for tables of the cascade, which are the law of a scenario.
///
/// Exit code 0: flown to the end. 2: an input that cannot be used. 3: the craft was lost; the samples
/// until then are printed and written.
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
    json: Option<PathBuf>,
    /// Of a scenario: write a picture of the flight, its errors, tilt, motor forces and wind, .svg or .png.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Of a scenario: write a log as a craft records it, which `quatrack identify` reads (CSV, the columns of cflib).
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// Of a scenario: write the flight for Foxglove and PlotJuggler, .mcap. Needs a command built with --features mcap.
    #[arg(long, value_name = "FILE")]
    mcap: Option<PathBuf>,
    #[command(flatten)]
    transform: TransformArgs,
    #[command(flatten)]
    scenario: ScenarioArgs,
}

/// The controllers of the paper.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Controller {
    /// Lyapunov design on the flat chain.
    LyapF,
    /// Lyapunov design at the hover equilibrium.
    LyapE,
    /// LQR on the flat chain.
    LqrF,
    /// LQR at the hover equilibrium.
    LqrE,
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

impl fmt::Display for Controller {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::LyapF => "LYAP-F",
            Self::LyapE => "LYAP-E",
            Self::LqrF => "LQR-F",
            Self::LqrE => "LQR-E",
        })
    }
}

/// The flight as it is written to a file: figures, and when and why it was lost.
#[derive(Serialize)]
struct FlightReport {
    /// None where it was lost before anything was measured.
    #[serde(flatten)]
    metrics: Option<Metrics>,
    lost: Option<String>,
    /// The parts of the reference that no law can follow.
    reference: Option<String>,
}

/// A gain of either law, in f64.
enum Gain {
    Equilibrium(Box<EquilibriumGain>),
    FlatOutput(Box<FlatOutputGain>),
}

/// A flight, with the words that describe how it was flown.
struct DescribedFlight {
    /// The law and its gains.
    law: String,
    /// The arithmetic and the rate.
    clock: String,
    /// The limits, in words.
    limits: String,
    duration_s: f64,
    flight: Flight,
    /// The parts of the reference that no law can follow.
    reference: Option<String>,
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

fn fly_paper(args: &Args, controller: Controller, rate: Option<Rate>) -> Result<DescribedFlight, Failure> {
    let gain = design(args, controller)?;
    let trajectory = load(args)?;
    let limits = args.limits.clone().unwrap_or_else(LimitsChoice::none);
    let reference = ReferenceCheck::of(&trajectory, &limits.limits).line();
    let (flight, clock) = match (args.precision, rate) {
        (Precision::F32, rate) => {
            let rate = rate.map_or_else(default_rate, Ok)?;
            (fly_core(args, &gain, &trajectory, rate, limits.limits)?, format!("f32 core, {} Hz hold", rate.hz()))
        }
        (Precision::F64, Some(rate)) => {
            (fly_f64_sampled(args, &gain, &trajectory, rate, limits.limits), format!("f64, {} Hz hold", rate.hz()))
        }
        (Precision::F64, None) => {
            (fly_f64_continuous(args, &gain, &trajectory, &limits)?, "f64, continuous".to_owned())
        }
    };
    Ok(DescribedFlight {
        law: controller.to_string(),
        clock,
        limits: limits.name,
        duration_s: trajectory.duration_s(),
        flight,
        reference,
    })
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

fn design(args: &Args, controller: Controller) -> Result<Gain, Failure> {
    let mu = args.mu.unwrap_or(PAPER_MU);
    if matches!(controller, Controller::LqrE | Controller::LqrF) && args.mu.is_some() {
        return Err(Failure::input("--mu belongs to the Lyapunov designs; leave it out or choose lyap-e or lyap-f"));
    }
    let gain = match controller {
        Controller::LyapF => synthesis::lyapunov_flat(mu).map(|design| Gain::FlatOutput(design.gain.into())),
        Controller::LyapE => synthesis::lyapunov_equilibrium(mu).map(|design| Gain::Equilibrium(design.gain.into())),
        Controller::LqrF => {
            synthesis::lqr_flat(&FlatWeights::paper()).map(|design| Gain::FlatOutput(design.gain.into()))
        }
        Controller::LqrE => {
            synthesis::lqr_equilibrium(&EquilibriumWeights::paper()).map(|design| Gain::Equilibrium(design.gain.into()))
        }
    };
    gain.map_err(|error| match error {
        DesignError::Inaccurate { equation, .. } => {
            let remedy = "take a decay rate from 0.001 to 1000 1/s";
            Failure::input(format!("--mu {mu}: {equation} was not solved to working precision; {remedy}"))
        }
        error => Failure::input(format!("--mu {mu}: {error}")),
    })
}

/// The trajectory by name or from a file, as the pieces that the board flies; and the folder for the log.
fn load(args: &Args) -> Result<PiecewisePolynomial, Failure> {
    let trajectory = transformed(&args.trajectory, &args.transform)?;
    args.out.as_deref().map_or(Ok(()), output::create_dir)?;
    Ok(trajectory)
}

/// The same flown slower, backwards, elsewhere, turned or larger.
pub(super) fn transformed(name: &str, args: &TransformArgs) -> Result<PiecewisePolynomial, Failure> {
    let transform = args.transform()?;
    transform.apply(&trajectory(name)?).map_err(|error| Failure::input(format!("{name}: {error}")))
}

/// A trajectory by name or from a file, as the pieces that the board flies.
pub(super) fn trajectory(name: &str) -> Result<PiecewisePolynomial, Failure> {
    let from_spline = |spline: &BSpline| {
        PiecewisePolynomial::from_bspline(spline).map_err(|error| Failure::input(format!("{name}: {error}")))
    };
    let planned = |text: &str| {
        let flight = super::plan::of_text(Path::new(name), text)?;
        flight.pieces().map_err(|error| Failure::input(format!("{name}: {error}")))
    };
    match name {
        "mild" => planned(plan::paper::MILD_TOML),
        "aggressive" => planned(plan::paper::AGGRESSIVE_TOML),
        path => match file::read(Path::new(path)).map_err(Failure::input)? {
            TrajectoryFile::Pieces(pieces) => Ok(pieces),
            TrajectoryFile::Spline(spline) => from_spline(&spline),
            TrajectoryFile::Plan(text) => planned(&text),
        },
    }
}

fn feedback<'a>(args: &Args, gain: &'a Gain) -> Feedback<'a> {
    let law = match (gain, args.error_form) {
        (Gain::Equilibrium(gain), Form::Paper) => Law::EquilibriumPaper(gain),
        (Gain::Equilibrium(gain), Form::Heading) => Law::EquilibriumHeading(gain),
        (Gain::FlatOutput(gain), _) => Law::FlatOutput(gain),
    };
    Feedback { law, feed_forward: args.feed_forward }
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

fn fly_core(
    args: &Args,
    gain: &Gain,
    trajectory: &PiecewisePolynomial,
    rate: Rate,
    limits: Limits,
) -> Result<Flight, Failure> {
    let (feed_forward, error_form) = (args.feed_forward(), args.error_form());
    let (equilibrium_gain, flat_gain);
    let law: CoreLaw<'_> = match gain {
        Gain::Equilibrium(gain) => {
            equilibrium_gain = quatrack::law::EquilibriumGain::new(rounded(gain)).map_err(Failure::input)?;
            Equilibrium { gain: &equilibrium_gain, error_form, feed_forward }.into()
        }
        Gain::FlatOutput(gain) => {
            flat_gain = quatrack::law::FlatOutputGain::new(rounded(gain)).map_err(Failure::input)?;
            FlatOutput { gain: &flat_gain, feed_forward }.into()
        }
    };
    fly_law(args, law, trajectory, rate, limits)
}

/// Names the fault for which a board does not fly it; a start elsewhere is one way on.
pub(super) fn not_on_board(name: &str, error: &OnBoardError) -> Failure {
    let how = if matches!(error, OnBoardError::Coarse { .. }) { " by --start 0,0,0" } else { "" };
    Failure::input(format!("{name}: {error}{how}"))
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
    Ok(fly_sampled(&Exact(trajectory), rate.hz(), |tick, _, x| core.step(tick, x)))
}

fn fly_f64_sampled(args: &Args, gain: &Gain, trajectory: &PiecewisePolynomial, rate: Rate, limits: Limits) -> Flight {
    let (reference, feedback) = (Exact(trajectory), feedback(args, gain));
    fly_sampled(&reference, rate.hz(), |_, t_s, x| {
        let input = feedback.input(x, &reference.at(t_s));
        let (input, limited) =
            core_loop::saturate(&input, &limits).ok_or_else(|| "the law has no finite command".to_owned())?;
        Ok(HeldCommand { input, limited })
    })
}

/// In continuous time nothing counts steps, so limits would go unreported: they are refused.
fn fly_f64_continuous(
    args: &Args,
    gain: &Gain,
    trajectory: &PiecewisePolynomial,
    limits: &LimitsChoice,
) -> Result<Flight, Failure> {
    if limits.name != "none" {
        return Err(Failure::input(format!(
            "--limits {}: continuous time has no steps to limit; add --rate-hz",
            limits.name
        )));
    }
    let feedback = feedback(args, gain);
    let solver = Solver::Fixed { method: Method::RungeKutta4, substeps: 2 };
    Ok(fly_continuous(&Exact(trajectory), |x, target| feedback.input(x, target), solver))
}

fn report(args: &Args, flown: &DescribedFlight) -> Result<(), Failure> {
    let DescribedFlight { law, clock, limits, duration_s, flight, reference } = flown;
    // One sample is the start, before anything was flown.
    let metrics = (flight.samples.len() > 1 || flight.lost.is_none()).then(|| Metrics::of(flight));
    let feed = if args.feed_forward { ", feed-forward" } else { "" };
    let trajectory = &args.trajectory;
    output::print(&format!("{law} on {trajectory}, {duration_s:.2} s, {clock}{feed}, limits {limits}\n"))?;
    if let Some(metrics) = &metrics {
        output::print(&figures(metrics))?;
    }
    if let Some(reference) = reference {
        output::print(&format!("  note: {reference}\n"))?;
    }
    if let Some(dir) = &args.out {
        let path = dir.join("flight.csv");
        output::write(&path, log::to_csv(flight).as_bytes())?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    let lost = flight.lost.as_ref().map(|lost| format!("{:.2} s: {}", lost.time_s, lost.reason));
    if let Some(path) = &args.json {
        let report = FlightReport { metrics, lost: lost.clone(), reference: reference.clone() };
        output::write_json(path, &output::Named::new("fly-trajectory", &report))?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    lost.map_or(Ok(()), |lost| Err(Failure::lost(format!("{law} was lost at {lost}"))))
}

fn figures(metrics: &Metrics) -> String {
    let iae = |v: Option<f64>| v.map_or_else(|| "none: the flight was lost".to_owned(), |v| format!("{v:.6} m s"));
    format!(
        "\x20 IAE, sum (23) times T_s   {}\n\
         \x20 IAE, integral (22)        {}\n\
         \x20 largest position error    {:.6} m\n\
         \x20 RMS position error        {:.6} m\n\
         \x20 lowest z                  {:.4} m at {:.2} s\n\
         \x20 largest tilt              {:.2} deg\n\
         \x20 peak thrust               {:.3} m/s^2\n\
         \x20 peak body rate            {:.3} rad/s\n\
         \x20 saturated steps           {}\n",
        iae(metrics.iae_m_s),
        iae(metrics.iae_integral_m_s),
        metrics.max_error_m,
        metrics.rms_error_m,
        metrics.min_z_m,
        metrics.min_z_time_s,
        metrics.max_tilt_deg,
        metrics.max_thrust_m_s2,
        metrics.max_body_rate_rad_s,
        metrics.saturated_steps,
    )
}
