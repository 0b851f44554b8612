//! The figures as a vehicle file: each with its interval and source; a figure that was not identified is the base
//! vehicle's.

use std::fmt::Write as _;

use quatrack_design::vehicle::{Vehicle, VehicleFile};

use crate::IdentifyError;
use crate::fit::{Estimate, Fit};

/// Longest name of a vehicle in a gain table, bytes.
const LONGEST_NAME: usize = 31;

/// TOML that `quatrack gains design` and `--vehicle` take: it has been read back.
///
/// # Errors
/// [`IdentifyError::Vehicle`] where no vehicle has such figures.
pub fn vehicle_toml(fit: &Fit, vehicle: &Vehicle, logs: &[String]) -> Result<String, IdentifyError> {
    let text = written(fit, vehicle, logs);
    let read: Result<VehicleFile, _> = toml::from_str(&text);
    let file = read.map_err(|error| IdentifyError::Vehicle(error.message().to_owned()))?;
    Vehicle::try_from(file).map_err(|error| IdentifyError::Vehicle(error.to_string()))?;
    Ok(text)
}

fn written(fit: &Fit, vehicle: &Vehicle, logs: &[String]) -> String {
    let mut text = String::new();
    let of = |name: &str| fit.figures.get(name).and_then(|figure| figure.as_ref().ok());
    let source = format!("quatrack identify, {} log{}", logs.len(), if logs.len() == 1 { "" } else { "s" });
    let told = |estimate: &Estimate, scale: f64| {
        format!("# {source}; 95 %: {} to {}.", figure(scale * estimate.low), figure(scale * estimate.high))
    };
    let kept = |why: &str| format!("# Of {}: {why}.", vehicle.name());
    let mut line = |part: &str| {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{part}");
    };
    let base = vehicle.inertia_kg_m2();
    let motors = vehicle.motors();
    line(&format!("# Identified from {}.", logs.join(", ")));
    line(&format!("# Figures that the flights do not show are those of {}.", vehicle.name()));
    line(&format!("name = \"{}\"", name(vehicle.name())));
    line("\n[body]");
    line("# As it was given: weigh it as it flies, with battery and decks.");
    line(&format!("mass_kg = {}", figure(fit.base.mass_kg)));
    let names = ["inertia_x_kg_m2", "inertia_y_kg_m2", "inertia_z_kg_m2"];
    let known: Vec<f64> = (0..3).filter_map(|k| of(names[k]).map(|estimate| estimate.value / base[(k, k)])).collect();
    let ratio = if known.is_empty() { 1.0 } else { crate::filter::mean(&known) };
    let mut inertia = [0, 1, 2].map(|k| of(names[k]).map_or(ratio * base[(k, k)], |estimate| estimate.value));
    // A body's largest moment is at most the sum of the others.
    let most = 0.999 * (inertia[0] + inertia[1]);
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        match of(names[k]) {
            Some(estimate) => {
                line(&format!(
                    "# About {axis}: {source}; 95 %: {} to {}.",
                    figure(estimate.low),
                    figure(estimate.high)
                ));
            }
            None => line(&format!("# About {axis}: that of {}, in proportion to the known axes.", vehicle.name())),
        }
    }
    inertia[2] = inertia[2].min(most);
    line("inertia_kg_m2 = [");
    line(&format!("    [{}, 0.0, 0.0],", figure(inertia[0])));
    line(&format!("    [0.0, {}, 0.0],", figure(inertia[1])));
    line(&format!("    [0.0, 0.0, {}],", figure(inertia[2])));
    line("]");
    line("\n[motors]");
    line(&kept("arm, limits of the command and torque per thrust are not identified"));
    line(&format!("arm_m = {}", figure(motors.arm_m)));
    line(&format!("thrust_min_n = {}", motors.thrust_min_n));
    line(&format!("thrust_max_n = {}", motors.thrust_max_n));
    line(&format!("torque_per_thrust_m = {}", motors.torque_per_thrust_m));
    let lag = of("lag_ms");
    line(&lag.map_or_else(|| kept("no lag was told"), |lag| told(lag, 1e-3)));
    let lag_s = lag.map_or(motors.lag_s, |lag| 1e-3 * lag.value);
    line(&format!("lag_s = {}", figure(lag_s)));
    let [shortest, longest] =
        lag.map_or(motors.published_lag_s, |lag| [lag.low, lag.high].map(|ms| 1e-3 * ms.max(1.0)));
    line(if lag.is_some() { "# The ends of that interval." } else { "# The published ones." });
    line(&format!("published_lag_s = [{}, {}]", figure(shortest), figure(longest)));
    if let (Some(lag), Some(delay)) = (lag, of("delay_ms")) {
        line("\n[motors.flown]");
        line(&told(delay, 1e-3).replace("95 %:", "delay, 95 %:"));
        let (rise, fall) = (of("lag_rise_ms").unwrap_or(lag), of("lag_fall_ms").unwrap_or(lag));
        line(&format!("rise_lag_s = {}", figure(1e-3 * rise.value)));
        line(&format!("fall_lag_s = {}", figure(1e-3 * fall.value)));
        line(&format!("delay_s = {}", figure(1e-3 * delay.value.max(0.0))));
    }
    if let (Some(full), Some(power)) = (of("thrust_full_n"), of("command_power")) {
        line("\n[motors.force]");
        line(&told(full, 1.0));
        line(&format!("full_n = {}", figure(full.value)));
        line(&told(power, 1.0));
        line(&format!("command_power = {}", figure(power.value)));
        match of("voltage_power") {
            Some(power) => line(&told(power, 1.0)),
            None => line(&kept("no change of the voltage told more")),
        }
        let voltage = of("voltage_power").map_or(fit.base.powers[1], |power| power.value);
        line(&format!("voltage_power = {}", figure(voltage)));
        line(&format!("reference_v = {}", figure(fit.base.reference_v)));
    }
    if let (Some(x), Some(y), Some(moment_x), Some(moment_y)) =
        (of("drag_x_per_s"), of("drag_y_per_s"), of("moment_x_n_m_per_m_s"), of("moment_y_n_m_per_m_s"))
    {
        line("\n[air]");
        line(&format!("mass_kg = {}", figure(fit.base.mass_kg)));
        line(&told(x, 1.0).replace("95 %:", "along x, 95 %:"));
        line(&told(y, 1.0).replace("95 %:", "along y, 95 %:"));
        line(&format!("drag_per_s = [{}, {}]", figure(x.value.max(0.0)), figure(y.value.max(0.0))));
        if let Some(z) = of("drag_z_per_s") {
            line(&told(z, 1.0));
            line(&format!("drag_z_per_s = {}", figure(z.value.max(0.0))));
        }
        line(&told(moment_x, 1.0).replace("95 %:", "about x, 95 %:"));
        line(&told(moment_y, 1.0).replace("95 %:", "about y, 95 %:"));
        line(&format!("moment_n_m_per_m_s = [{}, {}]", figure(moment_x.value), figure(moment_y.value)));
        if let Some(lift) = of("lift_per_m") {
            line(&told(lift, 1.0));
            line(&format!("lift_per_m = {}", figure(lift.value)));
        }
    }
    if let Some(propeller) = &vehicle.flown().propeller {
        line("\n[propeller]");
        line(&kept("radius and thrust by speed are not identified"));
        line(&format!("radius_m = {}", propeller.radius_m));
        if let Some(thrust) = propeller.thrust_n_s2 {
            line(&format!("thrust_n_s2 = {thrust:e}"));
        }
        let inertia = of("rotor_inertia_kg_m2").map(|estimate| estimate.value).filter(|value| *value > 0.0);
        if let Some(estimate) = of("rotor_inertia_kg_m2") {
            line(&told(estimate, 1.0));
        }
        if let Some(inertia) = inertia.or(propeller.inertia_kg_m2) {
            line(&format!("inertia_kg_m2 = {inertia:e}"));
        }
    }
    if let Some(battery) = &vehicle.flown().battery {
        line("\n[battery]");
        line(&kept("not identified"));
        line(&format!("capacity_a_h = {}", battery.capacity_a_h));
        line(&format!("hover_s = {}", battery.hover_s));
        line(&format!("open_circuit_v = {:?}", battery.open_circuit_v));
        line(&format!("resistance_ohm = {}", battery.resistance_ohm));
    }
    line("\n[limits]");
    line(&kept("not identified"));
    let [p, q, r]: [f64; 3] = (*vehicle.body_rates_max_rad_s()).into();
    line(&format!("body_rates_rad_s = [{p:?}, {q:?}, {r:?}]"));
    line("\n# Every figure that the flights told: where it lies with a probability of 95 %, block bootstrap.");
    for (name, figure_of) in &fit.figures {
        if let Ok(Estimate { low, high, .. }) = figure_of {
            line(&format!("[identified.{name}]"));
            line(&format!("low = {}\nhigh = {}\nsource = \"{source}\"", figure(*low), figure(*high)));
        }
    }
    text
}

/// Five digits, as TOML has numbers.
fn figure(value: f64) -> String {
    if value == 0.0 {
        return "0.0".to_owned();
    }
    if (1e-3..1e4).contains(&value.abs()) {
        let decimals = (4 - value.abs().log10().floor() as i32).max(1) as usize;
        return format!("{value:.decimals$}");
    }
    format!("{value:.4e}")
}

fn name(base: &str) -> String {
    let room = LONGEST_NAME - "-own".len();
    format!("{}-own", base.chars().take(room).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_have_five_digits_and_are_numbers_of_toml() {
        let texts = [0.067, -12.345_678, 3.8e-4, 1.656_12e-5, 0.0, 4.0].map(figure);
        assert_eq!(texts, ["0.067000", "-12.346", "3.8000e-4", "1.6561e-5", "0.0", "4.0000"]);
        assert!(texts.iter().all(|text| toml::from_str::<toml::Table>(&format!("x = {text}")).is_ok()));
        assert_eq!(name("crazyflie-2.1-brushless-45g"), "crazyflie-2.1-brushless-45g-own");
        assert_eq!(name("a-name-of-more-letters-than-a-table-holds").len(), LONGEST_NAME);
    }
}
