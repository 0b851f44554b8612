//! Figures of regressions and of means over flights: drag, the yaw axis, biases.

use quatrack_design::model::GRAVITY_M_S2;

use super::{Figures, SPEED, TURNS, variance};
use crate::filter::mean;
use crate::fit::drag::Regression;
use crate::fit::estimate::Estimate;
use crate::fit::model::FlightFit;
use crate::fit::yaw::Yaw;

impl Figures<'_> {
    pub(in crate::fit) fn drag(&mut self, drags: &[Regression; 2]) {
        for (name, regression) in ["drag_x_per_s", "drag_y_per_s"].into_iter().zip(drags) {
            let value = regression.values[0];
            let all: Vec<f64> = regression.draws().iter().map(|v| v[0]).collect();
            self.put(name, value, &all, (0.25 * value.abs()).max(0.05), SPEED);
        }
    }

    pub(in crate::fit) fn yaw(&mut self, yaws: &Yaw) {
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

    pub(in crate::fit) fn biases(&mut self, flights: &[FlightFit]) {
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
