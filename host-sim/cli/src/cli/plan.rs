//! `quatrack plan`: a plan file in; a summary and, if asked for, the curve's control points out.

mod curves;
mod summary;

use std::path::{Path, PathBuf};
use std::time::Duration;

use indicatif::ProgressBar;
use quatrack_plan::plan::{Bounds, Budget, FlightPlan, Overrides, PlanError, PlannedFlight, stored};
use quatrack_plan::trajectory::file::{self, FileError, TrajectoryFile};
use quatrack_plan::trajectory::on_board;
use quatrack_plan::trajectory::polynomial::csv;

use super::transform::TransformArgs;
use super::vehicle::VehicleChoice;
use super::{Failure, output};
use curves::{Curve, Curves, as_toml, of_leg};
use summary::summary;

/// Plan a flight through waypoints within bounds.
///
/// A plan is TOML (docs/plan.md), or rows of waypoints as CSV: t,x,y,z or t,x,y,z,yaw, or x,y,z without times. Without
/// times, the least within the bounds are found. Bounds on the command line go before those of the file.
///
/// Exit code 1: no curve meets the plan, and the least remedies are printed. 2: a file that cannot be used.
///
/// Examples:
///   quatrack plan plans/mild.toml --json mild.json
///   quatrack plan waypoints.csv --speed-max-m-s 1.5 --acceleration-max-m-s2 3 --toml planned.toml
///   quatrack plan square.toml --vehicle crazyflie-2.1 --reverse --start 0,0,1 --csv square.csv
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Args {
    /// Plan (TOML; plans/mild.toml and plans/aggressive.toml show the keys), or waypoints (CSV).
    #[arg(value_name = "FILE")]
    plan: PathBuf,
    /// Write degree, duration and control points as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<output::File>,
    /// Write degree, duration and control points as TOML.
    #[arg(long, value_name = "FILE")]
    toml: Option<output::File>,
    /// Write the pieces in the uav_trajectories form.
    #[arg(long, value_name = "FILE")]
    csv: Option<output::File>,
    /// Write the pieces that a board stores, as a Rust constant with the name of the plan file.
    #[arg(long, value_name = "FILE")]
    rust: Option<output::File>,
    /// End the search after this time, s.
    #[arg(long, value_name = "X", default_value_t = TIME_LIMIT_S, allow_negative_numbers = true)]
    time_limit_s: f64,
    /// Length of the flight in time, s.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    duration_s: Option<f64>,
    /// Take thrust and rates from a vehicle: a built-in name, or a TOML file.
    #[arg(long, value_name = "VEHICLE")]
    vehicle: Option<VehicleChoice>,
    /// Highest speed, m/s.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    speed_max_m_s: Option<f64>,
    /// Largest acceleration, m/s^2.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    acceleration_max_m_s2: Option<f64>,
    /// Largest tilt, degrees.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    tilt_max_deg: Option<f64>,
    #[command(flatten)]
    transform: TransformArgs,
}

/// How long a plan is looked for unless it is said, s.
const TIME_LIMIT_S: f64 = 60.0;

/// Plans the flight of a file.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let path = args.plan.display();
    let text = file::read_text(&args.plan).map_err(Failure::input)?;
    let over = Overrides {
        bounds: args.bounds()?,
        vehicle: args.vehicle.as_ref().map(|choice| &choice.0),
        duration_s: args.duration_s,
        transform: args.transform.transform()?,
        vehicles: None,
    };
    let (plan, flight) = planned(&args.plan, &text, over, args.time_limit_s)?;
    let curves: Vec<Curve> = flight.legs.iter().map(of_leg).collect();
    if let Some(json) = &args.json {
        match <[Curve; 1]>::try_from(curves) {
            Ok([curve]) => output::write_json(json, &output::Named::new("plan", &curve))?,
            Err(curves) => output::write_json(json, &output::Named::new("plan", &Curves { curves }))?,
        }
    }
    if let Some(toml) = &args.toml {
        output::write(toml, as_toml(&flight).as_bytes())?;
    }
    if args.csv.is_some() || args.rust.is_some() {
        let pieces = flight.pieces().map_err(Failure::verdict)?;
        if let Some(path) = &args.csv {
            output::write(path, csv::write(&pieces).as_bytes())?;
        }
        if let Some(rust) = &args.rust {
            let name = args.plan.file_stem().unwrap_or_default().to_string_lossy().to_uppercase();
            let name = name.replace(|c: char| !c.is_ascii_alphanumeric(), "_");
            output::write(rust, stored::rust_source(&name, &on_board::pieces(&pieces)).as_bytes())?;
        }
    }
    let mut text = format!("{path}\n{}", summary(&plan, &flight));
    for written in [&args.json, &args.toml, &args.csv, &args.rust].into_iter().flatten() {
        text += &format!("wrote {}\n", written.display());
    }
    output::print(&text)
}

