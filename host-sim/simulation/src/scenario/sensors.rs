//! Sensors between a craft and a law: white noise and biases, the same for the same seed.

use nalgebra::{UnitQuaternion, Vector3};

use super::flight::truth;
use crate::control_law::Estimate;
use crate::plant::{RigidState, Source, Stream};

/// Standard deviations of each component at every step of the flight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensorNoise {
    /// Gyroscope, rad/s.
    pub gyro_rad_s: f64,
    /// Accelerometer, m/s^2.
    pub accelerometer_m_s2: f64,
    /// Position, m.
    pub position_m: f64,
    /// Velocity, m/s.
    pub velocity_m_s: f64,
    /// Attitude, rad.
    pub attitude_rad: f64,
}

/// Noise, biases and where the noise is.
#[derive(Clone, Debug)]
pub struct Sensors {
    noise: SensorNoise,
    gyro_bias_rad_s: Vector3<f64>,
    accelerometer_bias_m_s2: Vector3<f64>,
    draws: bool,
    biased: bool,
    /// Gyroscope, accelerometer, position, velocity, attitude: the draws of one leave the others as they are.
    streams: [Stream; 5],
}

impl Sensors {
    /// With a seed.
    pub fn new(
        noise: SensorNoise,
        gyro_bias_rad_s: Vector3<f64>,
        accelerometer_bias_m_s2: Vector3<f64>,
        seed: u64,
    ) -> Self {
        let sources = [Source::Gyroscope, Source::Accelerometer, Source::Position, Source::Velocity, Source::Attitude];
        let streams = sources.map(|source| Stream::new(seed, source));
        let draws = noise != SensorNoise::default();
        let biased = gyro_bias_rad_s != Vector3::zeros() || accelerometer_bias_m_s2 != Vector3::zeros();
        Self { noise, gyro_bias_rad_s, accelerometer_bias_m_s2, draws, biased, streams }
    }

    /// Exact ones.
    pub fn exact() -> Self {
        Self::new(SensorNoise::default(), Vector3::zeros(), Vector3::zeros(), 0)
    }

    /// Measurements and estimate of a state.
    pub(super) fn estimate(&mut self, state: &RigidState, specific_force_m_s2: &Vector3<f64>) -> Estimate {
        let (truth, noise) = (truth(state, specific_force_m_s2), self.noise);
        let [gyro, accelerometer, position, velocity, attitude] = &mut self.streams;
        let turned = white(attitude, noise.attitude_rad).map(UnitQuaternion::from_scaled_axis);
        let or_none = |noise: Option<Vector3<f64>>| noise.unwrap_or_default();
        Estimate {
            position_m: truth.position_m + or_none(white(position, noise.position_m)),
            velocity_m_s: truth.velocity_m_s + or_none(white(velocity, noise.velocity_m_s)),
            attitude: turned.map_or(truth.attitude, |turn| truth.attitude * turn),
            body_rates_rad_s: truth.body_rates_rad_s + self.gyro_bias_rad_s + or_none(white(gyro, noise.gyro_rad_s)),
            specific_force_m_s2: truth.specific_force_m_s2
                + self.accelerometer_bias_m_s2
                + or_none(white(accelerometer, noise.accelerometer_m_s2)),
        }
    }

    /// Draws as many numbers as estimates at this many steps.
    #[inline]
    pub(super) fn pass_over(&mut self, steps: u32) {
        if self.draws() {
            self.draw(steps);
        }
    }

    fn draw(&mut self, steps: u32) {
        let SensorNoise { gyro_rad_s, accelerometer_m_s2, position_m, velocity_m_s, attitude_rad } = self.noise;
        let deviations = [gyro_rad_s, accelerometer_m_s2, position_m, velocity_m_s, attitude_rad];
        for (stream, deviation) in self.streams.iter_mut().zip(deviations) {
            for _ in 0..steps {
                white(stream, deviation);
            }
        }
    }

    /// Whether the measurements are the truth.
    #[inline]
    pub(super) fn are_exact(&self) -> bool {
        !self.draws && !self.biased
    }

    /// Whether an estimate changes those after it: each draws from the streams of the noisy sensors.
    pub(super) fn draws(&self) -> bool {
        self.draws
    }
}

/// Nothing, and nothing drawn, without noise.
fn white(stream: &mut Stream, deviation: f64) -> Option<Vector3<f64>> {
    (deviation != 0.0).then(|| Vector3::from_fn(|_, _| deviation * stream.normal()))
}
