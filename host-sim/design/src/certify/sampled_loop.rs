//! The loop at its rate, with commands that act late by any time: its determinant and its sensitivity on the unit circle.
//!
//! In flows a [`LinearLoop`], a period and a delay a channel; out flow matrices of the size of the plant and the
//! controller's memory, however long the delay: commands on their way are powers of `1/z`, not states.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;

use super::CertifyError;
use super::linear_loop::LinearLoop;
use super::plant::{Predictor, Timing};
use crate::design::discretise::{HeldLate, zero_order_hold_late, zero_order_hold_late_in_f64};

/// Halvings of a step of the angle before a zero of the determinant counts as lying on the circle.
const MAX_HALVINGS: usize = 45;
/// Steps of the angle are halved until the determinant turns by less, rad.
const LARGEST_TURN_RAD: f64 = 0.7;

/// How one channel's command reaches the plant.
#[derive(Debug, Clone)]
struct Path {
    /// Of the command `whole_samples` ago.
    recent: DVector<f64>,
    /// Of the one before.
    previous: DVector<f64>,
    whole_samples: usize,
}

/// States: the plant's, the sums, the controller's memory of its past commands, the actuators that it predicts.
#[derive(Debug, Clone)]
pub(super) struct SampledLoop {
    /// N x N, without any command.
    motion: DMatrix<f64>,
    /// A path a channel, N long each.
    paths: Vec<Path>,
    /// N x m, the map from the command to the controller's memory.
    memory: DMatrix<f64>,
    /// m x N.
    gain: DMatrix<f64>,
}

impl SampledLoop {
    /// `extra_delays_s`: by channel, on top of the timing's whole samples.
    pub(super) fn new(given: &LinearLoop, timing: &Timing, extra_delays_s: &[f64]) -> Result<Self, CertifyError> {
        // A part without a channel still moves.
        let inputs = if given.b.ncols() == 0 { DMatrix::zeros(given.a.nrows(), 1) } else { given.b.clone() };
        let held = |channel: usize| {
            let delay_s = extra_delays_s.get(channel).copied().unwrap_or(0.0);
            zero_order_hold_late(&given.a, &inputs.columns(channel, 1).into_owned(), timing.period_s, delay_s)
        };
        let channels = (0..inputs.ncols()).map(held).collect::<Result<Vec<_>, _>>()?;
        Ok(Self::assembled(given, timing, &channels))
    }

    /// The same in the digits of an f64, with one delay in the channels for which `late` holds: for loops by the thousand.
    pub(super) fn in_f64(
        given: &LinearLoop,
        timing: &Timing,
        delay_s: f64,
        late: impl Fn(usize) -> bool,
    ) -> Result<Self, CertifyError> {
        let held = |delay_s| zero_order_hold_late_in_f64(&given.a, &given.b, timing.period_s, delay_s);
        let (in_time, behind) = (held(0.0)?, held(delay_s)?);
        let channel = |channel: usize| {
            let from = if late(channel) { &behind } else { &in_time };
            HeldLate {
                a: from.a.clone(),
                b_recent: from.b_recent.columns(channel, 1).into_owned(),
                b_previous: from.b_previous.columns(channel, 1).into_owned(),
                ..*from
            }
        };
        let channels: Vec<HeldLate> = (0..given.b.ncols()).map(channel).collect();
        Ok(Self::assembled(given, timing, &channels))
    }

    /// From the plant under each of its commands alone.
    fn assembled(given: &LinearLoop, timing: &Timing, channels: &[HeldLate]) -> Self {
        let (n, m, p) = (given.a.nrows(), given.b.ncols(), given.integrated.len());
        let depth = given.past_command_gains.len();
        let predicted = given.predictor.as_ref().map_or(0, |_| m);
        let size = n + p + m * depth + predicted;
        let mut motion = DMatrix::zeros(size, size);
        let mut paths = Vec::with_capacity(m);
        for (channel, held) in channels.iter().enumerate() {
            motion.view_mut((0, 0), (n, n)).copy_from(&held.a);
            if channel < m {
                paths.push(Path {
                    recent: held.b_recent.column(0).into_owned().resize_vertically(size, 0.0),
                    previous: held.b_previous.column(0).into_owned().resize_vertically(size, 0.0),
                    whole_samples: timing.delay_samples + held.whole_samples,
                });
            }
        }
        for (sum, state) in given.integrated.iter().enumerate() {
            motion[(n + sum, *state)] = timing.period_s;
            motion[(n + sum, n + sum)] = 1.0;
        }
        let first = n + p;
        let mut memory = DMatrix::zeros(size, m);
        let mut gain = DMatrix::zeros(m, size);
        gain.view_mut((0, 0), (m, n)).copy_from(&given.state_gain);
        gain.view_mut((0, n), (m, p)).copy_from(&given.integral_gain);
        for (age, past) in given.past_command_gains.iter().enumerate() {
            gain.view_mut((0, first + age * m), (m, m)).copy_from(past);
            for channel in 0..m {
                let row = first + age * m + channel;
                if age == 0 { memory[(row, channel)] = 1.0 } else { motion[(row, row - m)] = 1.0 }
            }
        }
        if let Some(Predictor { gain: of_predicted, decay }) = &given.predictor {
            let first = size - m;
            gain.view_mut((0, first), (m, m)).copy_from(of_predicted);
            for channel in 0..m {
                motion[(first + channel, first + channel)] = *decay;
                memory[(first + channel, channel)] = 1.0 - decay;
            }
        }
        Self { motion, paths, memory, gain }
    }

