//! Figures of the posterior: lag, delay, powers, thrust, and what torques tell about the horizontal axes.

use nalgebra::DVector;
use quatrack_design::model::GRAVITY_M_S2;

use super::{CLIMBS, DISCHARGE, Figures, SPEED, STEPS, variance};
use crate::fit::bootstrap::Dice;
use crate::fit::estimate::interval;
use crate::fit::layout::{
    ASYMMETRY, COMMAND_POWER, DAMPING, DELAY, DRAG_Z, INERTIA, LAG, LIFT, MOMENT, SHARED, VOLTAGE_POWER,
};
use crate::fit::posterior::Posterior;
use crate::fit::prior::Base;
use crate::fit::problem::Prepared;
use crate::flight::STEP_S;

impl Figures<'_> {
    /// Every figure but rise and fall.
    pub(in crate::fit) fn refined(&mut self, posterior: &Posterior, voltage: bool) {
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
    pub(in crate::fit) fn apart(&mut self, sections: &[Prepared], base: &Base, one: &Posterior, voltage: bool) {
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
}
