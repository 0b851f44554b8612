//! Logs slower than the grid: flights in; the figures that they do not tell, each with a reason, out.
//!
//! A law of 500 Hz gives ten commands between two samples of a log of 50 Hz. Noise of those that are logged looks like slow commands
//! that the craft did not get, since a line joins them: over a white command its power below the corner grows with the
//! time between two samples. An answer of the motors to it is not seen, so the lag comes out too long and the inertia too
//! small. The filters take points on that line for news, which they are not, and the lag comes out too short. On crafts with 30 to 126 ms
//! the interval at 50 Hz excluded the true lag on up to all flights, by a factor of up to 2.7.

use super::figures::Figures;
use crate::flight::{Flight, STEP_S};

/// A longer time between two samples is not that of a log of 100 Hz whose clock is off, s.
const SLOWEST_S: f64 = 1.05 * STEP_S;

/// Figures that hang on the time between a command and a motion.
const IN_TIME: [&str; 6] = ["lag_", "delay_", "inertia_", "rate_damping_", "rotor_inertia_", "rotor_lead_"];

/// The slowest flight that is slower than the grid.
pub(super) fn slowest(flights: &[Flight]) -> Option<&Flight> {
    let slow = flights.iter().filter(|flight| flight.period_s > SLOWEST_S);
    slow.max_by(|a, b| a.period_s.total_cmp(&b.period_s))
}

/// What such a flight does not tell.
pub(super) fn untold(figures: &Figures<'_>, flight: &Flight) -> Vec<(&'static str, String)> {
    let reason = format!(
        "{} has a sample of motor commands, gyroscope or accelerometer every {:.1} ms, and commands between two samples move the \
         craft, too: log motor commands, gyroscope and accelerometer at 100 Hz or more",
        flight.name,
        1e3 * flight.period_s
    );
    let names = figures.all.keys().filter(|name| IN_TIME.iter().any(|start| name.starts_with(start)));
    names.map(|name| (*name, reason.clone())).collect()
}
