//! A craft in air, flown on an eight by a simple law that knows its true state, and its sensors' readings. f64, 1
//! kHz.

use nalgebra::{UnitQuaternion, Vector3};
use quatrack::estimator::{DeviationsAtStart, EstimatorConfig, Force, Gate, Imu, Integration, noise_density};
use quatrack::{Quaternion, State};

pub(crate) const STEP_S: f64 = 0.001;
/// Drag over mass along the body axes, 1/s: that of a Crazyflie 2.1 Brushless (identified from arXiv 2512.14450's
/// flights).
pub(crate) const DRAG_PER_S: [f64; 3] = [0.447, 0.435, 0.45];
/// Standard deviations of a sample.
pub(crate) const GYRO_RAD_S: f64 = 0.02;
pub(crate) const ACCELEROMETER_M_S2: f64 = 0.5;
pub(crate) const POSITION_M: f64 = 1e-3;
/// White acceleration along body x and y that nothing measures, m/s^2 per root hertz.
const GUST: f64 = 0.03;
const GRAVITY: f64 = 9.81;

/// A config with the true figures.
pub(crate) fn told_the_truth() -> EstimatorConfig {
    let hz = (1.0 / STEP_S) as f32;
    let accelerometer = noise_density(ACCELEROMETER_M_S2 as f32, hz);
    EstimatorConfig {
        force: Force::ThrustAxis,
        integration: Integration::SecondOrder,
        drag_per_s: [DRAG_PER_S[0] as f32, DRAG_PER_S[1] as f32],
        acceleration_noise: [GUST as f32, GUST as f32, accelerometer],
        gyro_noise: [noise_density(GYRO_RAD_S as f32, hz); 3],
        at_start: DeviationsAtStart { position_m: 0.01, velocity_m_s: 0.1, tilt_rad: 0.02, heading_rad: 0.05 },
        deviation_min: 1e-5,
        deviation_max: 10.0,
        gate: Gate::Open,
    }
}

/// Standard normal numbers by a counter: the same for the same seed and order.
pub(crate) struct Normal {
    seed: u64,
    count: u64,
}

impl Normal {
    pub(crate) fn new(seed: u64) -> Self {
        Self { seed, count: 0 }
    }

    /// SplitMix64's output function on a counter, as a number above 0 and up to 1.
    fn uniform(&mut self) -> f64 {
        self.count += 1;
        let mut x =
            self.seed.wrapping_mul(0xd134_2543_de82_ef95).wrapping_add(self.count.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64 + 1.0 / (1_u64 << 54) as f64
    }

    pub(crate) fn next(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }

    pub(crate) fn vector(&mut self, deviation: f64) -> Vector3<f64> {
        Vector3::new(self.next(), self.next(), self.next()) * deviation
    }
}

/// The true state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Truth {
    pub(crate) position: Vector3<f64>,
    pub(crate) velocity: Vector3<f64>,
    pub(crate) attitude: UnitQuaternion<f64>,
}

/// A flight.
pub(crate) struct Flight {
    pub(crate) truth: Truth,
    pub(crate) noise: Normal,
    steps: u32,
}

pub(crate) fn f32s(v: &Vector3<f64>) -> Vector3<f32> {
    v.map(|x| x as f32)
}

/// An eight of 2.1 m/s at its peak, up and down on the way.
fn course(time: f64) -> [Vector3<f64>; 3] {
    let (w, a, b, c) = (1.4, 1.0, 0.55, 0.2);
    let (s1, c1) = (w * time).sin_cos();
    let (s2, c2) = (2.0 * w * time).sin_cos();
    [
        Vector3::new(a * s1, b * s2, 1.0 + c * s2),
        Vector3::new(a * w * c1, 2.0 * w * b * c2, 2.0 * w * c * c2),
        Vector3::new(-a * w * w * s1, -4.0 * w * w * b * s2, -4.0 * w * w * c * s2),
    ]
}

impl Flight {
    pub(crate) fn new(seed: u64) -> Self {
        let [position, velocity, _] = course(0.0);
        let truth = Truth { position, velocity, attitude: UnitQuaternion::identity() };
        Self { truth, noise: Normal::new(seed), steps: 0 }
    }

    /// A millisecond on: the readings of gyroscope and accelerometer in it.
    pub(crate) fn step(&mut self) -> Imu {
        let time = f64::from(self.steps) * STEP_S;
        self.steps += 1;
        let [to, at, asked] = course(time);
        let Truth { position, velocity, attitude } = self.truth;
        let thrust =
            asked + (to - position) * 9.0 + (at - velocity) * 5.0 + Vector3::z() * GRAVITY + velocity * DRAG_PER_S[0];
        let axis = attitude * Vector3::z();
        let rates = attitude.inverse() * axis.cross(&thrust.normalize()) * 10.0 + Vector3::z() * (0.8 * time.cos());
        // Constant body rates and specific force over the millisecond; its second-order terms are below 1e-9 m.
        let gust = GUST / STEP_S.sqrt();
        let body = attitude.inverse() * velocity;
        let pushed = Vector3::new(gust * self.noise.next(), gust * self.noise.next(), thrust.dot(&axis));
        let force = pushed - Vector3::from(DRAG_PER_S).component_mul(&body);
        let mean = force + rates.cross(&force) * (0.5 * STEP_S);
        let acceleration = attitude * mean - Vector3::z() * GRAVITY;
        self.truth = Truth {
            position: position + (velocity + acceleration * (0.5 * STEP_S)) * STEP_S,
            velocity: velocity + acceleration * STEP_S,
            attitude: attitude * UnitQuaternion::from_scaled_axis(rates * STEP_S),
        };
        Imu {
            body_rates_rad_s: f32s(&(rates + self.noise.vector(GYRO_RAD_S))),
            specific_force_m_s2: f32s(&(force + self.noise.vector(ACCELEROMETER_M_S2))),
        }
    }

    /// A measured position.
    pub(crate) fn position(&mut self) -> Vector3<f32> {
        let noise = self.noise.vector(POSITION_M);
        f32s(&(self.truth.position + noise))
    }

    /// The true state with an error drawn from these deviations.
    pub(crate) fn guess(&mut self, at_start: &DeviationsAtStart) -> State {
        let [r, v, tilt, heading] =
            [at_start.position_m, at_start.velocity_m_s, at_start.tilt_rad, at_start.heading_rad].map(f64::from);
        let position = self.truth.position - self.noise.vector(r);
        let velocity = self.truth.velocity - self.noise.vector(v);
        let error = Vector3::new(tilt * self.noise.next(), tilt * self.noise.next(), heading * self.noise.next());
        let attitude = self.truth.attitude * UnitQuaternion::from_scaled_axis(-error);
        let q = attitude.quaternion();
        State {
            position_m: f32s(&position),
            attitude: Quaternion::new(q.w as f32, q.i as f32, q.j as f32, q.k as f32),
            velocity_m_s: f32s(&velocity),
        }
    }
}
