//! Actuator-aware designs in; the source of the core's built-in tables out.

use std::fmt::Write;

use super::DesignError;
use super::actuator_aware::{ActuatorAwareWeights, actuator_aware};
use crate::vehicle::Vehicle;

/// Control period of the built-in tables, s.
pub const PERIOD_S: f64 = 0.002;

/// The gain for a vehicle at the lag of its motors, every entry rounded to the nearest f32; by rows.
///
/// # Errors
/// [`DesignError`] where the design has no solution.
pub fn rounded_gain(vehicle: &Vehicle) -> Result<[[f32; 19]; 4], DesignError> {
    let design = actuator_aware(vehicle, vehicle.motors().lag_s, &ActuatorAwareWeights::STANDARD, PERIOD_S)?;
    Ok(std::array::from_fn(|row| std::array::from_fn(|column| design.gain[(row, column)] as f32)))
}

/// The whole of `core/src/gains/actuator_aware.rs`.
///
/// # Errors
/// As [`rounded_gain`].
pub fn actuator_aware_tables(vehicle: &Vehicle) -> Result<String, DesignError> {
    let mut text = String::from(
        "//! The actuator-aware law's built-in table: made by `cargo run --example actuator_aware_gains` and not edited by hand.\n\n\
         use crate::law::ActuatorAwareGain;\n",
    );
    let (name, lag_ms) = (vehicle.name(), 1e3 * vehicle.motors().lag_s);
    let constant = name.to_uppercase().replace(['-', '.'], "_");
    // Writing to a string does not fail.
    let _ = write!(
        text,
        "\n/// For the {name} with motors of {lag_ms:.0} ms, at 500 Hz.\n\
         pub static {constant}: ActuatorAwareGain = ActuatorAwareGain::table([\n"
    );
    for row in rounded_gain(vehicle)? {
        text.push_str("    [\n");
        for entries in row.chunks(4) {
            let entries: Vec<String> = entries.iter().map(|entry| format!("{entry:?}")).collect();
            let _ = writeln!(text, "        {},", entries.join(", "));
        }
        text.push_str("    ],\n");
    }
    text.push_str("]);\n");
    Ok(text)
}
