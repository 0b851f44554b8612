//! The paper's model (1): state and input in, state derivative out.
//!
//! Written once over any number type, so that the same lines are simulated (`f64`) and differentiated (complex step, in
//! [`linear`]). The quaternion enters as it is, without normalisation: the paper's matrices (9) are the derivatives of
//! this form, in which the thrust axis is a homogeneous quadratic of the quaternion.

pub mod flat;
pub mod linear;

use nalgebra::{ComplexField, SVector, Vector3, Vector4};

/// Gravitational acceleration of the paper, m/s^2.
pub const GRAVITY_M_S2: f64 = 9.81;

/// State `x = [r(3) q(4) v(3)]` of (2a): position m, quaternion scalar first, velocity m/s, world frame.
pub type StateVector<T = f64> = SVector<T, 10>;

/// Input `u = [T p q r]` of (2b): thrust m/s^2, body rates rad/s.
pub type InputVector<T = f64> = SVector<T, 4>;

/// Index of the first position component in [`StateVector`].
pub const POSITION: usize = 0;
/// Index of the scalar part of the quaternion in [`StateVector`].
pub const ATTITUDE: usize = 3;
/// Index of the first velocity component in [`StateVector`].
pub const VELOCITY: usize = 7;

/// Names of the state's components in order, with their units.
pub const STATE_NAMES: [&str; 10] = ["x_m", "y_m", "z_m", "q0", "q1", "q2", "q3", "vx_m_s", "vy_m_s", "vz_m_s"];
/// Names of the input's components in order, with their units.
pub const INPUT_NAMES: [&str; 4] = ["thrust_m_s2", "p_rad_s", "q_rad_s", "r_rad_s"];

/// Hover at the origin, heading 0: the equilibrium (8a).
pub fn hover_state() -> StateVector {
    let mut x = StateVector::zeros();
    x[ATTITUDE] = 1.0;
    x
}

/// The input that holds the hover: (8b).
pub fn hover_input() -> InputVector {
    InputVector::new(GRAVITY_M_S2, 0.0, 0.0, 0.0)
}

/// Position part of the state, m.
pub fn position(x: &StateVector) -> Vector3<f64> {
    x.fixed_rows::<3>(POSITION).into_owned()
}

/// Quaternion part of the state, scalar first, as it is.
pub fn attitude(x: &StateVector) -> Vector4<f64> {
    x.fixed_rows::<4>(ATTITUDE).into_owned()
}

/// Velocity part of the state, m/s.
pub fn velocity(x: &StateVector) -> Vector3<f64> {
    x.fixed_rows::<3>(VELOCITY).into_owned()
}

/// The state whose quaternion has norm 1, the constraint (13).
pub fn normalised(x: &StateVector) -> StateVector {
    let norm = attitude(x).norm();
    let mut unit = *x;
    unit.fixed_rows_mut::<4>(ATTITUDE).unscale_mut(norm);
    unit
}

/// Body z axis in the world frame, `q z q*`, quadratic in the quaternion.
pub fn thrust_axis<T: ComplexField + Copy>(q: &Vector4<T>) -> Vector3<T> {
    let (q0, q1, q2, q3) = (q[0], q[1], q[2], q[3]);
    let two = T::one() + T::one();
    Vector3::new(two * (q1 * q3 + q0 * q2), two * (q2 * q3 - q0 * q1), q0 * q0 - q1 * q1 - q2 * q2 + q3 * q3)
}

/// State derivative (1): `r'' = T q z q* - g z`, `q' = 1/2 q (0, omega)`.
pub fn dynamics<T: ComplexField + Copy>(x: &StateVector<T>, u: &InputVector<T>) -> StateVector<T> {
    let (q0, q1, q2, q3) = (x[3], x[4], x[5], x[6]);
    let (thrust, p, q, r) = (u[0], u[1], u[2], u[3]);
    let half = T::from_subset(&0.5);
    let axis = thrust_axis(&Vector4::new(q0, q1, q2, q3));
    StateVector::<T>::from([
        x[7],
        x[8],
        x[9],
        -half * (q1 * p + q2 * q + q3 * r),
        half * (q0 * p + q2 * r - q3 * q),
        half * (q0 * q + q3 * p - q1 * r),
        half * (q0 * r + q1 * q - q2 * p),
        thrust * axis[0],
        thrust * axis[1],
        thrust * axis[2] - T::from_subset(&GRAVITY_M_S2),
    ])
}
