//! A random craft with its flight: a seed in; scenario, truth and log out.

use nalgebra::Vector3;
use quatrack_design::model::GRAVITY_M_S2;
use quatrack_plan::trajectory::fifth_order::{FifthOrder, FlatTrajectory};
use quatrack_simulation::scenario::course::Flown;
use quatrack_simulation::scenario::file::ScenarioFile;
use quatrack_simulation::scenario::{Recording, Scenario};
use quatrack_simulation::vehicles;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

use super::Conditions;

/// The true figures of a craft.
pub(super) struct Craft {
    pub(super) scenario: Scenario,
    pub(super) flown: Flown,
    /// Names and true values of figures.
    pub(super) truth: Vec<(&'static str, f64)>,
    pub(super) mass_kg: f64,
    /// By how much commands, inertial sensors and pose are logged late, s.
    pub(super) late_s: [f64; 3],
    pub(super) phase: f64,
}

struct Dice(ChaCha8Rng);

impl Dice {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

impl Craft {
    pub(super) fn random(seed: u64, conditions: &Conditions) -> Self {
        let mut dice = Dice(ChaCha8Rng::seed_from_u64(seed));
        let name = ["crazyflie-2.1", "crazyflie-2.1-brushless"][(seed % 2) as usize];
        let vehicle = vehicles::by_name(name).unwrap();
        let motors = vehicle.motors();
        let (mass_factor, inertia_factor) = (dice.between(0.92, 1.08), dice.between(0.75, 1.35));
        let (lag_ms, delay_ms) = (dice.between(30.0, 110.0), dice.between(0.0, 8.0));
        let drag = [dice.between(0.25, 0.7), dice.between(0.25, 0.7), dice.between(0.2, 0.6)];
        // As the inertia allows: 10 to 25 rad/s^2 a m/s.
        let inertia = [0, 1].map(|k| inertia_factor * vehicle.inertia_kg_m2()[(k, k)]);
        let moment = [0, 1].map(|k| dice.between(10.0, 25.0) * inertia[k]);
        let thrust_factor = dice.between(0.95, 1.1);
        let (gust, gyro, force) = (dice.between(0.02, 0.12), dice.between(0.003, 0.02), dice.between(0.03, 0.2));
        let position = dice.between(0.0005, 0.003);
        let charge = dice.between(0.6, 1.0);
        let biases: Vec<f64> = (0..8).map(|_| dice.between(-1.0, 1.0)).collect();
        let speed = dice.between(1.2, 2.2);
        let late_s = [0, 1, 2].map(|_| if conditions.delays { 1e-3 * dice.between(0.0, 20.0) } else { 0.0 });
        let on_battery = conditions.battery && seed.is_multiple_of(4);
        let told_lag_ms = lag_ms * dice.between(0.85, 1.15);
        let mass_kg = mass_factor * vehicle.mass_kg();
        let phase = dice.between(0.0, 1.0);
        let mut text = format!(
            "vehicle = \"{name}\"\nseed = {seed}\ncourse = \"hover\"\n[air]\ndrag_per_s = {drag:?}\nmoment_n_m_per_m_s = {moment:?}\n"
        );
        if conditions.noise {
            text += &format!(
                "gust_rms_m_s = {gust}\n[noise]\ngyro_rad_s = {gyro}\naccelerometer_m_s2 = {force}\nposition_m = {position}\n"
            );
        }
        text += &format!(
            "[errors]\nlag_ms = {lag_ms}\ndelay_ms = {delay_ms}\nmass_factor = {mass_factor}\ninertia_factor = {inertia_factor}\nthrust_factor = {thrust_factor}\n"
        );
        if conditions.noise {
            let [a, b, c, d, e, f, g, h] = biases[..] else { unreachable!("eight were drawn") };
            text += &format!(
                "gyro_bias_rad_s = [{}, {}, {}]\naccelerometer_bias_m_s2 = [{}, {}, {}]\ntorque_bias_n_m = [{}, {}]\n",
                0.01 * a,
                0.01 * b,
                0.01 * c,
                0.1 * d,
                0.1 * e,
                0.1 * f,
                5e-5 * g,
                5e-5 * h
            );
        }
        text += &format!("[told]\nlag_ms = {told_lag_ms}\nmass_kg = {mass_kg}\n");
        if on_battery {
            text += &format!("[battery]\ncharge = {charge}\n");
        }
        if conditions.estimator {
            // A log begins at any moment between two predictions of the filter.
            text += &format!("[filter]\nphase_ms = {}\n", (10.0 * phase).floor());
        }
        let head = if conditions.estimator { "estimator = \"kalman\"\n" } else { "" };
        let file = ScenarioFile::parse(&format!("{head}{text}"), "study").unwrap();
        let scenario = Scenario::checked(&file, "study", std::path::Path::new("")).unwrap();
        // The file's drag is over the vehicle's mass.
        let over = 1.0 / mass_factor;
        let full_n = thrust_factor
            * match (&vehicle.flown().force, on_battery) {
                (Some(force), true) => force.full_n,
                _ => motors.thrust_max_n,
            };
        // Without a battery the plant's force is in proportion to its command.
        let command_power =
            vehicle.flown().force.as_ref().filter(|_| on_battery).map_or(1.0, |force| force.command_power);
        let hover = (0.25 * mass_kg * GRAVITY_M_S2 / full_n).powf(1.0 / command_power);
        let truth = vec![
            ("lag_ms", lag_ms),
            ("delay_ms", delay_ms + 1e3 * (late_s[1] - late_s[0])),
            ("inertia_x_kg_m2", inertia[0]),
            ("inertia_y_kg_m2", inertia[1]),
            ("inertia_z_kg_m2", inertia_factor * vehicle.inertia_kg_m2()[(2, 2)]),
            ("drag_x_per_s", drag[0] * over),
            ("drag_y_per_s", drag[1] * over),
            ("moment_x_n_m_per_m_s", moment[0]),
            ("moment_y_n_m_per_m_s", moment[1]),
            ("thrust_full_n", full_n),
            ("command_power", command_power),
            ("hover_command", hover),
        ];
        let mut corners = Vec::new();
        for _ in 0..20 {
            let at = corners.last().copied().unwrap_or(Vector3::zeros());
            let mut next = at;
            while (next - at).norm() < 0.3 {
                let place: Vector3<f64> =
                    Vector3::from_fn(|k, _| if k < 2 { 0.3 } else { 0.15 } * dice.between(-1.0, 1.0).signum());
                next = place;
            }
            corners.push(next);
        }
        let eight = Flown::eight(speed, 25.0).course;
        let flown = Flown { course: Box::new(Course { corners, eight }), measured_from_s: 0.0 };
        Self { scenario, flown, truth, mass_kg, late_s, phase }
    }

