//! Signals of the balances of torques and of thrust, low-passed: figures in, residuals out.
//!
//! Of body x and y: `M = J w' - c v + d w + b`, M the lagged motors' mixture; of z: `f = a_z` with drag and lift. The bias b
//! is each section's own mean.

use nalgebra::{Matrix3, Vector3};

use super::prior::Base;
use super::{CORNER_HZ, MARGIN_S};
use crate::filter::{LowPass, derivative, lagged, mean, median, shifted, shifted_smoothly};
use crate::flight::{Flight, RATE_HZ, STEP_S, Section};
use quatrack_design::model::GRAVITY_M_S2;
use quatrack_design::vehicle::{ROTOR_SIDES, ROTOR_TORQUE_SIGNS};

/// A jump is so many times as large as the median change beyond the changes around, and no less than this share of full commands.
const JUMP_SPREADS: f64 = 8.0;
const JUMP_LEAST: f64 = 0.05;

/// The motors' answer to a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drive {
    pub(crate) rise_s: f64,
    pub(crate) fall_s: f64,
    pub(crate) delay_s: f64,
    /// How much later than in the middle between two samples a jump happens, s.
    pub(crate) jump_s: f64,
    /// Of command and voltage.
    pub(crate) powers: [f64; 2],
}

/// A section with all that does not depend on figures.
pub(super) struct Prepared {
    pub(super) flight: usize,
    pub(super) start_s: f64,
    /// Logarithms of the commands, and of the voltage over the reference: so a power costs one exponential a point.
    log_commands: [Vec<f64>; 4],
    log_voltage: Vec<f64>,
    /// Points before which the commands jump, as they do where a setpoint does.
    jumps: Vec<usize>,
    /// Low-passed: angular acceleration, body velocity, body rates, specific force.
    pub(super) angular: [Vec<f64>; 3],
    pub(super) velocity: [Vec<f64>; 3],
    pub(super) rates: [Vec<f64>; 3],
    pub(super) force: [Vec<f64>; 3],
    /// Products `w_y w_z` and `w_z w_x`.
    pub(super) products: [Vec<f64>; 2],
    /// Square of the velocity across the thrust.
    pub(super) across: Vec<f64>,
    /// Bias of the accelerometer, by the velocity's change over the section.
    pub(super) force_bias: Vector3<f64>,
    /// Bias of the gyroscope, by the attitude's change.
    pub(super) gyro_bias: Vector3<f64>,
    /// Points that count.
    pub(super) inner: std::ops::Range<usize>,
    /// As logged: body rates, velocity in the body frame, specific force without its bias.
    pub(super) logged: Logged,
}

/// Signals as they were logged, by axis.
pub(super) struct Logged {
    pub(super) rates: [Vec<f64>; 3],
    pub(super) velocity: [Vec<f64>; 3],
    pub(super) force: [Vec<f64>; 3],
}

/// Lagged thrusts of [`Drive`] as they are, without a low-pass.
pub(super) struct Thrusts {
    /// Mixtures about x and y at each point.
    pub(super) mixture: [Vec<f64>; 2],
    /// The same, averaged from each point to the next.
    pub(super) between: [Vec<f64>; 2],
    /// Mean of the four.
    pub(super) mean: Vec<f64>,
}

/// Lagged and low-passed, of thrusts `u^p (V/V_0)^q`: mixtures about x, y and z, and the mean.
pub(super) struct Driven {
    pub(super) mixture: [Vec<f64>; 3],
    pub(super) mean: Vec<f64>,
}

