//! Figures with their 95 % intervals: a posterior, regressions and biases in; each figure told, or refused with the manoeuvre
//! that would tell it, out.

use std::collections::BTreeMap;

use nalgebra::DVector;
use quatrack_design::model::GRAVITY_M_S2;

use super::BLOCK_S;
use super::bootstrap::Dice;
use super::drag::Regression;
use super::estimate::{Estimate, interval, told};
use super::layout::{
    ASYMMETRY, COMMAND_POWER, DAMPING, DELAY, DRAG_Z, INERTIA, LAG, LIFT, MOMENT, SHARED, VOLTAGE_POWER,
};
use super::model::FlightFit;
use super::posterior::Posterior;
use super::prior::Base;
use super::problem::Prepared;
use super::yaw::Yaw;
use crate::filter::mean;
use crate::flight::STEP_S;

/// Every figure of a craft, told with an interval or refused with a manoeuvre.
pub(super) struct Figures<'a> {
    base: &'a Base,
    pub(super) all: BTreeMap<&'static str, Result<Estimate, String>>,
    spread: f64,
    steeper: f64,
}

/// Share of the torques about an axis that has to be explained before anything is told of them: less, and the flight is at rest, or its
/// columns are not what the map says.
const TORQUES_LEAST: f64 = 0.5;

/// Least effective number of blocks that tell of a figure: one alone shows no spread.
const BLOCKS_LEAST: f64 = 1.5;

pub(super) const EVERY_STEP: &str = "log every control step";
pub(super) const STEPS: &str = "fly 20 s of steps between corners, which turn the craft fast";
const SPEED: &str = "fly 30 s at 1 m/s and more in both directions";
const CLIMBS: &str = "fly climbs and drops of 0.5 m and more, as fast as they go";
const DISCHARGE: &str = "log the battery's voltage over a few minutes, or two flights, one with a full battery";
const TURNS: &str = "turn the heading by 90 degrees and back, fast, a few times";

impl<'a> Figures<'a> {
    /// None yet. `spread`: by how much intervals of few blocks are wider than those of many; `steeper`: by how much the force may grow
    /// faster with the command than the fit has it.
    pub(super) fn new(base: &'a Base, spread: f64, steeper: f64) -> Self {
        Self { base, all: BTreeMap::new(), spread, steeper }
    }

    fn put(&mut self, name: &'static str, value: f64, draws: &[f64], most: f64, manoeuvre: &str) {
        self.all.insert(name, told(name, value, draws, self.spread, most, manoeuvre));
    }

    /// A figure that goes with the slope of force over command, and is larger by a factor where that is as steep as it may be: the middle
    /// of both by ratio, in an interval that holds both.
    fn put_by_slope(&mut self, name: &'static str, value: f64, draws: &[f64], most: f64, factor: f64, manoeuvre: &str) {
        self.put(name, value, draws, most, manoeuvre);
        let Some(Ok(estimate)) = self.all.get_mut(name) else { return };
        let more = (factor - 1.0) * value;
        estimate.low += more.min(0.0);
        estimate.high += more.max(0.0);
        estimate.value *= factor.sqrt();
        if more.abs() > most {
            let reason = format!(
                "it may be {factor:.2} times as large, since the commands of this log are noisy: {EVERY_STEP}, and {CLIMBS}"
            );
            self.all.insert(name, Err(reason));
        }
    }

