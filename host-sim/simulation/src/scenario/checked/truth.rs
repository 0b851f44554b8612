//! The true figures of a scenario's craft: the deviations of a file and the vehicle in; mass, inertia, lags, thrust and
//! battery, each within its bounds, out.

use nalgebra::Vector3;
use quatrack_design::vehicle::Vehicle;

use crate::plant::{Supply, Truth};
use crate::scenario::checks::Checks;
use crate::scenario::course::{HOVER_S, RAMP_S};
use crate::scenario::error::ScenarioError;
use crate::scenario::file::ScenarioFile;
use crate::scenario::whole::EIGHT_MEASURED_S;

/// Bounds of a motor's lag, ms.
pub(super) const LAG_MS: [f64; 2] = [1.0, 1000.0];

pub(super) fn truth(
    file: &ScenarioFile,
    checks: &Checks<'_>,
    vehicle: &Vehicle,
    measured_s: Option<f64>,
) -> Result<Truth, ScenarioError> {
    let errors = &file.errors;
    let own_ms = 1e3 * vehicle.motors().lag_s;
    let (rise, fall) = match (errors.lag_ms, errors.lag_rise_ms, errors.lag_fall_ms) {
        (lag, None, None) => (lag.unwrap_or(own_ms), lag.unwrap_or(own_ms)),
        (None, Some(rise), Some(fall)) => (rise, fall),
        (Some(lag), _, _) => {
            let must = "left out beside lag_rise_ms and lag_fall_ms, or these two left out".to_owned();
            return Err(checks.refuse("errors.lag_ms", &lag, must));
        }
        (None, rise, fall) => {
            let (key, value) = if rise.is_some() { ("errors.lag_rise_ms", rise) } else { ("errors.lag_fall_ms", fall) };
            let must = "given with lag_rise_ms and lag_fall_ms both; lag_ms is for one that is the same".to_owned();
            return Err(checks.refuse(key, &value.unwrap_or_default(), must));
        }
    };
    let split = errors.lag_rise_ms.is_some();
    let [rise_key, fall_key] =
        if split { ["errors.lag_rise_ms", "errors.lag_fall_ms"] } else { ["errors.lag_ms", "errors.lag_ms"] };
    let factor = |key, value, default, bounds| checks.one(key, value, default, bounds, "true over the vehicle's");
    let mass_factor = factor("errors.mass_factor", errors.mass_factor, 1.0, [0.5, 2.0])?;
    let inertia_factor = factor("errors.inertia_factor", errors.inertia_factor, 1.0, [0.2, 5.0])?;
    let thrust_factor = factor("errors.thrust_factor", errors.thrust_factor, 1.0, [0.5, 1.5])?;
    let end = factor("errors.thrust_factor_end", errors.thrust_factor_end, thrust_factor, [0.5, 1.5])?;
    let whole_s = HOVER_S + RAMP_S + measured_s.unwrap_or(EIGHT_MEASURED_S);
    let bias = errors.torque_bias_n_m.unwrap_or([0.0; 2]);
    let on_battery = match file.battery.charge {
        None => Truth::as_designed(vehicle),
        Some(charge) => on_battery(charge, checks, vehicle)?,
    };
    let offset = errors.centre_of_mass_m.unwrap_or([0.0; 2]);
    Ok(Truth {
        mass_kg: mass_factor * vehicle.mass_kg(),
        inertia_kg_m2: inertia_factor * vehicle.inertia_kg_m2(),
        rise_lag_s: 1e-3 * checks.one(rise_key, Some(rise), 0.0, LAG_MS, "in ms")?,
        fall_lag_s: 1e-3 * checks.one(fall_key, Some(fall), 0.0, LAG_MS, "in ms")?,
        delay_s: 1e-3 * errors.delay_ms.unwrap_or(0.0),
        thrust_factor,
        thrust_factor_per_s: (end - thrust_factor) / whole_s,
        torque_bias_n_m: Vector3::new(bias[0], bias[1], 0.0),
        centre_of_mass_m: Vector3::new(offset[0], offset[1], 0.0),
        motor_strength: errors.motor_strength.unwrap_or([1.0; 4]),
        ..on_battery
    })
}

/// As designed, but with the vehicle's force by command and voltage, and its battery at a charge.
pub(super) fn on_battery(charge: f64, checks: &Checks<'_>, vehicle: &Vehicle) -> Result<Truth, ScenarioError> {
    checks.one("battery.charge", Some(charge), 1.0, [0.0, 1.0], "the share of a full battery")?;
    let flown = Truth::as_flown(vehicle);
    match flown.supply {
        Supply::Battery { battery, .. } if flown.force_map.is_some() => Ok(Truth {
            force_map: flown.force_map,
            supply: Supply::Battery { battery, charge },
            ..Truth::as_designed(vehicle)
        }),
        _ => {
            let must = format!("left out: the file of {} says nothing of a battery", vehicle.name());
            Err(checks.refuse("battery.charge", &charge, must))
        }
    }
}
