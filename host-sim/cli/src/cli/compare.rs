//! `quatrack compare`: a scenario and laws in; how closely each follows the course, in one table and one picture, out.

use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use quatrack_simulation::flight::rigid_loop::RigidFlight;
use quatrack_simulation::scenario::Law;
use quatrack_simulation::scenario::compare::Table;

use super::fly::scenario::OwnCourse;
use super::picture::{self, Picture};
use super::scenario::ScenarioArgs;
use super::transform::TransformArgs;
use super::{Failure, fly, output};
use crate::figures::{Curve, TrackingFigure};

/// Flies laws on one scenario, each from the same start with the same noise and gusts: ours, the paper's, and those of
/// Mellinger and Kumar, of Lee, Leok and McClamroch, and the cascaded PID with the gains of the Crazyflie's firmware.
///
/// Figures are the position error summed over samples of 10 ms, and the largest, while it is measured.
///
/// Example:
///   quatrack compare --scenario my.toml --laws quatrack,mellinger,lee --picture eight.svg
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Args {
    #[command(flatten)]
    scenario: ScenarioArgs,
    /// Which laws, by their names; by default --law, or else all.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', conflicts_with = "law")]
    laws: Vec<Law>,
    /// Fly a gain table of the cascade (.bin), or a design (.toml) whose table is made first, beside them; on its vehicle where
    /// none is named.
    #[arg(long, value_name = "FILE")]
    gains: Option<PathBuf>,
    /// Write the table as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<output::File>,
    /// Write a picture of the first four laws, .svg or .png.
    #[arg(long, value_name = "FILE")]
    picture: Option<Picture>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let named = args.scenario.scenario.is_some() || args.scenario.vehicle.is_some();
    let gains = args.gains.as_deref().map(|path| Ok((path, fly::table::source(path)?))).transpose()?;
    let own = gains.as_ref().filter(|_| !named).map(|(path, table)| table.own_vehicle(path)).transpose()?;
    let scenario = args.scenario.checked_for(gains.is_some(), own.as_ref())?;
    let course = OwnCourse::of(&scenario, &TransformArgs::default())?;
    let note = course.line();
    let flown = scenario.flown(course.trajectory);
    let asked: Vec<Law> = args.scenario.law.into_iter().chain(args.laws.iter().copied()).collect();
    let laws = if asked.is_empty() { Law::ALL.to_vec() } else { asked.clone() };
    let (mut flights, mut grounded) = (Vec::with_capacity(laws.len() + 1), String::new());
    if let Some((path, table)) = &gains {
        flights.push(fly::table::in_scenario(path, table, &scenario, &|law, name| {
            Ok((name.to_owned(), scenario.fly(law, &flown).map_err(Failure::input)?))
        })?);
    }
    for law in laws {
        let mut flying = match law.start(&scenario.vehicle, &scenario.told) {
            Ok(flying) => flying,
            // Nobody has asked for this one.
            Err(error) if asked.is_empty() => {
                grounded.push_str(&format!("\nnot flown: {error}"));
                continue;
            }
            Err(error) => return Err(Failure::input(error)),
        };
        flights.push((law.name().to_owned(), scenario.fly(flying.as_mut(), &flown).map_err(Failure::input)?));
    }
    let table = Table::of(&flights);
    output::print(&format!("{scenario}\n\n{table}{grounded}\n{note}"))?;
    if let Some(path) = &args.json {
        output::write_json(path, &table)?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    if let Some(path) = &args.picture {
        write_picture(path, &scenario.to_string(), &flights)?;
    }
    Ok(())
}

/// Most laws that a picture shows apart.
const SHOWN: usize = 4;

fn write_picture(path: &Path, title: &str, flights: &[(String, RigidFlight)]) -> Result<(), Failure> {
    let shown = &flights[..flights.len().min(SHOWN)];
    // The longest flight knows the whole course.
    let Some((_, longest)) = shown.iter().max_by_key(|(_, flight)| flight.samples.len()) else { return Ok(()) };
    let times = |flight: &RigidFlight| flight.samples.iter().map(|sample| sample.time_s).collect::<Vec<_>>();
    let places = |flight: &RigidFlight| flight.samples.iter().map(|sample| sample.state.position_m).collect::<Vec<_>>();
    let targets: Vec<Vector3<f64>> = longest.samples.iter().map(|sample| sample.target_m).collect();
    let drawn: Vec<_> = shown
        .iter()
        .filter(|(_, flight)| flight.samples.len() > 1)
        .map(|(law, flight)| (law, times(flight), places(flight)))
        .collect();
    let figure = TrackingFigure {
        title,
        reference: Curve { label: "course", time_s: &times(longest), position_m: &targets },
        flights: drawn.iter().map(|(label, time_s, position_m)| Curve { label, time_s, position_m }).collect(),
    };
    picture::write(path, &figure.to_svg().map_err(Failure::verdict)?)?;
    let names: Vec<&str> = drawn.iter().map(|(law, ..)| law.as_str()).collect();
    output::print(&format!("wrote {}: {}\n", path.display(), names.join(", ")))
}
