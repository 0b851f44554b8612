//! Signals of the balances of torques and of thrust, low-passed: figures in, residuals out.
//!
//! Of body x and y: `M = J w' - c v + d w + b`, M the lagged motors' mixture; of z: `f = a_z` with drag and lift. The bias b
//! is each section's own mean.

use nalgebra::Vector3;

use super::prior::Base;
use super::{CORNER_HZ, MARGIN_S};
use crate::filter::{LowPass, derivative, lagged, mean, shifted};
use crate::flight::{Flight, RATE_HZ, STEP_S, Section};
use quatrack_design::model::GRAVITY_M_S2;
use quatrack_design::vehicle::{ROTOR_SIDES, ROTOR_TORQUE_SIGNS};

/// What the motors' command becomes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drive {
    pub(crate) rise_s: f64,
    pub(crate) fall_s: f64,
    pub(crate) delay_s: f64,
    /// Of command and voltage.
    pub(crate) powers: [f64; 2],
}

/// A section with all that does not depend on figures.
pub(super) struct Prepared {
    pub(super) flight: usize,
    pub(super) start_s: f64,
    commands: [Vec<f64>; 4],
    /// Over the reference.
    voltage: Vec<f64>,
    /// Low-passed: angular acceleration, body velocity, body rates, specific force.
    pub(super) angular: [Vec<f64>; 3],
    pub(super) velocity: [Vec<f64>; 3],
    pub(super) rates: [Vec<f64>; 3],
    pub(super) force: [Vec<f64>; 3],
    /// Products `w_y w_z` and `w_z w_x`.
    pub(super) products: [Vec<f64>; 2],
    /// Square of the velocity across the thrust.
    pub(super) across: Vec<f64>,
    /// What the accelerometer shows too much, by the velocity's change over the section.
    pub(super) force_bias: Vector3<f64>,
    /// What the gyroscope does, by the attitude's.
    pub(super) gyro_bias: Vector3<f64>,
    /// Points that count.
    pub(super) inner: std::ops::Range<usize>,
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
        let voltage = section.voltage.iter().map(|v| v / base.reference_v).collect();
        Self {
            flight,
            start_s: section.start_s,
            commands: section.commands.clone(),
            voltage,
            angular: [0, 1, 2].map(|k| low.both_ways(&derivative(&gyro[k], STEP_S))),
            products: [product(1, 2), product(2, 0)],
            across: low.both_ways(&across),
            velocity: smooth(body),
            force: smooth(axes(&force)),
            gyro_bias: gyro_bias(section),
            rates: smooth(gyro),
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
        let [p, q] = drive.powers;
        self.commands.each_ref().map(|command| {
            let asked: Vec<f64> = if self.voltage.is_empty() {
                command.iter().map(|u| u.powf(p)).collect()
            } else {
                command.iter().zip(&self.voltage).map(|(u, v)| u.powf(p) * v.powf(q)).collect()
            };
            lagged(&shifted(&asked, -drive.delay_s / STEP_S), drive.rise_s, drive.fall_s, STEP_S)
        })
    }

    /// The points that count, with their mean taken off.
    pub(super) fn centred(&self, signal: &[f64]) -> Vec<f64> {
        let inner = &signal[self.inner.clone()];
        let offset = mean(inner);
        inner.iter().map(|value| value - offset).collect()
    }
}

/// Whatever the accelerometer shows on average beyond gravity and the change of the velocity.
fn force_bias(section: &Section) -> Vector3<f64> {
    let count = section.len();
    let axes = [0, 1, 2].map(|k| section.velocity.iter().map(|v| v[k]).collect::<Vec<f64>>());
    let low = LowPass::new(2.0, RATE_HZ);
    let slopes = axes.map(|axis| derivative(&low.both_ways(&axis), STEP_S));
    let expected = (0..count).fold(Vector3::zeros(), |sum, i| {
        let acceleration = Vector3::new(slopes[0][i], slopes[1][i], slopes[2][i] + GRAVITY_M_S2);
        sum + section.attitude[i].inverse_transform_vector(&acceleration)
    });
    let felt = section.specific_force.iter().fold(Vector3::zeros(), |sum, f| sum + f);
    (felt - expected) / count as f64
}

/// What the gyroscope shows on average beyond the turning of the attitude.
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
