//! A craft with identified figures, followed along a section and predicted from any point of it.

use nalgebra::{UnitQuaternion, Vector3};

use crate::filter::{lagged, shifted};
use crate::fit::{Base, Fit, FlightFit, Model};
use crate::flight::{STEP_S, Section};
use quatrack_design::model::GRAVITY_M_S2;
use quatrack_design::vehicle::{ROTOR_SIDES, ROTOR_TORQUE_SIGNS};

/// How far ahead, in steps of the grid.
pub const HORIZON: usize = 50;
/// From one start to the next, in steps.
pub(super) const BETWEEN: usize = 10;
/// Steps that the filters take before a start.
pub(super) const BEFORE: usize = 100;

#[derive(Clone, Copy)]
pub(super) struct State {
    pub(super) position: Vector3<f64>,
    pub(super) velocity: Vector3<f64>,
    pub(super) attitude: UnitQuaternion<f64>,
    pub(super) rates: Vector3<f64>,
}

/// How disturbances are followed and how they fade; had from the part that is learned from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Habits {
    /// Deviation of the disturbing angular acceleration over that of the gyroscope's noise, 1/s^2; steers the filter's gain.
    pub(super) gain: f64,
    /// How long a disturbing torque lasts, s.
    pub(super) torque_s: f64,
    /// How long a disturbing force does, s.
    pub(super) force_s: f64,
    /// Share of the angular acceleration by the figures that is believed: logged commands are noisy, and a flight is smooth.
    pub(super) share: f64,
    /// How fast a flown craft stops turning, beside the damping of its figures, 1/s.
    pub(super) rest_per_s: f64,
}

/// A section with its motors' thrusts, and the filters' estimates at each point.
pub(super) struct Track<'a> {
    section: &'a Section,
    thrusts_n: [Vec<f64>; 4],
    rates: Vec<Vector3<f64>>,
    disturbance: Vec<Vector3<f64>>,
    force: Vec<Vector3<f64>>,
}

pub(super) struct Craft<'a> {
    base: &'a Base,
    model: &'a Model,
    flight: &'a FlightFit,
}

impl<'a> Craft<'a> {
    /// The fitted craft on one of its flights.
    pub(super) fn of(fit: &'a Fit, flight: &'a FlightFit) -> Self {
        Self { base: &fit.base, model: &fit.model, flight }
    }

    fn thrusts_n(&self, section: &Section) -> [Vec<f64>; 4] {
        let drive = &self.model.drive;
        let [p, q] = drive.powers;
        let newton = 0.25 * self.base.mass_kg * self.flight.full_m_s2;
        section.commands.each_ref().map(|command| {
            let asked: Vec<f64> = (0..command.len())
                .map(|i| {
                    let voltage = section.voltage.get(i).map_or(1.0, |v| (v / self.base.reference_v).powf(q));
                    newton * command[i].powf(p) * voltage
                })
                .collect();
            lagged(&shifted(&asked, -drive.delay_s / STEP_S), drive.rise_s, drive.fall_s, STEP_S)
        })
    }

    /// Angular acceleration without disturbances, rad/s^2.
    fn angular(
        &self,
        thrusts: &[f64; 4],
        slopes: &[f64; 4],
        body: &Vector3<f64>,
        rates: &Vector3<f64>,
    ) -> Vector3<f64> {
        let m = self.model;
        let sum = |weights: [f64; 4], values: &[f64; 4]| (0..4).map(|k| weights[k] * values[k]).sum::<f64>();
        let arm = self.base.half_arm_m;
        let yaw = self.base.torque_per_thrust_m
            * (sum(ROTOR_TORQUE_SIGNS, thrusts) + m.yaw_lead_s * sum(ROTOR_TORQUE_SIGNS, slopes));
        let torque = Vector3::new(
            arm * sum(ROTOR_SIDES.map(|[_, y]| y), thrusts) + m.moment[0] * body.y,
            arm * sum(ROTOR_SIDES.map(|[x, _]| -x), thrusts) - m.moment[1] * body.x,
            yaw,
        ) + self.flight.torque_bias_n_m
            - rates.component_mul(&Vector3::from(m.damping))
            - rates.cross(&Vector3::from(m.inertia).component_mul(rates));
        torque.component_div(&Vector3::from(m.inertia))
    }

