//! A flight with surroundings and estimates, row by row; CSV with named columns and units out.

use std::fmt::Write as _;

use nalgebra::{UnitQuaternion, Vector3, Vector4};

use crate::control_law::Estimate;
use crate::flight::rigid_loop::{RigidFlight, RigidSample};
use crate::plant::Plant;

/// Surroundings of a craft and its law's estimate, as a row was taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Around {
    /// Velocity of the air, world frame, m/s.
    pub wind_m_s: Vector3<f64>,
    /// Least and most thrust of each motor, N.
    pub thrust_limits_n: [Vector4<f64>; 2],
    /// The estimate that the law was told.
    pub estimate: Estimate,
    /// Voltage at the motors, V; 0 where nothing depends on it.
    pub voltage_v: f64,
}

impl Around {
    /// The surroundings of a plant as it is now.
    pub(super) fn of(plant: &Plant, estimate: Estimate) -> Self {
        Self {
            wind_m_s: *plant.wind_m_s(),
            thrust_limits_n: plant.thrust_limits_n(),
            estimate,
            voltage_v: plant.voltage_v(),
        }
    }
}

/// A flight with surroundings and estimates.
#[derive(Clone, Debug)]
pub struct Recording {
    /// The flight.
    pub flight: RigidFlight,
    /// One for each of its samples.
    pub around: Vec<Around>,
    /// Root mean square of the turbulence that came of the flight's gusts, along the mean wind, across it and upwards, m/s;
    /// absent without gusts.
    pub gust_rms_m_s: Option<Vector3<f64>>,
    /// Of a flight that was lost before anything was measured, the rows from its start until then; of any other none.
    pub before: Vec<(RigidSample, Around)>,
}

/// Names of position, velocity, attitude and body rates.
const STATE: [&str; 13] =
    ["x_m", "y_m", "z_m", "v_x_m_s", "v_y_m_s", "v_z_m_s", "q_w", "q_x", "q_y", "q_z", "p_rad_s", "q_rad_s", "r_rad_s"];

impl Recording {
    /// The rows that pictures and logs show: those that were measured, or all until the craft was lost where nothing was.
    pub fn shown(&self) -> Vec<(RigidSample, Around)> {
        let measured = self.flight.samples.iter().copied().zip(self.around.iter().copied());
        self.before.iter().copied().chain(measured).collect()
    }

    /// As CSV: time, where the craft was to be (`ref_...`), where it was, its law's estimate (`est_...`), commands and
    /// thrusts of the motors with the thrusts' limits, and the wind.
    pub fn to_csv(&self) -> String {
        let mut names: Vec<String> = ["t_s", "ref_x_m", "ref_y_m", "ref_z_m"].map(str::to_owned).to_vec();
        names.extend(STATE.map(str::to_owned));
        names.extend(STATE.map(|name| format!("est_{name}")));
        for column in ["command", "thrust", "thrust_min", "thrust_max"] {
            names.extend((1..=4).map(|motor| format!("{column}_{motor}_n")));
        }
        names.extend(["wind_x_m_s", "wind_y_m_s", "wind_z_m_s"].map(str::to_owned));
        let mut text = names.join(",");
        text.push('\n');
        for (sample, around) in &self.shown() {
            let (s, e, [least_n, most_n]) = (&sample.state, &around.estimate, &around.thrust_limits_n);
            let truth = state(&s.position_m, &s.velocity_m_s, &s.attitude, &s.body_rates_rad_s);
            let estimate = state(&e.position_m, &e.velocity_m_s, &e.attitude, &e.body_rates_rad_s);
            let motors =
                [&sample.commands_n, &s.thrusts_n, least_n, most_n].into_iter().flat_map(|forces| forces.iter());
            // Writing to a string does not fail.
            let _ = write!(text, "{:.3}", sample.time_s);
            let values =
                sample.target_m.iter().chain(&truth).chain(&estimate).chain(motors).chain(around.wind_m_s.iter());
            for value in values {
                let _ = write!(text, ",{value:.9}");
            }
            text.push('\n');
        }
        text
    }
}

/// In the order of [`STATE`].
fn state(
    position_m: &Vector3<f64>,
    velocity_m_s: &Vector3<f64>,
    attitude: &UnitQuaternion<f64>,
    body_rates_rad_s: &Vector3<f64>,
) -> [f64; 13] {
    let ([x, y, z], [u, v, w], [p, q, r]) = ((*position_m).into(), (*velocity_m_s).into(), (*body_rates_rad_s).into());
    let turn = attitude.quaternion();
    [x, y, z, u, v, w, turn.w, turn.i, turn.j, turn.k, p, q, r]
}