impl Args {
    fn bounds(&self) -> Result<Bounds, Failure> {
        let positive = |flag: &str, value: Option<f64>, most: f64| match value {
            Some(value) if !(value > 0.0 && value <= most) => {
                Err(Failure::input(format!("{flag} {value}: must be above 0, up to {most}")))
            }
            value => Ok(value),
        };
        positive("--duration-s", self.duration_s, 1e5)?;
        positive("--time-limit-s", Some(self.time_limit_s), 1e6)?;
        Ok(Bounds {
            speed_max_m_s: positive("--speed-max-m-s", self.speed_max_m_s, 1e6)?,
            acceleration_max_m_s2: positive("--acceleration-max-m-s2", self.acceleration_max_m_s2, 1e6)?,
            tilt_max_rad: positive("--tilt-max-deg", self.tilt_max_deg, 89.99)?.map(f64::to_radians),
            ..Bounds::default()
        })
    }
}

/// Plans the text of a file, with a word on how it goes where somebody watches.
pub(super) fn planned(
    path: &Path,
    text: &str,
    over: Overrides<'_>,
    limit_s: f64,
) -> Result<(FlightPlan, PlannedFlight), Failure> {
    let folder = path.parent().unwrap_or(Path::new(""));
    // A vehicle's file is beside the plan that names it.
    let find = |name: &str| {
        let is_file = Path::new(name).extension().is_some_and(|end| end == "toml");
        let choice = if is_file { folder.join(name).to_string_lossy().parse() } else { name.parse() };
        choice.map(|VehicleChoice(vehicle)| vehicle)
    };
    let bar = ProgressBar::new_spinner();
    let progress = |stage: &str| {
        bar.enable_steady_tick(Duration::from_millis(200));
        bar.set_message(stage.to_owned());
    };
    let budget = Budget::of_seconds(limit_s, &progress);
    let over = Overrides { vehicles: Some(&find), ..over };
    let planned = FlightPlan::from_toml(text, &over, &budget).and_then(|plan| {
        let flight = plan.solve(&budget)?;
        Ok((plan, flight))
    });
    bar.finish_and_clear();
    planned.map_err(|error| match error {
        PlanError::Syntax { .. } => no_plan(path, text).unwrap_or_else(|| failed(path, &error)),
        error => failed(path, &error),
    })
}

/// The refusal of a file that is no plan but another kind that is known; nothing of any other file.
fn no_plan(path: &Path, text: &str) -> Option<Failure> {
    let name = path.display().to_string();
    match file::parse(&name, text) {
        Ok(TrajectoryFile::Pieces(_) | TrajectoryFile::Spline(_)) => Some(Failure::input(format!(
            "{name}: is a trajectory already, nothing to plan; `quatrack fly --trajectory {name}` flies it"
        ))),
        Err(error @ FileError::Samples { .. }) => Some(Failure::input(error)),
        _ => None,
    }
}

/// The same with nothing over the file's keys, in the usual time.
pub(super) fn of_text(path: &Path, text: &str) -> Result<PlannedFlight, Failure> {
    planned(path, text, Overrides::default(), TIME_LIMIT_S).map(|(_, flight)| flight)
}

/// How a planning error ends the command: 1 where the plan cannot be met, 2 where the file cannot be used.
pub(super) fn failed(path: &Path, error: &PlanError) -> Failure {
    let line = format!("{}: {error}", path.display());
    match error {
        PlanError::TimeLimit { .. } => Failure::verdict(format!("{line} (`quatrack plan` has --time-limit-s)")),
        PlanError::Infeasible(_)
        | PlanError::NotConverged(_)
        | PlanError::HeadingRate { .. }
        | PlanError::NoTimes { .. } => Failure::verdict(line),
        _ => Failure::input(line),
    }
}

#[cfg(test)]
mod tests;