    /// Refuses some.
    pub(super) fn refuse(&mut self, reasons: Vec<(&'static str, String)>) {
        self.all.extend(reasons.into_iter().map(|(name, reason)| (name, Err(reason))));
    }

    /// Refuses a figure that one block of the flight tells alone.
    fn repeated(&mut self, posterior: &Posterior, name: &'static str, j: usize, manoeuvre: &str) {
        if posterior.effective_blocks(j) < BLOCKS_LEAST {
            let reason = format!("one stretch of {BLOCK_S} s alone tells it, which shows no spread: {manoeuvre}");
            self.all.insert(name, Err(reason));
        }
    }

    /// Refuses a figure that the prior tells, or one block, and not the flight.
    fn excited(&mut self, posterior: &Posterior, name: &'static str, j: usize, most: f64, manoeuvre: &str) {
        self.repeated(posterior, name, j, manoeuvre);
        let by_data = 1.96 * posterior.by_data(j);
        if by_data > most {
            let reason = format!("this flight does not tell it, at most +-{most:.2e} at 95 % would: {manoeuvre}");
            self.all.insert(name, Err(reason));
        }
    }

    /// Refuses what torques tell about axes whose torques are not explained.
    pub(super) fn turning(&mut self, explained: [f64; 3], yaw: f64) {
        let shares = [("x", explained[0]), ("y", explained[1]), ("z", yaw)];
        for (axis, share) in shares.into_iter().filter(|(_, share)| *share < TORQUES_LEAST) {
            let manoeuvre = if axis == "z" { TURNS } else { STEPS };
            let names = self.all.keys().filter(|name| {
                let turns = ["inertia_", "moment_", "rate_damping_"].iter().any(|start| name.starts_with(start));
                turns && name.split('_').any(|part| part == axis) || axis == "z" && name.starts_with("rotor_")
            });
            for name in names.copied().collect::<Vec<_>>() {
                let reason = format!(
                    "the motors explain {share:.2} of the torque about {axis}, {TORQUES_LEAST} is the least: {manoeuvre}"
                );
                self.all.insert(name, Err(reason));
            }
        }
        if explained[0].max(explained[1]) < TORQUES_LEAST {
            for name in ["lag_ms", "lag_rise_ms", "lag_fall_ms", "delay_ms"] {
                let reason = format!("the motors explain less than {TORQUES_LEAST} of the torques: {STEPS}");
                self.all.insert(name, Err(reason));
            }
        }
    }

    pub(super) fn refined(&mut self, posterior: &Posterior, voltage: bool) {
        let Posterior { values, draws, .. } = posterior;
        let of = |f: &dyn Fn(&DVector<f64>) -> f64| -> (f64, Vec<f64>) { (f(values), draws.iter().map(f).collect()) };
        let flights = values.len() - SHARED;
        let (mass, steeper) = (self.base.mass_kg, self.steeper);
        let (lag, all) = of(&|v| 1e3 * v[LAG].exp());
        self.put("lag_ms", lag, &all, 0.3 * lag, STEPS);
        self.excited(posterior, "lag_ms", LAG, 0.4, STEPS);
        let (delay, all) = of(&|v| 1e3 * v[DELAY]);
        self.put("delay_ms", delay, &all, 8.0, STEPS);
        // The course of a command between two samples is not in the log: half a sample to either side.
        if let Some(Ok(delay)) = self.all.get_mut("delay_ms") {
            delay.low -= 500.0 * STEP_S;
            delay.high += 500.0 * STEP_S;
        }
        let (power, all) = of(&|v| v[COMMAND_POWER]);
        self.put_by_slope("command_power", power, &all, 0.3, steeper, CLIMBS);
        self.excited(posterior, "command_power", COMMAND_POWER, 0.5, CLIMBS);
        if voltage {
            let (power, all) = of(&|v| v[VOLTAGE_POWER]);
            self.put("voltage_power", power, &all, 0.4, DISCHARGE);
            self.excited(posterior, "voltage_power", VOLTAGE_POWER, 0.5, DISCHARGE);
        } else {
            self.all.insert("voltage_power", Err(format!("the log has no voltage: {DISCHARGE}")));
        }
        let full = |v: &DVector<f64>| (SHARED..v.len()).map(|j| v[j]).sum::<f64>() / flights as f64;
        let (per_mass, mut all) = of(&|v| full(v).exp());
        self.between_flights(values, &mut all);
        // Hover is told by itself: a full command gives by the power more.
        let fuller = (per_mass / GRAVITY_M_S2).max(1.0).powf(steeper - 1.0);
        self.put_by_slope("thrust_per_mass_m_s2", per_mass, &all, 0.2 * per_mass, fuller, CLIMBS);
        let newton: Vec<f64> = all.iter().map(|a| 0.25 * mass * a).collect();
        self.put_by_slope("thrust_full_n", 0.25 * mass * per_mass, &newton, 0.05 * mass * per_mass, fuller, CLIMBS);
        // A full command is not flown: what it gives is what the power makes of the thrust at hover.
        if self.all.get("command_power").is_none_or(Result::is_err) {
            for name in ["thrust_per_mass_m_s2", "thrust_full_n"] {
                self.all.insert(
                    name,
                    Err(format!("the power of the command is not told, by which it follows from hover: {CLIMBS}")),
                );
            }
        }
        // At the reference voltage.
        let hover = |v: &DVector<f64>| (GRAVITY_M_S2 / full(v).exp()).powf(1.0 / v[COMMAND_POWER]);
        let (command, all) = of(&hover);
        self.put("hover_command", command, &all, 0.1, CLIMBS);
        let (drag, all) = of(&|v| v[DRAG_Z]);
        self.put("drag_z_per_s", drag, &all, 0.2, CLIMBS);
        let (lift, all) = of(&|v| v[LIFT]);
        self.put("lift_per_m", lift, &all, 0.05, SPEED);
        for (axis, [inertia, moment, damping]) in [
            ["inertia_x_kg_m2", "moment_x_n_m_per_m_s", "rate_damping_x_n_m_s"],
            ["inertia_y_kg_m2", "moment_y_n_m_per_m_s", "rate_damping_y_n_m_s"],
        ]
        .into_iter()
        .enumerate()
        {
            let (value, all) = of(&|v| v[INERTIA[axis]].exp());
            self.put_by_slope(inertia, value, &all, 0.2 * value, steeper, STEPS);
            self.excited(posterior, inertia, INERTIA[axis], 0.3, STEPS);
            let (value, all) = of(&|v| v[MOMENT[axis]]);
            let most = (0.25 * value.abs()).max(2e-3 * self.base.half_arm_m * self.base.mass_kg);
            self.put_by_slope(moment, value, &all, most, steeper, SPEED);
            self.repeated(posterior, moment, MOMENT[axis], SPEED);
            let (value, all) = of(&|v| v[DAMPING[axis]]);
            self.put_by_slope(damping, value, &all, 0.4 * self.base.damping_scale(), steeper, STEPS);
        }
    }

    /// Batteries and motors differ from flight to flight: the uncertainty of the mean of all of them.
    fn between_flights(&self, values: &DVector<f64>, draws: &mut [f64]) {
        let logs: Vec<f64> = values.iter().skip(SHARED).copied().collect();
        let deviation = (variance(&logs) / (logs.len().max(2) - 1) as f64).sqrt();
        let mut dice = Dice::new();
        draws.iter_mut().for_each(|draw| *draw *= (deviation * dice.normal()).exp());
    }

    /// Rise and fall, where the flights tell them apart.
    pub(super) fn apart(&mut self, sections: &[Prepared], base: &Base, one: &Posterior, voltage: bool) {
        let fixed = if voltage { Vec::new() } else { vec![VOLTAGE_POWER] };
        let Some(refined) = one.again(sections, base, &fixed) else { return };
        let draws = &refined.draws;
        let asymmetry =
            interval(refined.values[ASYMMETRY], &draws.iter().map(|v| v[ASYMMETRY]).collect::<Vec<_>>(), self.spread);
        for (name, sign) in [("lag_rise_ms", 0.5), ("lag_fall_ms", -0.5)] {
            let of = |v: &DVector<f64>| 1e3 * (v[LAG] + sign * v[ASYMMETRY]).exp();
            let value = of(&refined.values);
            let all: Vec<f64> = draws.iter().map(of).collect();
            self.put(name, value, &all, 0.3 * value, STEPS);
            if asymmetry.low <= 0.0 && asymmetry.high >= 0.0 {
                self.all.insert(name, Err(format!("rise and fall are not told apart, lag_ms is for both: {STEPS}")));
            }
        }
    }

    pub(super) fn drag(&mut self, drags: &[Regression; 2]) {
        for (name, regression) in ["drag_x_per_s", "drag_y_per_s"].into_iter().zip(drags) {
            let value = regression.values[0];
            let all: Vec<f64> = regression.draws().iter().map(|v| v[0]).collect();
            self.put(name, value, &all, (0.25 * value.abs()).max(0.05), SPEED);
        }
    }

    pub(super) fn yaw(&mut self, yaws: &Yaw) {
        const ROTORS: &str = "rotor_inertia_kg_m2";
        let Some([least, most]) = yaws.bracket() else {
            let reason = format!("torque by motion and motion by torque give {} about z: {TURNS}", yaws.told());
            for name in ["inertia_z_kg_m2", "rate_damping_z_n_m_s", "rotor_lead_ms", ROTORS] {
                self.all.insert(name, Err(reason.clone()));
            }
            return;
        };
        let draws = yaws.forward.draws();
        let values = &yaws.forward.values;
        let column = |j: usize, factor: f64| -> Vec<f64> { draws.iter().map(|v| factor * v[j]).collect() };
        // The middle of both by ratio; the interval holds both.
        let inertia = (least * most).sqrt();
        let name = "inertia_z_kg_m2";
        self.put_by_slope(name, inertia, &column(0, inertia / values[0]), 0.25 * inertia, self.steeper, TURNS);
        if let Some(Ok(estimate)) = self.all.get_mut(name) {
            (estimate.low, estimate.high) = (estimate.low.min(least), estimate.high.max(most));
        }
        let most = 0.4 * self.base.damping_scale();
        self.put_by_slope("rate_damping_z_n_m_s", values[1], &column(1, 1.0), most, self.steeper, TURNS);
        self.put("rotor_lead_ms", 1e3 * values[2], &column(2, 1e3), 15.0, TURNS);
        let Some(thrust_n_s2) = self.base.thrust_n_s2 else {
            let reason =
                format!("{} has no thrust_n_s2 in [propeller], which turns a lead into an inertia", self.base.name);
            self.all.insert(ROTORS, Err(reason));
            return;
        };
        // J_r = 2 k W kappa L, with W the speed at hover.
        let speed = (0.25 * self.base.mass_kg * GRAVITY_M_S2 / thrust_n_s2).sqrt();
        let factor = 2.0 * thrust_n_s2 * speed * self.base.torque_per_thrust_m;
        self.put(ROTORS, factor * values[2], &column(2, factor), 0.4 * (factor * values[2]).abs(), TURNS);
    }

    pub(super) fn biases(&mut self, flights: &[FlightFit]) {
        let of = |f: &dyn Fn(&FlightFit) -> f64| -> Estimate {
            let all: Vec<f64> = flights.iter().map(f).collect();
            let value = mean(&all);
            let deviation = (variance(&all) * all.len() as f64 / (all.len().max(2) - 1) as f64).sqrt();
            Estimate { value, low: value - 1.96 * deviation, high: value + 1.96 * deviation }
        };
        let one = "one flight does not tell a bias from its change: give more flights";
        for (axis, names) in [
            ["torque_bias_x_n_m", "gyro_bias_x_rad_s", "accelerometer_bias_x_m_s2"],
            ["torque_bias_y_n_m", "gyro_bias_y_rad_s", "accelerometer_bias_y_m_s2"],
            ["torque_bias_z_n_m", "gyro_bias_z_rad_s", "accelerometer_bias_z_m_s2"],
        ]
        .into_iter()
        .enumerate()
        {
            let all = [
                of(&|flight| flight.torque_bias_n_m[axis]),
                of(&|flight| flight.gyro_bias_rad_s[axis]),
                of(&|flight| flight.force_bias_m_s2[axis]),
            ];
            for (name, estimate) in names.into_iter().zip(all) {
                self.all.insert(name, if flights.len() > 1 { Ok(estimate) } else { Err(one.to_owned()) });
            }
        }
    }
}

fn variance(signal: &[f64]) -> f64 {
    let m = mean(signal);
    mean(&signal.iter().map(|v| (v - m).powi(2)).collect::<Vec<_>>())
}
