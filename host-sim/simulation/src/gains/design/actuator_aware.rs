//! A design down to the motors: its entries in; lag, weights and region out.

use quatrack_design::certify::RegionBounds;
use quatrack_design::design::actuator_aware::ActuatorAwareWeights;

use super::entry::{check, misplaced, missing};
use super::problem::Problem;
use super::weights::weight;
use crate::gains::GainsError;
use crate::gains::file::{DesignFile, Linearisation, Weights};

/// Longest lag of motors, ms.
const LONGEST_LAG_MS: f64 = 1e3;
/// Delays in a region, ms: each period of it is a state a motor.
const LONGEST_DELAY_MS: f64 = 50.0;
/// Most that mass or inertia may be off, percent.
const MOST_PERCENT: f64 = 90.0;

pub(super) fn actuator_aware(file: &DesignFile, weights: &Weights) -> Result<Problem, GainsError> {
    let here = &file.method;
    if file.linearisation == Linearisation::FlatOutput {
        return Err(misplaced("method", &here.quoted(), &file.linearisation));
    }
    if let Some(gain) = file.rate_loop_gain_1_s {
        return Err(misplaced("rate_loop_gain_1_s", &gain, here));
    }
    let lag = |key: &str, value: f64| {
        // The core wants two control periods at least.
        let least = 2e3 / f64::from(file.control_rate_hz.max(1));
        check((least..=LONGEST_LAG_MS).contains(&value), key, value, format!("from {least} to {LONGEST_LAG_MS} ms"))
    };
    let lag_ms = file.motor_lag_ms.ok_or_else(|| missing("motor_lag_ms", here, "motor_lag_ms = 126.0"))?;
    lag("motor_lag_ms", lag_ms)?;
    let example = "[region] with motor_lag_ms = [50.0, 126.0]";
    let region = file.region.ok_or_else(|| missing("[region]", here, example))?;
    if region.from.is_some() {
        return Err(misplaced("region.from", &"\"identified\"", here));
    }
    let lags_ms = region.motor_lag_ms.ok_or_else(|| missing("region.motor_lag_ms", here, example))?;
    let [shortest, longest] = lags_ms;
    lag("region.motor_lag_ms", shortest)?;
    lag("region.motor_lag_ms", longest)?;
    check(shortest <= longest, "region.motor_lag_ms", longest, format!("at least the first, {shortest}"))?;
    let percent = |key: &str, value: f64| {
        check((0.0..=MOST_PERCENT).contains(&value), key, value, format!("from 0 to {MOST_PERCENT}"))
    };
    let [mass_percent, inertia_percent, delay_ms] =
        [region.mass_percent, region.inertia_percent, region.delay_ms].map(Option::unwrap_or_default);
    percent("region.mass_percent", mass_percent)?;
    percent("region.inertia_percent", inertia_percent)?;
    let must = format!("from 0 to {LONGEST_DELAY_MS}");
    check((0.0..=LONGEST_DELAY_MS).contains(&delay_ms), "region.delay_ms", delay_ms, must)?;
    if let Some(key) = weights.of_the_paper_alone() {
        return Err(misplaced(&format!("weights.{key}"), &"...", here));
    }
    let group = |key: &str, value: Option<[f64; 3]>| {
        let value = value.ok_or_else(|| missing(&format!("weights.{key}"), here, "three numbers, [x, y, z]"))?;
        value.iter().try_for_each(|entry| weight(key, *entry)).map(|()| value)
    };
    let command = weights.force_input.ok_or_else(|| missing("weights.force_input", here, "a number"))?;
    weight("force_input", command)?;
    Ok(Problem::ActuatorAware {
        motor_lag_s: 1e-3 * lag_ms,
        weights: ActuatorAwareWeights {
            position: group("position", weights.position)?,
            velocity: group("velocity", weights.velocity)?,
            rotation: group("rotation", weights.rotation)?,
            body_rates: group("body_rates", weights.body_rates)?,
            force: 0.0,
            integral: group("position_integral", weights.position_integral)?,
            command,
        },
        region: RegionBounds {
            lag_s: lags_ms.map(|lag_ms| 1e-3 * lag_ms),
            mass_share: 1e-2 * mass_percent,
            inertia_share: 1e-2 * inertia_percent,
            delay_s: 1e-3 * delay_ms,
        },
    })
}

/// Keys that only a design for motors has.
pub(super) fn not_of_motors(file: &DesignFile, weights: &Weights) -> Result<(), GainsError> {
    let foreign: [(&str, bool); 5] = [
        ("motor_lag_ms", file.motor_lag_ms.is_some()),
        ("[region]", file.region.is_some()),
        ("weights.rotation", weights.rotation.is_some()),
        ("weights.body_rates", weights.body_rates.is_some()),
        ("weights.force_input", weights.force_input.is_some()),
    ];
    match foreign.iter().find(|(_, given)| *given) {
        Some((key, _)) => Err(misplaced(key, &"...", &file.method)),
        None => Ok(()),
    }
}
