//! The source of the Crazyflie controller's own tables: vehicles in; gains for motor forces, with the factor by which
//! their feedback may be off, out.

use std::fmt::Write as _;

use nalgebra::DMatrix;

use crate::certify::{Region, certify_region};
use crate::design::actuator_aware::{ActuatorAwareWeights, actuator_aware};
use crate::flight::motor_laws::{FlightError, default_lag_s};
use crate::vehicle::Vehicle;

/// Control period, s.
const PERIOD_S: f64 = 0.002;

/// Factors on the feedback that are tried, the largest first.
const FACTORS: [f64; 5] = [2.0, 1.75, 1.5, 1.25, 1.1];

/// Vehicles and what their gains are called in the source.
const VEHICLES: [(&str, &str); 3] = [
    ("crazyflie-2.1", "CRAZYFLIE_2_1"),
    ("crazyflie-2.1-upgrade-kit", "CRAZYFLIE_2_1_UPGRADE_KIT"),
    ("crazyflie-2.1-brushless", "CRAZYFLIE_2_1_BRUSHLESS"),
];

/// The largest of `FACTORS` by which thrust, roll and pitch together, and yaw, may each be strengthened or weakened
/// with the whole region still stable; 1 where there is none.
///
/// # Errors
/// [`FlightError`] where a certificate cannot be computed.
pub fn feedback_margin(vehicle: &Vehicle, in_parts: &DMatrix<f64>, lag_s: f64) -> Result<f64, FlightError> {
    let region = Region::of_any_crazyflie();
    'factors: for factor in FACTORS {
        for (position, yaw) in
            [(factor, factor), (factor, 1.0 / factor), (1.0 / factor, factor), (1.0 / factor, 1.0 / factor)]
        {
            let mut scaled = in_parts.clone();
            for (row, scale) in [position, position, position, yaw].into_iter().enumerate() {
                scaled.row_mut(row).scale_mut(scale);
            }
            if certify_region(vehicle, &scaled, lag_s, PERIOD_S, &region)?.spectral_radius >= 1.0 {
                continue 'factors;
            }
        }
        return Ok(factor);
    }
    Ok(1.0)
}

/// The source of `crazyflie/src/builtin/motor_gains.rs`.
///
/// # Errors
/// [`FlightError`] where a vehicle has no design or no certificate.
pub fn motor_gains() -> Result<String, FlightError> {
    let mut source = String::from(
        "//! Gains for motor forces, the default ones of each craft: made by `cargo run --example crazyflie_tables` and not\n\
         //! edited by hand. Certified over motor lags of 50 to 126 ms with the mass off by 20 %, the inertia by 30 % and 10 ms of\n\
         //! delay, all at once, and with the feedback off by the stated factor.\n\n\
         use quatrack::law::ActuatorAwareGain;\n",
    );
    for (name, constant) in VEHICLES {
        let vehicle = Vehicle::by_name(name)?;
        let lag_s = default_lag_s(&vehicle);
        let design = actuator_aware(&vehicle, lag_s, &ActuatorAwareWeights::STANDARD, PERIOD_S)?;
        let margin = feedback_margin(&vehicle, &design.gain_in_parts, lag_s)?;
        let id = vehicle.id();
        // Writing to a string does not fail.
        let _ = write!(
            source,
            "\n/// Vehicle id, design lag (s) and factor of {name}.\npub(super) const {constant}_FIGURES: (u32, f32, f32) = (0x{id:08x}, {lag_s:?}, {margin:?});\n"
        );
        let _ = write!(
            source,
            "\n/// Of {name}.\npub(super) const {constant}: ActuatorAwareGain = ActuatorAwareGain::table([\n"
        );
        for row in design.gain.row_iter() {
            let entries: Vec<String> = row.iter().map(|entry| format!("{:?}", *entry as f32)).collect();
            let _ = writeln!(source, "    [{}],", entries.join(", "));
        }
        source.push_str("]);\n");
    }
    Ok(source)
}
