//! `quatrack manoeuvres`: a vehicle and its conditions in; flights beyond the linear range, law by law, and pictures
//! of them, out.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use quatrack_simulation::flight::rigid_loop::RigidFlight;
use quatrack_simulation::scenario::manoeuvres::{Manoeuvre, Outcome};
use quatrack_simulation::scenario::{Law, Scenario};
use serde::Serialize;

use super::scenario::ScenarioArgs;
use super::{Failure, output, picture};
use crate::figures::{Curve, TrackingFigure};

/// Laws where none is named: ours, the stock controller's, the one before ours, and the paper's.
const LAWS: [Law; 4] = [Law::Quatrack, Law::Mellinger, Law::ActuatorAware, Law::LqrE];

/// Flies take-off, landing, a step of 1 m, a shove of half a metre, a gust as strong as the weight and a start upside down, each
/// by quatrack, mellinger, actuator-aware and lqr-e, or by --law: on the vehicle in its own air where its file knows it, or under
/// the conditions of --scenario and its flags. Course and start of a scenario are not flown.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    scenario: ScenarioArgs,
    /// Folder for figures, created where it is missing.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the figures of every flight as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<output::File>,
}

#[derive(Serialize)]
struct ManoeuvresReport {
    vehicle: String,
    conditions: String,
    rows: Vec<Row>,
}

#[derive(Serialize)]
struct Row {
    flight: &'static str,
    law: &'static str,
    outcome: Outcome,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let scenario = args.scenario.checked_in_own_air("crazyflie-2.1")?;
    let laws = args.scenario.law.map_or_else(|| LAWS.to_vec(), |law| vec![law]);
    let conditions = scenario.conditions().to_string();
    let mut report = ManoeuvresReport { vehicle: scenario.vehicle.name().to_owned(), conditions, rows: Vec::new() };
    let mut figures = Vec::new();
    for manoeuvre in Manoeuvre::ALL {
        let flights = fly(manoeuvre, &scenario, &laws)?;
        report.rows.extend(flights.iter().map(|(law, flight)| Row {
            flight: manoeuvre.name(),
            law,
            outcome: Outcome::of(flight),
        }));
        figures.push((manoeuvre, flights));
    }
    output::print(&table_text(&report))?;
    if let Some(dir) = &args.out {
        output::create_dir(dir)?;
        for (manoeuvre, flights) in &figures {
            let title = format!("{}: {}, {}", report.vehicle, manoeuvre.title(), report.conditions);
            write_figure(dir, manoeuvre.name(), &title, flights)?;
        }
    }
    if let Some(path) = &args.json {
        output::write_json(path, &output::Named::new("manoeuvres", &report))?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    Ok(())
}

fn fly(manoeuvre: Manoeuvre, scenario: &Scenario, laws: &[Law]) -> Result<Vec<(&'static str, RigidFlight)>, Failure> {
    let flown = |law: &Law| {
        let mut flying = law.start(&scenario.vehicle, &scenario.told).map_err(Failure::input)?;
        let flight = manoeuvre.fly(scenario, flying.as_mut()).map_err(Failure::input)?;
        Ok((law.name(), flight))
    };
    laws.iter().map(flown).collect()
}

fn table_text(report: &ManoeuvresReport) -> String {
    let mut text = format!(
        "{}: {}\n\n{:<12} {:<16} {:>9} {:>9} {:>10} {:>8} {:>9} {:>10}\n",
        report.vehicle,
        report.conditions,
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
            "{flight:<12} {law:<16} {:>9.4} {:>9.4} {settled:>10} {:>8.3} {:>9.1} {:>10}{}",
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
    picture::write_both(dir, name, &figure.to_svg().map_err(Failure::verdict)?)
}
