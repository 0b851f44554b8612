//! The plant (1) under a law: continuous feedback or held commands in, a flight sampled every 10 ms out.

use nalgebra::Vector3;
use quatrack_design::model::flat::ReferencePoint;
use quatrack_design::model::{InputVector, StateVector, dynamics, normalised, position};

use super::reference::Reference;
use crate::integrator::{DormandPrince, Method};

/// Sampling period of the paper's logs and of (23), s.
pub const SAMPLE_PERIOD_S: f64 = 0.01;

const SAMPLES_PER_SECOND: u64 = 100;

/// Longest step of the plant under a held command, s. The plant's own error is then below 1e-9 m a second.
const HOLD_STEP_MAX_S: f64 = 0.005;

/// A position error beyond which a flight is lost, m, in scenarios too. The paper's flights stay within 2.6 m.
pub const LOST_M: f64 = 5.0;

/// The same where the paper's table is reproduced, which has the error of a whole flight however far it strays, m.
pub const REPRODUCED_LOST_M: f64 = 1e3;

/// One row of a flight.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Time, s.
    pub time_s: f64,
    /// State, quaternion of norm 1.
    pub state: StateVector,
    /// Input that acts from here on.
    pub input: InputVector,
    /// The reference.
    pub target: ReferencePoint,
}

impl Sample {
    /// Position error, world frame, m.
    pub fn position_error_m(&self) -> Vector3<f64> {
        position(&self.state) - position(&self.target.state)
    }
}

/// A flight, whole or up to where it was lost.
#[derive(Clone, Debug)]
pub struct Flight {
    /// Rows at multiples of [`SAMPLE_PERIOD_S`].
    pub samples: Vec<Sample>,
    /// Control steps whose command was cut to the limits; 0 in continuous time.
    pub saturated_steps: u64,
    /// Why and when it ended early.
    pub lost: Option<Lost>,
}

/// The end of a flight that did not reach its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Lost {
    /// The time, s.
    pub time_s: f64,
    /// Why.
    pub reason: String,
}

/// A held command and whether it was cut to the limits.
#[derive(Clone, Copy, Debug)]
pub struct HeldCommand {
    /// Thrust and body rates.
    pub input: InputVector,
    /// Whether the law asked for more.
    pub limited: bool,
}

/// How continuous feedback is integrated.
#[derive(Clone, Copy, Debug)]
pub enum Solver {
    /// A fixed step of [`SAMPLE_PERIOD_S`] divided by `substeps`.
    Fixed {
        /// The method.
        method: Method,
        /// Steps a sample.
        substeps: u32,
    },
    /// Steps by error estimate.
    Adaptive(DormandPrince),
}

impl Solver {
    /// The paper's: Bogacki-Shampine 3 at 0.01 s.
    pub const PAPER: Self = Self::Fixed { method: Method::BogackiShampine3, substeps: 1 };
}

/// Flies `reference` from its start under continuous `feedback`, which is given the state, of unit quaternion norm, and
/// the point to be at. `lost_m` is the position error beyond which it is lost.
pub fn fly_continuous(
    reference: &dyn Reference,
    feedback: impl Fn(&StateVector, &ReferencePoint) -> InputVector,
    solver: Solver,
    lost_m: f64,
) -> Flight {
    let input = |t_s: f64, x: &StateVector| feedback(&normalised(x), &reference.at(t_s));
    let mut right_hand_side = |t_s: f64, x: &StateVector| dynamics(&normalised(x), &input(t_s, x));
    let mut recorder = Recorder::new(reference, lost_m);
    let mut x = reference.at(0.0).state;
    for k in 0..=sample_count(reference.duration_s()) {
        let t_s = k as f64 / SAMPLES_PER_SECOND as f64;
        if recorder.record(t_s, &x, input(t_s, &x)).is_break() {
            break;
        }
        let end_s = (k + 1) as f64 / SAMPLES_PER_SECOND as f64;
        match solver {
            Solver::Fixed { method, substeps } => {
                let h = (end_s - t_s) / f64::from(substeps);
                for substep in 0..substeps {
                    x = method.step(&mut right_hand_side, t_s + f64::from(substep) * h, &x, h);
                }
            }
            Solver::Adaptive(method) => match method.integrate(&mut right_hand_side, t_s, end_s, &x) {
                Ok(next) => x = next,
                Err(error) => {
                    recorder.lose(t_s, error.to_string());
                    break;
                }
            },
        }
    }
    recorder.flight
}