impl Prepared {
    pub(super) fn of(flight: usize, section: &Section, base: &Base) -> Self {
        let low = LowPass::new(CORNER_HZ, RATE_HZ);
        let axes = |vectors: &[Vector3<f64>]| [0, 1, 2].map(|k| vectors.iter().map(|v| v[k]).collect::<Vec<f64>>());
        let smooth = |channels: [Vec<f64>; 3]| channels.map(|channel| low.both_ways(&channel));
        let (gyro, body) = (axes(&section.gyro), axes(&section.body_velocity()));
        let product = |a: usize, b: usize| -> Vec<f64> {
            low.both_ways(&gyro[a].iter().zip(&gyro[b]).map(|(a, b)| a * b).collect::<Vec<_>>())
        };
        let across: Vec<f64> = body[0].iter().zip(&body[1]).map(|(x, y)| x * x + y * y).collect();
        let margin = (MARGIN_S * RATE_HZ) as usize;
        let count = section.len();
        let force_bias = force_bias(section);
        let force: Vec<Vector3<f64>> = section.specific_force.iter().map(|f| f - force_bias).collect();
        Self {
            flight,
            start_s: section.start_s,
            jumps: jumps(&section.commands),
            log_commands: section.commands.each_ref().map(|command| command.iter().map(|u| u.ln()).collect()),
            log_voltage: section.voltage.iter().map(|v| (v / base.reference_v).ln()).collect(),
            angular: [0, 1, 2].map(|k| low.both_ways(&derivative(&gyro[k], STEP_S))),
            products: [product(1, 2), product(2, 0)],
            across: low.both_ways(&across),
            velocity: smooth(body.clone()),
            force: smooth(axes(&force)),
            gyro_bias: gyro_bias(section),
            rates: smooth(gyro.clone()),
            logged: Logged { rates: gyro, velocity: body, force: axes(&force) },
            force_bias,
            inner: margin..count.saturating_sub(margin),
        }
    }

    /// Thrusts as a share of a full command's at the reference voltage, at the motors.
    pub(super) fn drive(&self, drive: &Drive) -> Driven {
        let low = LowPass::new(CORNER_HZ, RATE_HZ);
        let thrusts = self.thrusts(drive);
        let sum = |weights: [f64; 4]| -> Vec<f64> {
            let all: Vec<f64> =
                (0..thrusts[0].len()).map(|i| (0..4).map(|m| weights[m] * thrusts[m][i]).sum()).collect();
            low.both_ways(&all)
        };
        Driven {
            mixture: [sum(ROTOR_SIDES.map(|[_, y]| y)), sum(ROTOR_SIDES.map(|[x, _]| -x)), sum(ROTOR_TORQUE_SIGNS)],
            mean: sum([0.25; 4]),
        }
    }

    fn thrusts(&self, drive: &Drive) -> [Vec<f64>; 4] {
        self.asked(drive)
            .map(|asked| lagged(&shifted(&asked, -drive.delay_s / STEP_S), drive.rise_s, drive.fall_s, STEP_S))
    }

    /// The force asked of each motor at each point of the log.
    fn asked(&self, drive: &Drive) -> [Vec<f64>; 4] {
        let [p, q] = drive.powers;
        self.log_commands.each_ref().map(|command| {
            if self.log_voltage.is_empty() {
                command.iter().map(|u| (p * u).exp()).collect()
            } else {
                command.iter().zip(&self.log_voltage).map(|(u, v)| (p * u + q * v).exp()).collect()
            }
        })
    }

    /// The part of a signal that jumps, beyond its change around the jump.
    fn stairs(&self, asked: &[f64]) -> Vec<f64> {
        let mut stairs = vec![0.0; asked.len()];
        for &k in &self.jumps {
            stairs[k] = change_beyond(asked, k);
        }
        let mut sum = 0.0;
        stairs.iter_mut().for_each(|stair| {
            sum += *stair;
            *stair = sum;
        });
        stairs
    }

    /// Thrusts without a low-pass. A command is a smooth curve through its samples: its course between them is not in the
    /// log.
    pub(super) fn thrusts_between(&self, drive: &Drive) -> Thrusts {
        let count = self.log_commands[0].len();
        let steps = -drive.delay_s / STEP_S;
        let asked = self.asked(drive).map(|asked| {
            let stairs = self.stairs(&asked);
            let smooth: Vec<f64> = asked.iter().zip(&stairs).map(|(asked, stair)| asked - stair).collect();
            let stairs = shifted(&stairs, steps - drive.jump_s / STEP_S);
            shifted_smoothly(&smooth, steps)
                .into_iter()
                .zip(stairs)
                .map(|(smooth, stair)| smooth + stair)
                .collect::<Vec<f64>>()
        });
        let thrusts = asked.each_ref().map(|asked| lagged(asked, drive.rise_s, drive.fall_s, STEP_S));
        let rates: [Vec<f64>; 4] = std::array::from_fn(|m| {
            asked[m]
                .iter()
                .zip(&thrusts[m])
                .map(|(asked, f)| (asked - f) / if asked > f { drive.rise_s } else { drive.fall_s })
                .collect()
        });
        // Euler and Maclaurin: the trapezium, less the change of the slopes.
        let between: [Vec<f64>; 4] = std::array::from_fn(|m| {
            let (f, g) = (&thrusts[m], &rates[m]);
            (0..count)
                .map(|i| {
                    let next = (i + 1).min(count - 1);
                    0.5 * (f[i] + f[next]) - STEP_S / 12.0 * (g[next] - g[i])
                })
                .collect()
        });
        let mixed = |all: &[Vec<f64>; 4], weights: [f64; 4]| -> Vec<f64> {
            (0..count).map(|i| (0..4).map(|m| weights[m] * all[m][i]).sum()).collect()
        };
        let weights = [ROTOR_SIDES.map(|[_, y]| y), ROTOR_SIDES.map(|[x, _]| -x)];
        Thrusts {
            mixture: weights.map(|weights| mixed(&thrusts, weights)),
            between: weights.map(|weights| mixed(&between, weights)),
            mean: mixed(&thrusts, [0.25; 4]),
        }
    }

