//! `quatrack identify`: logs of flights in; figures of the craft with intervals, a vehicle file and pictures out.

mod pictures;

use std::path::{Path, PathBuf};

use quatrack_identify::log::ColumnMap;
use quatrack_identify::{identify, vehicle_toml};
use quatrack_plan::bounded;
use quatrack_simulation::vehicles;

use super::vehicle::VehicleChoice;
use super::{Failure, output};

/// Tells a craft's figures from logs of its own flights: lag, thrust, drag, airflow moment, inertia, each with a 95 % interval.
///
/// A figure that the flights do not tell is refused with the manoeuvre that would. A quarter of each
/// flight is held out and predicted from its commands. docs/identify.md names the manoeuvres to fly and the signals to
/// log.
///
/// Examples:
///   quatrack identify flight.csv --mass-kg 0.034 --out my-craft.toml
///   quatrack identify log00 log01 --columns usd --vehicle crazyflie-2.1-brushless --mass-kg 0.045
///   quatrack identify nanobench/*.csv.gz --columns nanobench --plot out/identify
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Args {
    /// Logs of one craft: CSV, plain or compressed by gzip, or the micro SD deck's binary log.
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,
    /// The map of columns to quantities: nanobench, cflib, usd, or a map of one's own [default: cflib, or usd for a log
    /// of the deck]
    #[arg(long, value_name = "nanobench|cflib|usd|MAP.toml")]
    columns: Option<String>,
    /// The mass flown, with battery and decks [default: the map's, else the vehicle's]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    mass_kg: Option<f64>,
    /// The vehicle that arm, limits and torque per thrust are taken of: a built-in one, or a TOML file [default: the map's,
    /// else crazyflie-2.1]
    #[arg(long, value_name = "VEHICLE")]
    vehicle: Option<VehicleChoice>,
    /// Write the figures as a vehicle file, with intervals and sources.
    #[arg(long, value_name = "VEHICLE.toml")]
    out: Option<output::File>,
    /// Folder for pictures, created where it is missing: prediction against flight, residuals, lag curve.
    #[arg(long, value_name = "DIR")]
    plot: Option<PathBuf>,
    /// Write the figures as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<output::File>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let map = map(args)?;
    let vehicle = match (&args.vehicle, &map.vehicle) {
        (Some(VehicleChoice(vehicle)), _) => vehicle.clone(),
        (None, named) => vehicles::by_name(named.as_deref().unwrap_or("crazyflie-2.1")).map_err(Failure::input)?,
    };
    let mass_kg = args.mass_kg.or(map.mass_kg).unwrap_or_else(|| vehicle.mass_kg());
    let report = identify(&args.logs, &map, &vehicle, mass_kg).map_err(Failure::input)?;
    if args.mass_kg.or(map.mass_kg).is_none() {
        output::print(&format!(
            "note: no --mass-kg: taken as {:.1} g, that of {}; inertia and moment are in proportion to it\n",
            1e3 * mass_kg,
            vehicle.name()
        ))?;
    }
    output::print(&report.text())?;
    if let Some(path) = &args.out {
        let text = vehicle_toml(&report.fit, &vehicle, &report.logs).map_err(Failure::verdict)?;
        output::write(path, text.as_bytes())?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    if let Some(dir) = &args.plot {
        pictures::write(dir, &report)?;
    }
    if let Some(path) = &args.json {
        output::write_json(path, &report.document())?;
    }
    Ok(())
}

fn map(args: &Args) -> Result<ColumnMap, Failure> {
    let deck = || args.logs.first().is_some_and(|log| is_of_deck(log));
    let name = match &args.columns {
        Some(name) => name.as_str(),
        None if deck() => "usd",
        None => "cflib",
    };
    if let Some(map) = ColumnMap::built_in(name) {
        return Ok(map);
    }
    let known = || ColumnMap::names().collect::<Vec<_>>().join(", ");
    let text = bounded::read_to_string(Path::new(name))
        .map_err(|error| Failure::input(format!("--columns {name}: {} or a file of one's own ({error})", known())))?;
    ColumnMap::parse(&text, name).map_err(Failure::input)
}

/// Whether a file is the deck's log, by its first byte.
fn is_of_deck(path: &Path) -> bool {
    use std::io::Read as _;
    let mut first = [0];
    std::fs::File::open(path).and_then(|mut file| file.read_exact(&mut first)).is_ok() && first == [0xBC]
}