/// Flies `reference` from its start under commands held between the ticks of a clock of `rate_hz`.
///
/// `control` is given the tick, its time and the state, whose quaternion has norm 1; an error ends the flight, and so does a
/// position error of `lost_m`.
pub fn fly_sampled(
    reference: &dyn Reference,
    rate_hz: u32,
    lost_m: f64,
    mut control: impl FnMut(u32, f64, &StateVector) -> Result<HeldCommand, String>,
) -> Flight {
    let rate = u64::from(rate_hz);
    let mut recorder = Recorder::new(reference, lost_m);
    let mut x = reference.at(0.0).state;
    let mut input = InputVector::zeros();
    // Time counts in units of 1 / (rate * 100) s, so that ticks and samples meet exactly.
    let (tick_units, sample_units) = (SAMPLES_PER_SECOND, rate);
    let end = sample_count(reference.duration_s()) * sample_units;
    let seconds = |units: u64| units as f64 / (rate * SAMPLES_PER_SECOND) as f64;
    let (mut now, mut tick, mut sample) = (0_u64, 0_u64, 0_u64);
    loop {
        if now == tick * tick_units {
            match control(tick as u32, seconds(now), &normalised(&x)) {
                Ok(command) => {
                    input = command.input;
                    recorder.flight.saturated_steps += u64::from(command.limited);
                }
                Err(reason) => {
                    recorder.lose(seconds(now), reason);
                    break;
                }
            }
            tick += 1;
        }
        if now == sample * sample_units {
            if recorder.record(seconds(now), &x, input).is_break() {
                break;
            }
            sample += 1;
        }
        if now >= end {
            break;
        }
        let next = (tick * tick_units).min(sample * sample_units);
        x = hold(&x, &input, seconds(next) - seconds(now));
        now = next;
    }
    recorder.flight
}

/// The plant under a constant input for a time.
fn hold(x: &StateVector, input: &InputVector, duration_s: f64) -> StateVector {
    let steps = (duration_s / HOLD_STEP_MAX_S).ceil().max(1.0);
    let h = duration_s / steps;
    let mut right_hand_side = |_t: f64, x: &StateVector| dynamics(&normalised(x), input);
    (0..steps as u32).fold(*x, |x, _| Method::RungeKutta4.step(&mut right_hand_side, 0.0, &x, h))
}

/// `floor(t_f / T_s)` of (23), forgiving the rounding of the quotient.
fn sample_count(duration_s: f64) -> u64 {
    (duration_s * SAMPLES_PER_SECOND as f64 + 1e-6).floor() as u64
}

struct Recorder<'a> {
    reference: &'a dyn Reference,
    lost_m: f64,
    flight: Flight,
}

impl<'a> Recorder<'a> {
    fn new(reference: &'a dyn Reference, lost_m: f64) -> Self {
        Self { reference, lost_m, flight: Flight { samples: Vec::new(), saturated_steps: 0, lost: None } }
    }

    fn record(&mut self, time_s: f64, x: &StateVector, input: InputVector) -> std::ops::ControlFlow<()> {
        let sample = Sample { time_s, state: normalised(x), input, target: self.reference.at(time_s) };
        let error_m = sample.position_error_m().norm();
        let is_finite = error_m.is_finite() && input.iter().all(|value| value.is_finite());
        // That of its loss is the worst one.
        if is_finite {
            self.flight.samples.push(sample);
        }
        if is_finite && error_m < self.lost_m {
            std::ops::ControlFlow::Continue(())
        } else {
            self.lose(time_s, format!("{error_m:.0} m from the reference"));
            std::ops::ControlFlow::Break(())
        }
    }

    fn lose(&mut self, time_s: f64, reason: String) {
        self.flight.lost = Some(Lost { time_s, reason });
    }
}