    /// Its flight.
    pub(super) fn fly(&self) -> Recording {
        let mut law = self.scenario.law.start(&self.scenario.vehicle, &self.scenario.told).unwrap();
        self.scenario.record(law.as_mut(), &self.flown).unwrap()
    }

    /// As a log: a row for each stream, by its own clock.
    pub(super) fn log(&self, recording: &Recording) -> String {
        let most_n = self.scenario.vehicle.motors().thrust_max_n;
        let mut text = String::from("t,px,py,pz,vx,vy,vz,qx,qy,qz,qw,gx,gy,gz,ax,ay,az,m1,m2,m3,m4,v\n");
        let mut rows: Vec<(f64, String)> = Vec::new();
        for row in recording.log_rows(most_n) {
            let known = &row.estimate;
            let q = known.attitude.quaternion();
            let join = |values: &[f64]| values.iter().map(|v| format!("{v:.7}")).collect::<Vec<_>>().join(",");
            let pose = [known.position_m.as_slice(), known.velocity_m_s.as_slice(), &[q.i, q.j, q.k, q.w]].concat();
            let inertial = [known.body_rates_rad_s.as_slice(), known.specific_force_m_s2.as_slice()].concat();
            let motors = row.commands.map(|u| (65535.0 * u.clamp(0.0, 1.0)).round() / 65535.0);
            let volts = row.voltage.map_or(String::new(), |v| format!("{v:.4}"));
            let [t_motors, t_inertial, t_pose] = self.late_s.map(|late| row.time_s + late);
            rows.push((t_pose, format!("{}{}", join(&pose), ",".repeat(11))));
            rows.push((t_inertial, format!("{}{}{}", ",".repeat(10), join(&inertial), ",".repeat(5))));
            rows.push((t_motors, format!("{}{},{volts}", ",".repeat(16), join(&motors))));
        }
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (time_s, row) in rows {
            text += &format!("{time_s:.5},{row}\n");
        }
        text
    }
}

/// Hover, steps between corners of a box, one a second, then an eight.
struct Course {
    corners: Vec<Vector3<f64>>,
    eight: Box<dyn FlatTrajectory>,
}

const HOVER_S: f64 = 8.0;

impl FlatTrajectory for Course {
    fn duration_s(&self) -> f64 {
        HOVER_S + self.corners.len() as f64 + 2.0 + self.eight.duration_s()
    }

    fn at(&self, t_s: f64) -> FifthOrder {
        let middle = Vector3::new(0.0, 0.0, 1.0);
        let steps = t_s - HOVER_S;
        let eight = steps - self.corners.len() as f64 - 2.0;
        if eight >= 0.0 {
            return self.eight.at(eight);
        }
        let corner = if steps >= 0.0 { self.corners.get(steps as usize) } else { None };
        FifthOrder::at_rest(middle + corner.copied().unwrap_or_default(), 0.0)
    }
}
