//! The flights once more, from commands alone, on a part that was held out: predictions half a second ahead, beside two
//! predictions that know less.
//!
//! The state at a start comes from the past alone: pose and velocity as measured, body rates and a disturbing torque by a
//! Kalman filter on the gyroscope, a disturbing force by the accelerometer. Disturbances fade as they do on the flights
//! that were learned from.

use nalgebra::{UnitQuaternion, Vector3};

use crate::IdentifyError;
use crate::filter::{lagged, mean, quantile, shifted};
use crate::fit::{Base, Fit, FlightFit, Model, fit};
use crate::flight::{Flight, RATE_HZ, STEP_S, Section};
use quatrack_design::model::GRAVITY_M_S2;
use quatrack_design::vehicle::{ROTOR_SIDES, ROTOR_TORQUE_SIGNS};

/// How far ahead, in steps of the grid.
pub const HORIZON: usize = 50;
/// From one start to the next, in steps.
const BETWEEN: usize = 10;
/// Steps that the filters take before a start.
const BEFORE: usize = 100;
/// Share of each flight that is held out, at its end.
const HELD_OUT: f64 = 0.25;

/// Mean errors, each the mean over all starts of the length of the error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// m.
    pub position_m: f64,
    /// m/s.
    pub velocity_m_s: f64,
    /// rad.
    pub rotation_rad: f64,
    /// rad/s.
    pub body_rate_rad_s: f64,
}

/// Errors of one way to predict at every step ahead, from 1 to [`HORIZON`].
pub type Course = Vec<Errors>;

/// Three ways to predict on the part that was held out.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// With the identified figures.
    pub ours: Course,
    /// The same without angular acceleration.
    pub no_angular_acceleration: Course,
    /// Everything stays as it is at the start.
    pub no_change: Course,
    /// The number of starts.
    pub starts: usize,
    /// A part that was held out, for pictures: one stretch of a flight, predicted from its every half second.
    pub example: Option<Example>,
}

/// A stretch of flight with its prediction.
#[derive(Clone, Debug, PartialEq)]
pub struct Example {
    /// Its file.
    pub flight: String,
    /// s.
    pub times_s: Vec<f64>,
    /// Position as flown, m.
    pub position_m: Vec<Vector3<f64>>,
    /// As predicted, from a new start every half second.
    pub predicted_m: Vec<Vector3<f64>>,
    /// Body rates as flown and as predicted, rad/s.
    pub rates_rad_s: [Vec<Vector3<f64>>; 2],
}

#[derive(Clone, Copy)]
struct State {
    position: Vector3<f64>,
    velocity: Vector3<f64>,
    attitude: UnitQuaternion<f64>,
    rates: Vector3<f64>,
}

/// How disturbances are followed and how they fade; had from the part that is learned from.
#[derive(Clone, Copy, Debug)]
struct Habits {
    /// Deviation of the disturbing angular acceleration over that of the gyroscope's noise, 1/s^2; steers the filter's gain.
    gain: f64,
    /// How long a disturbing torque lasts, s.
    torque_s: f64,
    /// How long a disturbing force does, s.
    force_s: f64,
    /// Share of the angular acceleration by the figures that is believed: logged commands are noisy, and a flight is smooth.
    share: f64,
    /// How fast a flown craft stops turning, beside the damping of its figures, 1/s.
    rest_per_s: f64,
}

/// A section with its motors' thrusts, and the filters' estimates at each point.
struct Track<'a> {
    section: &'a Section,
    thrusts_n: [Vec<f64>; 4],
    rates: Vec<Vector3<f64>>,
    disturbance: Vec<Vector3<f64>>,
    force: Vec<Vector3<f64>>,
}

struct Craft<'a> {
    base: &'a Base,
    model: &'a Model,
    flight: &'a FlightFit,
}

