//! The flights once more, from commands alone, on a part that was held out: predictions half a second ahead, beside two
//! predictions that know less.
//!
//! The state at a start comes from the past alone: pose and velocity as measured, body rates and a disturbing torque by a
//! Kalman filter on the gyroscope, a disturbing force by the accelerometer. Disturbances fade as they do on the flights
//! that were learned from.

mod craft;
mod errors;
mod example;
mod habits;
mod starts;

use crate::IdentifyError;
use crate::fit::{Base, Fit, fit};
use crate::flight::{Flight, Section};
pub use craft::HORIZON;
use craft::{BEFORE, BETWEEN, Habits};
pub use errors::{Course, Errors, overall};
pub use example::Example;

/// Share of each flight that is held out, at its end.
const HELD_OUT: f64 = 0.25;

/// Three ways to predict on the part that was held out.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// With the identified figures.
    pub ours: Course,
    /// The same without angular acceleration.
    pub no_angular_acceleration: Course,
    /// Everything stays as it is at the start.
    pub no_change: Course,
    /// The number of starts.
    pub starts: usize,
    /// A part that was held out, for pictures: one stretch of a flight, predicted from its every half second.
    pub example: Option<Example>,
}

/// Learns from three quarters of every flight and predicts the last.
///
/// # Errors
/// [`IdentifyError::TooLittle`] where the flights are too short for that.
pub fn validate(flights: &[Flight], base: &Base) -> Result<(Prediction, Fit), IdentifyError> {
    let (learned, held): (Vec<Flight>, Vec<Flight>) = flights.iter().map(halves).unzip();
    let fit = fit(&learned, base)?;
    let habits = habits::habits(&learned, &fit);
    Ok((predict(&held, &fit, &habits), fit))
}

/// The first three quarters of a flight and its last, by length.
fn halves(flight: &Flight) -> (Flight, Flight) {
    let total: usize = flight.sections.iter().map(Section::len).sum();
    let mut left = ((1.0 - HELD_OUT) * total as f64) as usize;
    let (mut first, mut second) = (Vec::new(), Vec::new());
    for section in &flight.sections {
        let here = left.min(section.len());
        if here > 2 * BEFORE {
            first.push(section.part(0..here));
        }
        if section.len() - here > BEFORE + HORIZON {
            second.push(section.part(here..section.len()));
        }
        left -= here;
    }
    let with = |sections| Flight { sections, ..flight.clone() };
    (with(first), with(second))
}

fn predict(held: &[Flight], fit: &Fit, habits: &Habits) -> Prediction {
    let (ours, starts) = starts::errors(held, fit, habits, BETWEEN, true);
    Prediction {
        ours,
        no_angular_acceleration: starts::errors(held, fit, habits, BETWEEN, false).0,
        no_change: starts::unchanged(held, fit),
        starts,
        example: example::example(held, fit, habits),
    }
}