    /// Specific force, body frame, m/s^2.
    fn force(&self, thrusts: &[f64; 4], body: &Vector3<f64>) -> Vector3<f64> {
        let [x, y, z] = self.model.drag;
        let lift = self.model.lift * (body.x * body.x + body.y * body.y);
        let up = thrusts.iter().sum::<f64>() / self.base.mass_kg;
        Vector3::new(-x * body.x, -y * body.y, up + lift - z * body.z)
    }

    pub(super) fn track<'s>(&self, section: &'s Section, habits: &Habits) -> Track<'s> {
        let thrusts_n = self.thrusts_n(section);
        let body = section.body_velocity();
        let count = section.len();
        // Steady gains of a filter whose state is the rate and a disturbing acceleration that fades.
        let ratio = habits.gain * STEP_S;
        let fade = (-STEP_S / habits.torque_s).exp();
        let (mut rates, mut disturbance) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let mut force = Vec::with_capacity(count);
        let bias = self.flight.gyro_bias_rad_s;
        let (mut w, mut d, mut f) = (section.gyro[0] - bias, Vector3::zeros(), Vector3::zeros());
        let follow = ratio / (1.0 + ratio);
        let force_follow = 1.0 - (-STEP_S / 0.15_f64).exp();
        for i in 0..count {
            let now = |i: usize| [0, 1, 2, 3].map(|k| thrusts_n[k][i]);
            if i > 0 {
                let slopes = [0, 1, 2, 3].map(|k| (thrusts_n[k][i] - thrusts_n[k][i - 1]) / STEP_S);
                let middle = [0, 1, 2, 3].map(|k| 0.5 * (thrusts_n[k][i] + thrusts_n[k][i - 1]));
                w += (self.angular(&middle, &slopes, &body[i - 1], &w) * habits.share + d) * STEP_S;
                d *= fade;
                let news = section.gyro[i] - bias - w;
                w += news * (1.0 - (1.0 - follow) * (1.0 - follow));
                d += news * (follow * follow / STEP_S);
            }
            let felt = section.specific_force[i] - self.flight.force_bias_m_s2 - self.force(&now(i), &body[i]);
            f += (felt - f) * force_follow;
            rates.push(w);
            disturbance.push(d);
            force.push(f);
        }
        Track { section, thrusts_n, rates, disturbance, force }
    }

    /// From a start, [`HORIZON`] steps.
    pub(super) fn ahead(&self, track: &Track<'_>, start: usize, habits: &Habits, turning: bool) -> Vec<State> {
        let section = track.section;
        let mut state = State {
            position: section.position[start],
            velocity: section.velocity[start],
            attitude: section.attitude[start],
            rates: track.rates[start],
        };
        let gravity = Vector3::new(0.0, 0.0, -GRAVITY_M_S2);
        (0..HORIZON)
            .map(|k| {
                let i = start + k;
                let thrusts = [0, 1, 2, 3].map(|m| 0.5 * (track.thrusts_n[m][i] + track.thrusts_n[m][i + 1]));
                let slopes = [0, 1, 2, 3].map(|m| (track.thrusts_n[m][i + 1] - track.thrusts_n[m][i]) / STEP_S);
                let ahead_s = (k as f64 + 0.5) * STEP_S;
                let torque = track.disturbance[start] * (-ahead_s / habits.torque_s).exp();
                let push = track.force[start] * (-ahead_s / habits.force_s).exp();
                // The middle of the step by half a step, then the step.
                let rate = |s: &State| {
                    let body = s.attitude.inverse_transform_vector(&s.velocity);
                    let angular = if turning {
                        self.angular(&thrusts, &slopes, &body, &s.rates) * habits.share + torque
                            - s.rates * habits.rest_per_s
                    } else {
                        Vector3::zeros()
                    };
                    (s.attitude * (self.force(&thrusts, &body) + push) + gravity, angular)
                };
                let step = |s: &State, at: &State, (a, angular): (Vector3<f64>, Vector3<f64>), h: f64| State {
                    position: s.position + at.velocity * h,
                    velocity: s.velocity + a * h,
                    attitude: s.attitude * UnitQuaternion::from_scaled_axis(at.rates * h),
                    rates: s.rates + angular * h,
                };
                let middle = step(&state, &state, rate(&state), 0.5 * STEP_S);
                state = step(&state, &middle, rate(&middle), STEP_S);
                state
            })
            .collect()
    }
}