    /// The points that count, with their mean taken off.
    pub(super) fn centred(&self, signal: &[f64]) -> Vec<f64> {
        let inner = &signal[self.inner.clone()];
        let offset = mean(inner);
        inner.iter().map(|value| value - offset).collect()
    }
}

/// By how much a signal changes up to a point beyond the median of the changes around.
fn change_beyond(signal: &[f64], k: usize) -> f64 {
    let change = |i: usize| signal[i] - signal[i - 1];
    change(k) - median(&[change(k - 2), change(k - 1), change(k + 1), change(k + 2)])
}

/// Where all commands together change by far more than they do around, and than is usual.
fn jumps(commands: &[Vec<f64>; 4]) -> Vec<usize> {
    let count = commands[0].len();
    let sizes: Vec<f64> = (0..count)
        .map(|k| {
            let inside = k >= 3 && k + 3 < count;
            if inside { commands.iter().map(|u| change_beyond(u, k).powi(2)).sum::<f64>().sqrt() } else { 0.0 }
        })
        .collect();
    let least = (JUMP_SPREADS * median(&sizes)).max(JUMP_LEAST);
    (1..count.saturating_sub(1))
        .filter(|k| sizes[*k] > least && sizes[*k] >= sizes[k - 1] && sizes[*k] > sizes[k + 1])
        .collect()
}

/// The accelerometer's mean beyond gravity and the change of the velocity: in the world frame the mean of the
/// specific force is known from the velocity at both ends.
fn force_bias(section: &Section) -> Vector3<f64> {
    let count = section.len();
    // A tenth of a second at either end, since the velocity is noisy.
    let ends = (0.1 * RATE_HZ) as usize;
    let average = |from: usize| section.velocity[from..from + ends].iter().sum::<Vector3<f64>>() / ends as f64;
    let inner = ends / 2..count - ends / 2;
    let change = (average(count - ends) - average(0)) / ((count - ends) as f64 * STEP_S);
    let (mut turn, mut felt) = (Matrix3::zeros(), Vector3::zeros());
    for i in inner.clone() {
        turn += section.attitude[i].to_rotation_matrix().into_inner();
        felt += section.attitude[i] * section.specific_force[i];
    }
    let over = felt / inner.len() as f64 - change - Vector3::new(0.0, 0.0, GRAVITY_M_S2);
    (turn / inner.len() as f64).lu().solve(&over).unwrap_or_default()
}

/// The gyroscope's mean beyond the turning of the attitude.
fn gyro_bias(section: &Section) -> Vector3<f64> {
    let count = section.len();
    let turned = (1..count).fold(Vector3::zeros(), |sum, i| {
        sum + (section.attitude[i - 1].inverse() * section.attitude[i]).scaled_axis() / STEP_S
    });
    let shown = section.gyro.iter().fold(Vector3::zeros(), |sum, w| sum + w);
    shown / count as f64 - turned / (count - 1) as f64
}

/// All sections of some flights.
pub(super) fn prepared(flights: &[Flight], base: &Base) -> Vec<Prepared> {
    let sections = flights.iter().enumerate().flat_map(|(k, flight)| flight.sections.iter().map(move |s| (k, s)));
    sections.map(|(k, section)| Prepared::of(k, section, base)).filter(|one| one.inner.len() > 100).collect()
}
