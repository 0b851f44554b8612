//! `quatrack manoeuvres`: a vehicle and its motors' lag in; what flights beyond the linear range come to, and figures of
//! them, out.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use quatrack::{Equilibrium, FeedForward, gains};
use quatrack_cli::figures::{Curve, TrackingFigure};
use quatrack_design::certify::Region;
use quatrack_design::design::actuator_aware::ActuatorAwareWeights;
use quatrack_simulation::flight::manoeuvres::{Manoeuvre, Outcome};
use quatrack_simulation::flight::motor_laws::{AwareTable, CraftLaw, FlightError, default_lag_s};
use quatrack_simulation::flight::rigid_loop::RigidFlight;
use quatrack_simulation::flight::robustness;
use serde::Serialize;

use super::vehicle::VehicleChoice;
use super::{Failure, output};

/// Flies take-off, landing, a step of 1 m, a shove of half a metre, a gust and a start upside down with the vehicle's default
/// actuator-aware table, and an eight at 2.1 m/s with that table and with the paper's LQR-E behind the core's body-rate
/// loop. The f32 core runs at 500 Hz against a rigid body with lagging motors that saturate.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// A built-in vehicle, or a TOML file.
    #[arg(long, value_name = "VEHICLE", default_value = "crazyflie-2.1")]
    vehicle: VehicleChoice,
    /// Time constant of the motors, ms; by default the vehicle's own.
    #[arg(long, value_name = "MS", allow_negative_numbers = true)]
    lag_ms: Option<f64>,
    /// Folder for figures, created where it is missing.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the figures of every flight as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

#[derive(Serialize)]
struct ManoeuvresReport {
    vehicle: String,
    lag_ms: f64,
    rows: Vec<Row>,
}

#[derive(Serialize)]
struct Row {
    flight: String,
    law: &'static str,
    outcome: Outcome,
}

/// Shortest and longest lag that the core and the plant can step at 500 Hz, ms.
const LAGS_MS: std::ops::RangeInclusive<f64> = 4.0..=1000.0;

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let vehicle = &args.vehicle.0;
    let lag_ms = args.lag_ms.unwrap_or(1e3 * vehicle.motors().lag_s);
    if !LAGS_MS.contains(&lag_ms) {
        let (least, most) = (LAGS_MS.start(), LAGS_MS.end());
        return Err(Failure::input(format!("--lag-ms {lag_ms}: must be from {least} to {most} ms")));
    }
    let lag_s = 1e-3 * lag_ms;
    let fail = |error: FlightError| Failure::input(error);
    let table =
        AwareTable::new(vehicle, default_lag_s(vehicle), &ActuatorAwareWeights::STANDARD, &Region::of_any_crazyflie())
            .map_err(fail)?;
    let mut report = ManoeuvresReport { vehicle: vehicle.name().to_owned(), lag_ms, rows: Vec::new() };
    let mut figures = Vec::new();
    for manoeuvre in Manoeuvre::ALL {
        let flight = manoeuvre.fly(vehicle, lag_s, &table).map_err(fail)?;
        report.rows.push(Row {
            flight: manoeuvre.name().to_owned(),
            law: "actuator-aware-robust",
            outcome: Outcome::of(&flight),
        });
        let title = format!("{}: {}, motor lag {lag_ms} ms", vehicle.name(), manoeuvre.title());
        figures.push((manoeuvre.name(), title, vec![("actuator-aware", flight)]));
    }
    let lqr_e = Equilibrium { feed_forward: FeedForward::With, ..Equilibrium::new(&gains::paper::LQR_E) };
    let flights = [
        ("actuator-aware-robust", table.craft_law().map_err(fail)?),
        ("lqr-e", CraftLaw::by_body_rates(vehicle, lqr_e, lag_s).map_err(fail)?),
    ];
    let mut eights = Vec::new();
    for (law, craft_law) in flights {
        let flight = robustness::fly_eight(vehicle, &craft_law, lag_s).map_err(fail)?;
        report.rows.push(Row { flight: "eight".to_owned(), law, outcome: Outcome::of(&flight) });
        eights.push((law, flight));
    }
    let title = format!("{}: eight at 2.1 m/s, motor lag {lag_ms} ms", vehicle.name());
    figures.push(("eight", title, eights));
    output::print(&table_text(&report))?;
    if let Some(dir) = &args.out {
        output::create_dir(dir)?;
        for (name, title, flights) in &figures {
            write_figure(dir, name, title, flights)?;
        }
    }
    if let Some(path) = &args.json {
        output::write_json(path, &output::Named::new("manoeuvres", &report))?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    Ok(())
}

fn table_text(report: &ManoeuvresReport) -> String {
    let mut text = format!(
        "{}, motor lag {} ms\n{:<12} {:<22} {:>9} {:>9} {:>10} {:>8} {:>9} {:>10}\n",
        report.vehicle,
        report.lag_ms,
        "flight",
        "law",
        "most, m",
        "end, m",
        "settled, s",
        "low, m",
        "tilt, deg",
        "cut steps"
    );
    for Row { flight, law, outcome } in &report.rows {
        let settled = outcome.settled_s.map_or_else(|| "never".to_owned(), |s| format!("{s:.2}"));
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{flight:<12} {law:<22} {:>9.4} {:>9.4} {settled:>10} {:>8.3} {:>9.1} {:>10}{}",
            outcome.max_error_m,
            outcome.end_error_m,
            outcome.min_z_m,
            outcome.max_tilt_deg,
            outcome.saturated_steps,
            if outcome.whole { "" } else { "  lost" }
        );
    }
    text
}

fn write_figure(dir: &Path, name: &str, title: &str, flights: &[(&str, RigidFlight)]) -> Result<(), Failure> {
    // The longest flight knows the whole reference.
    let Some((_, longest)) = flights.iter().max_by_key(|(_, flight)| flight.samples.len()) else { return Ok(()) };
    let times = |flight: &RigidFlight| flight.samples.iter().map(|sample| sample.time_s).collect::<Vec<_>>();
    let places = |flight: &RigidFlight| flight.samples.iter().map(|sample| sample.state.position_m).collect::<Vec<_>>();
    let targets: Vec<Vector3<f64>> = longest.samples.iter().map(|sample| sample.target_m).collect();
    let flown: Vec<_> = flights.iter().map(|(law, flight)| (*law, times(flight), places(flight))).collect();
    let figure = TrackingFigure {
        title,
        reference: Curve { label: "reference", time_s: &times(longest), position_m: &targets },
        flights: flown.iter().map(|(label, time_s, position_m)| Curve { label, time_s, position_m }).collect(),
    };
    let (svg, png) = (dir.join(format!("{name}.svg")), dir.join(format!("{name}.png")));
    output::write(&svg, figure.to_svg().map_err(Failure::verdict)?.as_bytes())?;
    output::write(&png, &figure.to_png().map_err(Failure::verdict)?)?;
    output::print(&format!("wrote {} and {}\n", svg.display(), png.display()))
}
