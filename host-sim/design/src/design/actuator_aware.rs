//! Actuator-aware LQI: a vehicle, the lag of its motors and weights in; a gain from 19 errors to four motor forces out.
//!
//! The hover linearisation of the paper, carried on to the motors: `r' = v`, `v' = g (theta_y, -theta_x, 0) + T z / m`,
//! `theta' = omega`, `I omega' = tau`, `lag f' = u - f`, with the rotation vector theta of `q_r^-1 q` and deviations from
//! hover throughout. Forces enter in parts, `e = H f`, with the orthonormal sign patterns H of thrust, roll, pitch and
//! yaw: on an X with equal arms and a diagonal inertia the model then decouples into four chains, z, y, x and heading,
//! and so does the gain. The controller adds the sum of the position error, `i+ = i + h r`, as the command sees it: before
//! the present error is added.

use nalgebra::{DMatrix, Matrix4};
use num_complex::Complex64;
use serde::Serialize;

use super::discretise::{Held, require_period, zero_order_hold};
use super::synthesis::{diagonal, without_noise};
use super::{DesignError, dlqr};
use crate::model::GRAVITY_M_S2;
use crate::vehicle::{ROTOR_SIDES, ROTOR_TORQUE_SIGNS, Vehicle};

/// States of the plant: position, velocity, rotation vector, body rates, forces.
pub const PLANT_STATES: usize = 16;
/// Errors that the gain takes: those and the integral of the position error.
pub const ERRORS: usize = 19;
/// Where the forces begin among them.
pub const FORCES: usize = 12;

/// Diagonal weights of a sum over the samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ActuatorAwareWeights {
    /// Weights of the position, 1/m^2.
    pub position: [f64; 3],
    /// Weights of the velocity, s^2/m^2.
    pub velocity: [f64; 3],
    /// Weights of the rotation vector, 1/rad^2.
    pub rotation: [f64; 3],
    /// Weights of the body rates, s^2/rad^2.
    pub body_rates: [f64; 3],
    /// Weight of each motor's force, 1/N^2.
    pub force: f64,
    /// Of the integral of the position, 1/(m s)^2.
    pub integral: [f64; 3],
    /// Weight of each motor's command, 1/N^2.
    pub command: f64,
}

impl ActuatorAwareWeights {
    /// For 500 Hz. Height, velocity and the body rates weigh so much that a wrong mass, lag or inertia, a delay and noise
    /// cost little; sideways no more than lets a Crazyflie take a step of 1 m with its motors at their limits.
    pub const STANDARD: Self = Self {
        position: [60.0, 60.0, 200.0],
        velocity: [60.0, 60.0, 1500.0],
        rotation: [50.0, 50.0, 5.0],
        body_rates: [0.4, 0.4, 0.1],
        force: 0.0,
        integral: [200.0, 200.0, 7500.0],
        command: 1e4,
    };

    /// Diagonal of Q, in the order of the errors.
    pub fn state(&self) -> Vec<f64> {
        let Self { position, velocity, rotation, body_rates, force, integral, .. } = self;
        [position, velocity, rotation, body_rates]
            .into_iter()
            .flatten()
            .copied()
            .chain([*force; 4])
            .chain(*integral)
            .collect()
    }
}

/// A gain for a vehicle whose motors have one lag.
#[derive(Debug, Clone)]
pub struct ActuatorAwareDesign {
    /// K, 4 x 19, for `u = f_r + lag f_r' - K e`; rows the motors, N.
    pub gain: DMatrix<f64>,
    /// The same with commands and forces in parts: thrust, roll, pitch, yaw.
    pub gain_in_parts: DMatrix<f64>,
    /// P of the Riccati equation, 19 x 19.
    pub p: DMatrix<f64>,
    /// The problem under held commands that P and the gain solve, the sum of the position error as three more states.
    pub held: Held,
    /// Poles per sample.
    pub poles: Vec<Complex64>,
    /// Relative residual of P, evaluated in 32 digits.
    pub relative_residual: f64,
    /// Last Newton correction over P.
    pub last_correction: f64,
}

/// H: orthonormal patterns of thrust, roll, pitch and yaw in the forces of the motors; its inverse is its transpose.
pub fn parts() -> Matrix4<f64> {
    Matrix4::from_fn(|part, motor| {
        let [x, y] = ROTOR_SIDES[motor];
        0.5 * [1.0, y, -x, ROTOR_TORQUE_SIGNS[motor]][part]
    })
}