impl Craft<'_> {
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

    fn track<'s>(&self, section: &'s Section, habits: &Habits) -> Track<'s> {
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
    fn ahead(&self, track: &Track<'_>, start: usize, habits: &Habits, turning: bool) -> Vec<State> {
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

impl Errors {
    fn of(section: &Section, i: usize, bias: &Vector3<f64>, state: &State) -> Self {
        Self {
            position_m: (section.position[i] - state.position).norm(),
            velocity_m_s: (section.velocity[i] - state.velocity).norm(),
            rotation_rad: section.attitude[i].angle_to(&state.attitude),
            body_rate_rad_s: (section.gyro[i] - bias - state.rates).norm(),
        }
    }

    fn add(&mut self, other: &Self) {
        self.position_m += other.position_m;
        self.velocity_m_s += other.velocity_m_s;
        self.rotation_rad += other.rotation_rad;
        self.body_rate_rad_s += other.body_rate_rad_s;
    }

    fn over(&self, count: usize) -> Self {
        let share = 1.0 / count.max(1) as f64;
        Self {
            position_m: self.position_m * share,
            velocity_m_s: self.velocity_m_s * share,
            rotation_rad: self.rotation_rad * share,
            body_rate_rad_s: self.body_rate_rad_s * share,
        }
    }
}

/// Learns from three quarters of every flight and predicts the last.
///
/// # Errors
/// [`IdentifyError::TooLittle`] where the flights are too short for that.
pub fn validate(flights: &[Flight], base: &Base) -> Result<(Prediction, Fit), IdentifyError> {
    let (learned, held): (Vec<Flight>, Vec<Flight>) = flights.iter().map(halves).unzip();
    let fit = fit(&learned, base)?;
    let habits = habits(&learned, &fit);
    Ok((predict(&held, &fit, &habits), fit))
}

/// The first three quarters of a flight and its last, by length.
fn halves(flight: &Flight) -> (Flight, Flight) {
    let total: usize = flight.sections.iter().map(Section::len).sum();
    let mut left = ((1.0 - HELD_OUT) * total as f64) as usize;
    let (mut first, mut second) = (Vec::new(), Vec::new());
    for section in &flight.sections {
        let here = left.min(section.len());
        if here > 2 * BEFORE {
            first.push(section.part(0..here));
        }
        if section.len() - here > BEFORE + HORIZON {
            second.push(section.part(here..section.len()));
        }
        left -= here;
    }
    let with = |sections| Flight { sections, ..flight.clone() };
    (with(first), with(second))
}

/// The habits that predict the learned flights best, one after the other from a grid, twice.
fn habits(learned: &[Flight], fit: &Fit) -> Habits {
    let start = Habits { gain: 10.0, torque_s: 0.5, force_s: 1.0, share: 0.7, rest_per_s: 0.5 };
    let cost = |habits: &Habits| {
        let last = errors(learned, fit, habits, 4 * BETWEEN, true).0[HORIZON - 1];
        // Each over its usual size on small craft, so that none goes unseen.
        last.position_m / 0.06 + last.velocity_m_s / 0.35 + last.rotation_rad / 0.18 + last.body_rate_rad_s / 0.5
    };
    let mut best = (cost(&start), start);
    for _ in 0..2 {
        let tries = |best: Habits| {
            let gains = [2.0, 5.0, 10.0, 20.0, 40.0].map(|gain| Habits { gain, ..best });
            let torques = [0.1, 0.2, 0.4, 0.8, 2.0].map(|torque_s| Habits { torque_s, ..best });
            let forces = [0.2, 0.5, 1.5, 10.0].map(|force_s| Habits { force_s, ..best });
            let shares = [0.2, 0.35, 0.5, 0.65, 0.8, 1.0].map(|share| Habits { share, ..best });
            let rests = [0.0, 0.5, 1.0, 2.0, 3.0, 5.0, 8.0].map(|rest_per_s| Habits { rest_per_s, ..best });
            [gains.to_vec(), torques.to_vec(), forces.to_vec(), shares.to_vec(), rests.to_vec()]
        };
        for kind in 0..5 {
            for habits in &tries(best.1)[kind] {
                let cost = cost(habits);
                if cost < best.0 {
                    best = (cost, *habits);
                }
            }
        }
    }
    best.1
}

fn errors(flights: &[Flight], fit: &Fit, habits: &Habits, between: usize, turning: bool) -> (Course, usize) {
    let (mut course, mut starts) = (vec![Errors::default(); HORIZON], 0);
    for (flight, own) in flights.iter().zip(&fit.flights) {
        let craft = Craft { base: &fit.base, model: &fit.model, flight: own };
        for section in flight.sections.iter().filter(|section| section.len() > BEFORE + HORIZON + 1) {
            let track = craft.track(section, habits);
            for start in (BEFORE..section.len() - HORIZON - 1).step_by(between) {
                for (k, state) in craft.ahead(&track, start, habits, turning).iter().enumerate() {
                    course[k].add(&Errors::of(section, start + k + 1, &own.gyro_bias_rad_s, state));
                }
                starts += 1;
            }
        }
    }
    (course.iter().map(|errors| errors.over(starts)).collect(), starts)
}

fn unchanged(flights: &[Flight], fit: &Fit) -> Course {
    let (mut course, mut starts) = (vec![Errors::default(); HORIZON], 0);
    for (flight, own) in flights.iter().zip(&fit.flights) {
        for section in flight.sections.iter().filter(|section| section.len() > BEFORE + HORIZON + 1) {
            for start in (BEFORE..section.len() - HORIZON - 1).step_by(BETWEEN) {
                let state = State {
                    position: section.position[start],
                    velocity: section.velocity[start],
                    attitude: section.attitude[start],
                    rates: section.gyro[start] - own.gyro_bias_rad_s,
                };
                for (k, errors) in course.iter_mut().enumerate() {
                    errors.add(&Errors::of(section, start + k + 1, &own.gyro_bias_rad_s, &state));
                }
                starts += 1;
            }
        }
    }
    course.iter().map(|errors| errors.over(starts)).collect()
}

fn predict(held: &[Flight], fit: &Fit, habits: &Habits) -> Prediction {
    let (ours, starts) = errors(held, fit, habits, BETWEEN, true);
    Prediction {
        ours,
        no_angular_acceleration: errors(held, fit, habits, BETWEEN, false).0,
        no_change: unchanged(held, fit),
        starts,
        example: example(held, fit, habits),
    }
}

/// The liveliest held-out part.
fn example(held: &[Flight], fit: &Fit, habits: &Habits) -> Option<Example> {
    let lively = |section: &Section| quantile(&section.gyro.iter().map(|w| w.xy().norm()).collect::<Vec<_>>(), 0.9);
    let parts =
        held.iter().zip(&fit.flights).flat_map(|(flight, own)| flight.sections.iter().map(move |s| (flight, own, s)));
    let (flight, own, section) =
        parts.filter(|(_, _, s)| s.len() > BEFORE + 4 * HORIZON).max_by(|a, b| lively(a.2).total_cmp(&lively(b.2)))?;
    let craft = Craft { base: &fit.base, model: &fit.model, flight: own };
    let track = craft.track(section, habits);
    let mut example = Example {
        flight: flight.name.clone(),
        times_s: Vec::new(),
        position_m: Vec::new(),
        predicted_m: Vec::new(),
        rates_rad_s: [Vec::new(), Vec::new()],
    };
    let last = section.len().min((RATE_HZ * 11.0) as usize) - HORIZON - 1;
    for start in (BEFORE..last).step_by(HORIZON) {
        for (k, state) in craft.ahead(&track, start, habits, true).iter().enumerate() {
            let i = start + k + 1;
            example.times_s.push(section.start_s + i as f64 * STEP_S);
            example.position_m.push(section.position[i]);
            example.predicted_m.push(state.position);
            example.rates_rad_s[0].push(section.gyro[i] - own.gyro_bias_rad_s);
            example.rates_rad_s[1].push(state.rates);
        }
    }
    Some(example)
}

/// Mean of a course over all steps ahead.
pub fn overall(course: &[Errors]) -> Errors {
    let over = |f: fn(&Errors) -> f64| mean(&course.iter().map(f).collect::<Vec<_>>());
    Errors {
        position_m: over(|e| e.position_m),
        velocity_m_s: over(|e| e.velocity_m_s),
        rotation_rad: over(|e| e.rotation_rad),
        body_rate_rad_s: over(|e| e.body_rate_rad_s),
    }
}
