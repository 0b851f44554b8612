//! From logs to the report: figures, intervals, predictions, regions and notes.

use std::collections::BTreeMap;
use std::path::Path;

use quatrack_design::vehicle::Vehicle;
use serde::Serialize;

use crate::IdentifyError;
use crate::fit::{Base, Fit, fit};
use crate::flight::{Flight, prepare, without_copies};
use crate::log::{self, ColumnMap};
use crate::predict::{Course, HORIZON, Prediction, validate};
use crate::regions::{Standing, standings};

/// Over the vehicle's own mass, either way: beyond, arm and inertia are another craft's, or the mass is in grams.
const MASS_FACTOR: f64 = 3.0;

/// All that is told.
#[derive(Clone, Debug)]
pub struct Report {
    /// Logs that were used.
    pub logs: Vec<String>,
    /// The figures.
    pub fit: Fit,
    /// On the quarter held out; why not, where the flights are too short for it.
    pub prediction: Result<Prediction, String>,
    /// Findings about the logs.
    pub notes: Vec<String>,
    /// Each built-in table of the vehicle.
    pub standings: Vec<Standing>,
    /// The flights, for pictures.
    pub flights: Vec<Flight>,
}

/// Identifies a craft from logs: the base vehicle's arm, limits and torque per thrust, and the mass flown, are believed.
///
/// # Errors
/// [`IdentifyError`] for a log that cannot be used, unless others can; its fault is a note then.
pub fn identify(
    paths: &[impl AsRef<Path>],
    map: &ColumnMap,
    vehicle: &Vehicle,
    mass_kg: f64,
) -> Result<Report, IdentifyError> {
    if !(1e-3..=100.0).contains(&mass_kg) {
        let must = "kilograms, from 0.001 to 100: 27 g are 0.027";
        return Err(IdentifyError::Value { field: "mass", value: mass_kg, must });
    }
    let own_kg = vehicle.mass_kg();
    if !(own_kg / MASS_FACTOR..=own_kg * MASS_FACTOR).contains(&mass_kg) {
        return Err(IdentifyError::Mass { mass_kg, own_kg, vehicle: vehicle.name().to_owned() });
    }
    let base = Base::of(vehicle, mass_kg);
    let (mut flights, mut notes, mut first) = (Vec::new(), Vec::new(), None);
    for path in paths {
        let takes = log::read(path.as_ref()).map(|log| log.takes(map));
        let prepared = match takes {
            Ok(takes) => takes.iter().map(|log| prepare(log, map)).collect(),
            Err(error) => vec![Err(error)],
        };
        for flight in prepared {
            match flight {
                Ok(flight) => flights.push(flight),
                Err(error) => {
                    notes.push(format!("{error}; left out"));
                    first = first.or(Some(error));
                }
            }
        }
    }
    let (flights, copies) = without_copies(flights);
    if flights.is_empty() {
        return Err(first.unwrap_or_else(|| IdentifyError::TooLittle("no log".to_owned())));
    }
    let mut flights = flights;
    notes.extend(with_one_voltage(&mut flights));
    notes.extend(flights.iter().flat_map(|flight| flight.notes.0.iter().cloned()).chain(copies.0));
    // Two fits, of all of the flights and of all but their last quarters, at once.
    let (fit, validated) = std::thread::scope(|scope| {
        let validated = scope.spawn(|| validate(&flights, &base));
        (fit(&flights, &base), validated.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    });
    let fit = fit?;
    let prediction = validated.map(|(prediction, _)| prediction).map_err(|error| error.to_string());
    let prediction = prediction.and_then(|prediction| {
        let end = prediction.ours.last().map_or(f64::NAN, |e| e.position_m + e.body_rate_rad_s);
        if end.is_finite() { Ok(prediction) } else { Err("what is predicted is no number".to_owned()) }
    });
    Ok(Report {
        logs: flights.iter().map(|flight| flight.name.clone()).collect(),
        standings: standings(vehicle, &fit),
        fit,
        prediction,
        notes,
        flights,
    })
}

/// A thrust is at a voltage: where a flight has none, those of the others say nothing of it.
fn with_one_voltage(flights: &mut [Flight]) -> Option<String> {
    let without = flights.iter().find(|flight| !flight.has_voltage)?.name.clone();
    if flights.iter().all(|flight| !flight.has_voltage) {
        return None;
    }
    for flight in flights {
        flight.has_voltage = false;
        flight.sections.iter_mut().for_each(|section| section.voltage.clear());
    }
    Some(format!("{without} has no voltage: those of the other logs are not used"))
}

/// The report as JSON has it.
#[derive(Serialize)]
pub struct Document {
    schema: &'static str,
    vehicle: String,
    mass_kg: f64,
    logs: Vec<String>,
    figures: BTreeMap<&'static str, Option<Figure>>,
    refused: BTreeMap<&'static str, String>,
    prediction: BTreeMap<&'static str, Row>,
    prediction_starts: usize,
    horizon_s: f64,
    tables: Vec<Table>,
    notes: Vec<String>,
    streams: Vec<Stream>,
}

#[derive(Serialize)]
struct Figure {
    value: f64,
    low: f64,
    high: f64,
}

#[derive(Serialize)]
struct Row {
    position_m: f64,
    velocity_m_s: f64,
    rotation_rad: f64,
    body_rate_rad_s: f64,
}

#[derive(Serialize)]
struct Table {
    table: &'static str,
    inside: bool,
    outside: Vec<String>,
    unknown: Vec<&'static str>,
}

#[derive(Serialize)]
struct Stream {
    log: String,
    flight_s: f64,
    pose_shift_ms: f64,
    estimate_rms_m: Option<f64>,
}

impl Report {
    /// For `--json`.
    pub fn document(&self) -> Document {
        let figures = self.fit.figures.iter().map(|(name, figure)| {
            (*name, figure.as_ref().ok().map(|e| Figure { value: e.value, low: e.low, high: e.high }))
        });
        let refused =
            self.fit.figures.iter().filter_map(|(name, figure)| figure.as_ref().err().map(|why| (*name, why.clone())));
        let row = |course: &Course| {
            let e = course[HORIZON - 1];
            Row {
                position_m: e.position_m,
                velocity_m_s: e.velocity_m_s,
                rotation_rad: e.rotation_rad,
                body_rate_rad_s: e.body_rate_rad_s,
            }
        };
        let prediction = self.prediction.as_ref().map_or_else(
            |_| BTreeMap::new(),
            |prediction| {
                BTreeMap::from([
                    ("ours", row(&prediction.ours)),
                    ("no_angular_acceleration", row(&prediction.no_angular_acceleration)),
                    ("no_change", row(&prediction.no_change)),
                ])
            },
        );
        Document {
            schema: "quatrack/identify/1",
            vehicle: self.fit.base.name.clone(),
            mass_kg: self.fit.base.mass_kg,
            logs: self.logs.clone(),
            figures: figures.collect(),
            refused: refused.collect(),
            prediction,
            prediction_starts: self.prediction.as_ref().map_or(0, |prediction| prediction.starts),
            horizon_s: HORIZON as f64 * crate::flight::STEP_S,
            tables: self
                .standings
                .iter()
                .map(|one| Table {
                    table: one.table,
                    inside: one.outside.is_empty() && one.unknown.is_empty(),
                    outside: one.outside.clone(),
                    unknown: one.unknown.clone(),
                })
                .collect(),
            notes: self.notes.clone(),
            streams: self
                .flights
                .iter()
                .map(|flight| Stream {
                    log: flight.name.clone(),
                    flight_s: flight.sections.iter().map(|s| s.len() as f64 * crate::flight::STEP_S).sum(),
                    pose_shift_ms: 1e3 * flight.pose_shift_s,
                    estimate_rms_m: flight.estimate_rms_m,
                })
                .collect(),
        }
    }

    /// For a terminal.
    pub fn text(&self) -> String {
        use std::fmt::Write as _;
        let mut text = String::new();
        // Writing to a string does not fail.
        for note in &self.notes {
            let _ = writeln!(text, "note: {note}");
        }
        for stream in self.document().streams {
            let _ = write!(
                text,
                "{}: {:.1} s of flight, pose {:+.0} ms after the on-board streams",
                stream.log, stream.flight_s, stream.pose_shift_ms
            );
            if let Some(rms) = stream.estimate_rms_m {
                let _ = write!(text, ", on-board position {:.1} cm rms from it", 100.0 * rms);
            }
            text.push('\n');
        }
        let Base { name, mass_kg, .. } = &self.fit.base;
        let _ = writeln!(text, "\n{name} of {:.1} g, with 95 % intervals:", 1e3 * mass_kg);
        for (name, figure) in &self.fit.figures {
            if let Ok(e) = figure {
                let _ = writeln!(text, "  {name:<26} {:>11.4e}  {:.4e} to {:.4e}", e.value, e.low, e.high);
            }
        }
        for (name, figure) in &self.fit.figures {
            if let Err(why) = figure {
                let _ = writeln!(text, "  {name:<26} not told: {why}");
            }
        }
        let [x, y, thrust, drag_x, drag_y] = self.fit.explained;
        let _ = writeln!(
            text,
            "explained below 6 Hz: torque {x:.2}, {y:.2}; thrust {thrust:.2}; drag {drag_x:.2}, {drag_y:.2} of the variance"
        );
        match &self.prediction {
            Ok(prediction) => {
                let _ = writeln!(
                    text,
                    "\n0.5 s ahead on the last quarter of each flight, from commands, mean of {} starts:",
                    prediction.starts
                );
                for (name, course) in [
                    ("ours", &prediction.ours),
                    ("no angular acceleration", &prediction.no_angular_acceleration),
                    ("no change", &prediction.no_change),
                ] {
                    let e = course[HORIZON - 1];
                    let _ = writeln!(
                        text,
                        "  {name:<24} {:.3} m  {:.3} m/s  {:.3} rad  {:.3} rad/s",
                        e.position_m, e.velocity_m_s, e.rotation_rad, e.body_rate_rad_s
                    );
                }
            }
            Err(why) => {
                let _ = writeln!(text, "\nnothing held out: {why}");
            }
        }
        for one in &self.standings {
            let unknown = one.unknown.join(", ");
            let _ = match (one.outside.is_empty(), one.unknown.is_empty()) {
                (true, true) => writeln!(text, "table {}: the craft is inside its certified region", one.table),
                (true, false) => {
                    writeln!(text, "table {}: inside by the known figures; {unknown} not known", one.table)
                }
                (false, _) => {
                    writeln!(text, "table {}: outside its certified region: {}", one.table, one.outside.join("; "))
                }
            };
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use quatrack_design::vehicle::VehicleFile;

    use super::*;

    /// Where real flights are looked for, from the root of the checkout and upwards.
    const FOLDER: &str = "shared/flights/nanobench";

    fn crazyflie() -> Vehicle {
        let file: VehicleFile = toml::from_str(include_str!("../../../gains/vehicles/crazyflie-2.1.toml")).unwrap();
        Vehicle::try_from(file).unwrap()
    }

    fn real_flights() -> Vec<PathBuf> {
        let above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
        let Some(folder) = above.map(|above| above.join(FOLDER)).find(|path| path.is_dir()) else {
            println!("SKIPPED: no flights in a folder {FOLDER} beside or above the checkout");
            return Vec::new();
        };
        let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        paths.retain(|path| path.extension().is_some_and(|extension| extension == "gz"));
        paths.sort();
        paths
    }

    /// NanoBench (arXiv 2603.09908): the figures are those of an independent identification of 33 flights of the same craft.
    #[test]
    fn the_figures_of_a_real_craft_are_found_in_its_flights() {
        let paths = real_flights();
        if paths.is_empty() {
            return;
        }
        let map = ColumnMap::built_in("nanobench").unwrap();
        let report = identify(&paths, &map, &crazyflie(), 0.027).unwrap();
        for (name, value, share) in [
            ("lag_ms", 67.0, 8.0 / 67.0),
            ("drag_x_per_s", 0.39, 0.08),
            ("drag_y_per_s", 0.40, 0.08),
            ("moment_x_n_m_per_m_s", 3.8e-4, 0.10),
            ("moment_y_n_m_per_m_s", 4.3e-4, 0.10),
            ("inertia_x_kg_m2", 1.6e-5, 0.15),
            ("inertia_y_kg_m2", 1.75e-5, 0.15),
            ("thrust_full_n", 0.124, 0.05),
        ] {
            match &report.fit.figures[name] {
                Ok(found) => assert!((found.value / value - 1.0).abs() < share, "{name}: {found:?}"),
                // Smooth flights may not tell an inertia.
                Err(why) => assert!(name.starts_with("inertia"), "{name}: {why}"),
            }
        }
        let prediction = report.prediction.unwrap();
        let (ours, still) = (prediction.ours[HORIZON - 1], prediction.no_angular_acceleration[HORIZON - 1]);
        assert!(
            ours.position_m < still.position_m && ours.body_rate_rad_s < still.body_rate_rad_s,
            "{ours:?} {still:?}"
        );
        assert!(ours.velocity_m_s < 1.1 * still.velocity_m_s && ours.rotation_rad < 1.1 * still.rotation_rad);
    }

    #[test]
    fn a_mass_in_grams_is_refused() {
        let map = ColumnMap::built_in("nanobench").unwrap();
        let error = identify(&["none.csv"], &map, &crazyflie(), 270.0).unwrap_err();
        assert_eq!(error.to_string(), "mass = 270: must be kilograms, from 0.001 to 100: 27 g are 0.027");
    }
}