/// The hover model with forces in parts: `(A, B)`, 16 x 16 and 16 x 4, for motors of one lag and the vehicle's mass and
/// inertia multiplied by factors.
pub fn hover_pair(
    vehicle: &Vehicle,
    lag_s: f64,
    mass_factor: f64,
    inertia_factor: f64,
) -> (DMatrix<f64>, DMatrix<f64>) {
    let mut a = DMatrix::zeros(PLANT_STATES, PLANT_STATES);
    let mut b = DMatrix::zeros(PLANT_STATES, 4);
    for i in 0..3 {
        a[(i, 3 + i)] = 1.0;
        a[(6 + i, 9 + i)] = 1.0;
    }
    a[(3, 7)] = GRAVITY_M_S2;
    a[(4, 6)] = -GRAVITY_M_S2;
    // Force and torque a unit of each part.
    let wrench = vehicle.motors().mixing() * parts().transpose();
    let angular = vehicle.inverse_inertia() * wrench.fixed_rows::<3>(1) / inertia_factor;
    for part in 0..4 {
        a[(5, FORCES + part)] = wrench[(0, part)] / (mass_factor * vehicle.mass_kg());
        for i in 0..3 {
            a[(9 + i, FORCES + part)] = angular[(i, part)];
        }
        a[(FORCES + part, FORCES + part)] = -1.0 / lag_s;
        b[(FORCES + part, part)] = 1.0 / lag_s;
    }
    (a, b)
}

/// The optimal feedback at a control rate for motors with the lag `lag_s`.
///
/// # Errors
/// [`DesignError::Period`] for a lag or a period that is not positive; [`dlqr`]'s about the weights.
pub fn actuator_aware(
    vehicle: &Vehicle,
    lag_s: f64,
    weights: &ActuatorAwareWeights,
    period_s: f64,
) -> Result<ActuatorAwareDesign, DesignError> {
    require_period(lag_s)?;
    let (a, b) = hover_pair(vehicle, lag_s, 1.0, 1.0);
    let held = zero_order_hold(&a, &b, period_s)?;
    let mut a = held.a.resize(ERRORS, ERRORS, 0.0);
    for i in 0..3 {
        a[(PLANT_STATES + i, i)] = period_s;
        a[(PLANT_STATES + i, PLANT_STATES + i)] = 1.0;
    }
    let b = held.b.resize_vertically(ERRORS, 0.0);
    // H is orthonormal: equal weights of the motors are the same weights of the parts.
    let solution = dlqr(&a, &b, &diagonal(&weights.state()), &diagonal(&[weights.command; 4]))?;
    let gain_in_parts = without_noise(&solution.gain);
    Ok(ActuatorAwareDesign {
        gain: of_motors(&gain_in_parts),
        gain_in_parts,
        p: changed_on_both_sides(&solution.p),
        held: Held { a: changed_on_both_sides(&a), b: of_motors_input(&b), period_s },
        poles: solution.poles,
        relative_residual: solution.relative_residual,
        last_correction: solution.last_correction,
    })
}

/// A gain 4 x 19 in parts as one of motors.
///
/// Entries that the symmetry of the craft makes equal in size are so to the last bit: each is the same sum.
pub fn of_motors(in_parts: &DMatrix<f64>) -> DMatrix<f64> {
    changed(in_parts, &parts().transpose())
}

/// The reverse of [`of_motors`].
pub fn in_parts(of_motors: &DMatrix<f64>) -> DMatrix<f64> {
    changed(of_motors, &parts())
}

/// The hover model with forces of the motors and the integral of the position error: 19 x 19 and 19 x 4.
pub fn hover_pair_with_integral(vehicle: &Vehicle, lag_s: f64) -> (DMatrix<f64>, DMatrix<f64>) {
    let (a, b) = hover_pair(vehicle, lag_s, 1.0, 1.0);
    let mut a = a.resize(ERRORS, ERRORS, 0.0);
    for i in 0..3 {
        a[(PLANT_STATES + i, i)] = 1.0;
    }
    (changed_on_both_sides(&a), of_motors_input(&b.resize_vertically(ERRORS, 0.0)))
}

/// diag(1, H, 1), 19 x 19: from forces of the motors to parts.
fn to_parts() -> DMatrix<f64> {
    let mut whole = DMatrix::identity(ERRORS, ERRORS);
    whole.view_mut((FORCES, FORCES), (4, 4)).copy_from(&parts());
    whole
}

/// A matrix of states in parts as one of states with the motors' forces.
fn changed_on_both_sides(in_parts: &DMatrix<f64>) -> DMatrix<f64> {
    to_parts().transpose() * in_parts * to_parts()
}

/// The map from commands in parts to states in parts, of the motors' both.
fn of_motors_input(in_parts: &DMatrix<f64>) -> DMatrix<f64> {
    let h = parts();
    to_parts().transpose() * in_parts * DMatrix::from_fn(4, 4, |i, j| h[(i, j)])
}

/// `M K diag(1, M', 1)`.
fn changed(gain: &DMatrix<f64>, m: &Matrix4<f64>) -> DMatrix<f64> {
    let mut columns = gain.clone();
    for row in 0..4 {
        for j in 0..4 {
            columns[(row, FORCES + j)] = (0..4).map(|k| gain[(row, FORCES + k)] * m[(j, k)]).sum();
        }
    }
    DMatrix::from_fn(4, ERRORS, |i, j| (0..4).map(|k| m[(i, k)] * columns[(k, j)]).sum())
}
