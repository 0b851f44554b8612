//! The cascade's gains: a vehicle, the lag of its motors and weights in; the gains of its four chains out.
//!
//! The LQR at hover of the rigid craft with motors that lag, on the model of [`mod@super::actuator_aware`] without the
//! integral of the position: observers take the place of the integral in flight, and without it a stiffer gain is far
//! from its limits. The air is no part of the model: it is fed forward, and a certificate looks at its remainder.

use nalgebra::DMatrix;
use num_complex::Complex64;
use serde::Serialize;

use super::actuator_aware::{FORCES, PLANT_STATES, hover_pair};
use super::discretise::{Held, require_period, zero_order_hold};
use super::synthesis::{diagonal, without_noise};
use super::{DesignError, dlqr};
use crate::vehicle::Vehicle;

/// Diagonal weights of a sum over the samples; forces have none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CascadeWeights {
    /// Weights of the position, 1/m^2.
    pub position: [f64; 3],
    /// Weights of the velocity, s^2/m^2.
    pub velocity: [f64; 3],
    /// Weights of the rotation vector, 1/rad^2.
    pub rotation: [f64; 3],
    /// Weights of the body rates, s^2/rad^2.
    pub body_rates: [f64; 3],
    /// Weight of each motor's command, 1/N^2.
    pub command: f64,
}

impl CascadeWeights {
    /// For 500 Hz: about 10 1/s^2 and 5 1/s from position and velocity to acceleration, sideways, at every lag that
    /// Crazyflies have.
    pub const STANDARD: Self = Self {
        position: [2000.0, 2000.0, 4000.0],
        velocity: [100.0, 100.0, 500.0],
        rotation: [200.0, 200.0, 5.0],
        body_rates: [4.0, 4.0, 0.1],
        command: 1e4,
    };

    /// The standard ones for a lag of the motors, s: beyond 63.5 ms with more of the vertical velocity, 944 at 100 ms. Thrust that comes
    /// late wants a height that is damped the more: with 500, the slowest vertical mode of a craft at the corner of the region of
    /// 50 to 126 ms has a radius of 0.9975 where it has 0.9968.
    pub fn for_lag(lag_s: f64) -> Self {
        let [x, y, z] = Self::STANDARD.velocity;
        let slower = (lag_s / Self::STANDARD_TO_LAG_S).max(1.0);
        Self { velocity: [x, y, (z * slower.powf(1.4)).round()], ..Self::STANDARD }
    }

    /// Longest lag of the motors for which the standard weights are taken as they are, s.
    const STANDARD_TO_LAG_S: f64 = 0.0635;

    /// Diagonal of Q, in the order of the states.
    pub fn state(&self) -> Vec<f64> {
        let Self { position, velocity, rotation, body_rates, .. } = self;
        [position, velocity, rotation, body_rates].into_iter().flatten().copied().chain([0.0; 4]).collect()
    }
}

/// Gains for a vehicle whose motors have one lag.
#[derive(Debug, Clone)]
pub struct CascadeDesign {
    /// K, 4 x 16, with commands and forces in orthonormal parts: thrust, roll, pitch, yaw.
    pub gain_in_parts: DMatrix<f64>,
    /// P of the Riccati equation, 16 x 16.
    pub p: DMatrix<f64>,
    /// The problem under held commands that P and the gain solve.
    pub held: Held,
    /// Poles per sample.
    pub poles: Vec<Complex64>,
    /// Relative residual of P, evaluated in 32 digits.
    pub relative_residual: f64,
    /// Last Newton correction over P.
    pub last_correction: f64,
}

/// Number of gains.
pub const GAINS: usize = 16;

impl CascadeDesign {
    /// The gains, chain by chain: height (position, velocity, force), roll and pitch (position, velocity, rotation,
    /// body rate, force), yaw (rotation, body rate, force). Forces in parts that add up to a motor's, each half of an
    /// orthonormal one.
    pub fn numbers(&self) -> [f64; GAINS] {
        let k = &self.gain_in_parts;
        // Of states, of which half goes to a part; of the part's own force.
        let of = |part: usize, state: usize| 0.5 * k[(part, state)];
        let force = |part: usize| k[(part, FORCES + part)];
        let (z, roll, pitch, yaw) = (0, 1, 2, 3);
        let [x, y, height, velocity, rotation, rate] = [0, 1, 2, 3, 6, 9];
        [
            of(z, height),
            of(z, velocity + height),
            force(z),
            of(roll, y),
            of(roll, velocity + y),
            of(roll, rotation + x),
            of(roll, rate + x),
            force(roll),
            of(pitch, x),
            of(pitch, velocity + x),
            of(pitch, rotation + y),
            of(pitch, rate + y),
            force(pitch),
            of(yaw, rotation + height),
            of(yaw, rate + height),
            force(yaw),
        ]
    }
}

/// The optimal feedback at a control rate for motors with the lag `lag_s`.
///
/// # Errors
/// [`DesignError::Period`] for a lag or a period that is not positive; [`dlqr`]'s about the weights.
pub fn cascade(
    vehicle: &Vehicle,
    lag_s: f64,
    weights: &CascadeWeights,
    period_s: f64,
) -> Result<CascadeDesign, DesignError> {
    require_period(lag_s)?;
    let (a, b) = hover_pair(vehicle, lag_s, 1.0, 1.0);
    let held = zero_order_hold(&a, &b, period_s)?;
    debug_assert_eq!(held.a.nrows(), PLANT_STATES);
    // The parts are orthonormal: equal weights of the motors are the same weights of the parts.
    let solution = dlqr(&held.a, &held.b, &diagonal(&weights.state()), &diagonal(&[weights.command; 4]))?;
    Ok(CascadeDesign {
        gain_in_parts: without_noise(&solution.gain),
        p: solution.p,
        held,
        poles: solution.poles,
        relative_residual: solution.relative_residual,
        last_correction: solution.last_correction,
    })
}
