//! From logs to the report: figures, intervals, predictions, regions and notes.

mod document;
mod text;

use std::path::Path;

use quatrack_design::vehicle::Vehicle;

use crate::IdentifyError;
use crate::fit::{Base, Fit, fit};
use crate::flight::{Flight, prepare, without_copies};
use crate::log::{self, ColumnMap};
use crate::predict::{Prediction, validate};
use crate::regions::{Standing, standings};

pub use document::Document;

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

#[cfg(test)]
mod tests;