    /// The closed loop with every command on its way as a state.
    pub(super) fn closed_loop(&self) -> DMatrix<f64> {
        let size = self.motion.nrows();
        let waiting: usize = self.paths.iter().map(waiting_commands).sum();
        let mut whole = DMatrix::zeros(size + waiting, size + waiting);
        whole.view_mut((0, 0), (size, size)).copy_from(&(&self.motion - &self.memory * &self.gain));
        let mut first = size;
        for (channel, path) in self.paths.iter().enumerate() {
            let command = -self.gain.row(channel);
            let count = waiting_commands(path);
            // Adds the effect of the command `age` samples ago.
            let mut act = |age: usize, effect: &DVector<f64>| {
                if age == 0 {
                    let block = effect * &command;
                    let mut target = whole.view_mut((0, 0), (size, size));
                    target += block;
                } else if age <= count {
                    let mut target = whole.view_mut((0, first + age - 1), (size, 1));
                    target += effect;
                }
            };
            act(path.whole_samples, &path.recent);
            act(path.whole_samples + 1, &path.previous);
            if count > 0 {
                whole.view_mut((first, 0), (1, size)).copy_from(&command);
            }
            for age in 1..count {
                whole[(first + age, first + age - 1)] = 1.0;
            }
            first += count;
        }
        whole
    }

    /// The plant's response to a command at z: N x m.
    fn plant_input(&self, z: Complex64) -> DMatrix<Complex64> {
        let inverse = z.inv();
        DMatrix::from_fn(self.motion.nrows(), self.paths.len(), |i, j| {
            let path = &self.paths[j];
            (inverse * path.previous[i] + path.recent[i]) * inverse.powu(path.whole_samples as u32)
        })
    }

    /// `z I - motion + (plant input + memory) K`, whose determinant vanishes at the poles.
    fn return_matrix(&self, z: Complex64) -> DMatrix<Complex64> {
        let memory = self.memory.map(|value| Complex64::new(value, 0.0));
        let gain = self.gain.map(|value| Complex64::new(value, 0.0));
        let mut whole = (self.plant_input(z) + memory) * gain - self.motion.map(|value| Complex64::new(value, 0.0));
        for i in 0..whole.nrows() {
            whole[(i, i)] += z;
        }
        whole
    }

    /// From a disturbance at the plant's input to the plant's input, at an angle of z = e^(i angle): m x m.
    pub(super) fn sensitivity(&self, angle_rad: f64) -> Option<DMatrix<Complex64>> {
        let z = Complex64::from_polar(1.0, angle_rad);
        let moved = self.return_matrix(z).lu().solve(&self.plant_input(z))?;
        let gain = self.gain.map(|value| Complex64::new(value, 0.0));
        let m = self.paths.len();
        Some(DMatrix::identity(m, m) - gain * moved)
    }

    /// Whether every pole lies inside the unit circle, by the principle of the argument.
    ///
    /// The determinant is a polynomial of z over a power of z; all zeros of the polynomial lie inside exactly if the
    /// determinant winds around 0 once a state as z goes around the circle, which is half a turn a state from 1 to -1.
    pub(super) fn is_stable(&self) -> bool {
        let states = self.motion.nrows();
        let orders = states + self.paths.iter().map(|path| path.whole_samples + 1).sum::<usize>();
        let value = |angle_rad: f64| self.return_matrix(Complex64::from_polar(1.0, angle_rad)).determinant();
        let cells = 8 * orders + 64;
        let first_rad = std::f64::consts::PI / cells as f64;
        // Poles of a fast loop crowd around z = 1: towards it the steps shrink in proportion.
        let mut angles: Vec<f64> = (0..40).map(|k| first_rad * 0.6_f64.powi(40 - k)).collect();
        angles.extend((1..=cells).map(|k| first_rad * k as f64));
        let mut turned_rad = 0.0;
        let (mut start_rad, mut start) = (0.0, value(0.0));
        for end_rad in angles {
            let end = value(end_rad);
            let Some(turn) = turn(&value, (start_rad, start), (end_rad, end), MAX_HALVINGS) else { return false };
            turned_rad += turn;
            (start_rad, start) = (end_rad, end);
        }
        (turned_rad / std::f64::consts::PI - states as f64).abs() < 0.5
    }
}

/// Commands that have been given and still act later on.
fn waiting_commands(path: &Path) -> usize {
    path.whole_samples + usize::from(path.previous.iter().any(|value| *value != 0.0))
}

/// How far the determinant turns between two angles; nothing if it passes through 0.
fn turn(
    value: &impl Fn(f64) -> Complex64,
    start: (f64, Complex64),
    end: (f64, Complex64),
    halvings: usize,
) -> Option<f64> {
    let middle_rad = 0.5 * (start.0 + end.0);
    let middle = value(middle_rad);
    let (first, second) = ((middle * start.1.conj()).arg(), (end.1 * middle.conj()).arg());
    if first.abs() < LARGEST_TURN_RAD && second.abs() < LARGEST_TURN_RAD {
        // The argument of 0 is 0, too.
        return (middle.norm() > 0.0 && start.1.norm() > 0.0 && end.1.norm() > 0.0).then_some(first + second);
    }
    let halvings = halvings.checked_sub(1)?;
    let before = turn(value, start, (middle_rad, middle), halvings)?;
    Some(before + turn(value, (middle_rad, middle), end, halvings)?)
}

#[cfg(test)]
mod tests;
