//! A craft under motor commands at a rate: measurements to a controller, its commands back, late if asked for; a flight
//! sampled every 10 ms out.

use nalgebra::{Vector3, Vector4};
use quatrack_design::model::{InputVector, StateVector};

use super::closed_loop::{Flight, Lost, SAMPLE_PERIOD_S, Sample};
use super::noise::{Noise, Source};
use super::reference::Reference;
use crate::plant::{Craft, RigidState};

/// A position error beyond which a flight is lost, m: several times the size of any manoeuvre flown here.
const LOST_M: f64 = 10.0;

/// The settings of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Length, s.
    pub duration_s: f64,
    /// Control steps a sample of 10 ms: 5 are 500 Hz.
    pub steps_a_sample: u32,
    /// Delay of the commands, s.
    pub delay_s: f64,
    /// The errors of measurements.
    pub noise: Option<Noise>,
}

/// Commanded forces and whether they were cut to the motors' range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorCommand {
    /// Force of each motor, N.
    pub forces_n: Vector4<f64>,
    /// Whether the law asked for more.
    pub limited: bool,
}

/// One row of a flight.
#[derive(Clone, Copy, Debug)]
pub struct RigidSample {
    /// Time, s.
    pub time_s: f64,
    /// Where the craft is, without noise.
    pub state: RigidState,
    /// The commands given at this time, N.
    pub commands_n: Vector4<f64>,
    /// Position of the reference, world frame, m.
    pub target_m: Vector3<f64>,
}

impl RigidSample {
    /// Position error, world frame, m.
    pub fn position_error_m(&self) -> Vector3<f64> {
        self.state.position_m - self.target_m
    }
}

/// A flight, whole or up to where it was lost.
#[derive(Clone, Debug)]
pub struct RigidFlight {
    /// Rows every 10 ms.
    pub samples: Vec<RigidSample>,
    /// Control steps whose commands were cut.
    pub saturated_steps: u64,
    /// Why and when it ended early.
    pub lost: Option<Lost>,
}

impl RigidFlight {
    /// Sum (23) of the position error's norm over all samples, times the sampling period, m s; none for a lost flight.
    pub fn iae_m_s(&self) -> Option<f64> {
        let sum: f64 = self.samples.iter().map(|sample| sample.position_error_m().norm()).sum();
        self.lost.is_none().then_some(sum * SAMPLE_PERIOD_S)
    }

    /// The same flight as the model (1) has it: of a craft of `mass_kg`, its thrust and body rates for the input, along
    /// `reference`.
    pub fn in_the_model(&self, mass_kg: f64, reference: &dyn Reference) -> Flight {
        let sample = |sample: &RigidSample| {
            let RigidState { position_m: r, velocity_m_s: v, attitude, body_rates_rad_s: rates, thrusts_n } =
                sample.state;
            let q = attitude.quaternion();
            Sample {
                time_s: sample.time_s,
                state: StateVector::from([r.x, r.y, r.z, q.w, q.i, q.j, q.k, v.x, v.y, v.z]),
                input: InputVector::new(thrusts_n.sum() / mass_kg, rates.x, rates.y, rates.z),
                target: reference.at(sample.time_s),
            }
        };
        Flight {
            samples: self.samples.iter().map(sample).collect(),
            saturated_steps: self.saturated_steps,
            lost: self.lost.clone(),
        }
    }

    /// Largest position error, m.
    pub fn max_error_m(&self) -> f64 {
        self.samples.iter().map(|sample| sample.position_error_m().norm()).fold(0.0, f64::max)
    }
}

/// Commands on their way to the motors.
struct Latency {
    delay_s: f64,
    whole_steps: usize,
    /// The last commands, the latest first.
    given: Vec<Vector4<f64>>,
}

impl Latency {
    fn new(delay_s: f64, step_s: f64, before: Vector4<f64>) -> Self {
        // Forgiving the rounding of a quotient of decimal numbers.
        let whole = (delay_s / step_s + 1e-9).floor();
        Self {
            delay_s: (delay_s - whole * step_s).max(0.0),
            whole_steps: whole as usize,
            given: vec![before; whole as usize + 2],
        }
    }

    /// Takes a command; returns the forces of a first part of the step, its length, and the forces of the rest.
    fn pass(&mut self, command: Vector4<f64>) -> (Vector4<f64>, f64, Vector4<f64>) {
        self.given.rotate_right(1);
        self.given[0] = command;
        (self.given[self.whole_steps + 1], self.delay_s, self.given[self.whole_steps])
    }
}

/// Flies `craft` from `start`. `target_m` is where it should be; `control` is given the tick and the measurements, and
/// an error of it ends the flight. Before the first command acts, the motors keep their forces.
pub fn fly_rigid(
    craft: &Craft,
    start: &RigidState,
    conditions: &Conditions,
    target_m: impl Fn(f64) -> Vector3<f64>,
    mut control: impl FnMut(u32, &RigidState) -> Result<MotorCommand, String>,
) -> RigidFlight {
    let steps_a_sample = conditions.steps_a_sample.max(1);
    let step_s = SAMPLE_PERIOD_S / f64::from(steps_a_sample);
    let steps = (conditions.duration_s / SAMPLE_PERIOD_S + 1e-6).floor() as u32 * steps_a_sample;
    let mut latency = Latency::new(conditions.delay_s, step_s, start.thrusts_n);
    let mut source = Source::new(conditions.noise.map_or(0, |noise| noise.seed));
    let mut flight = RigidFlight { samples: Vec::new(), saturated_steps: 0, lost: None };
    let mut state = *start;
    for tick in 0..=steps {
        let time_s = f64::from(tick) * step_s;
        let measured = conditions.noise.map_or(state, |noise| source.measured(&state, &noise));
        let command = match control(tick, &measured) {
            Ok(command) => command,
            Err(reason) => {
                flight.lost = Some(Lost { time_s, reason });
                break;
            }
        };
        flight.saturated_steps += u64::from(command.limited);
        if tick % steps_a_sample == 0 {
            let sample = RigidSample { time_s, state, commands_n: command.forces_n, target_m: target_m(time_s) };
            let error_m = sample.position_error_m().norm();
            // Written so that NaN fails it.
            if !(error_m < LOST_M && state.is_finite()) {
                flight.lost = Some(Lost { time_s, reason: format!("{error_m:.0} m from the reference") });
                break;
            }
            flight.samples.push(sample);
        }
        let (first, first_s, rest) = latency.pass(command.forces_n);
        if first_s > 0.0 {
            state = craft.hold(&state, &first, time_s, first_s);
        }
        state = craft.hold(&state, &rest, time_s + first_s, step_s - first_s);
    }
    flight
}
