//! The two slips in the published simulation, without which Table I does not come out. They live here alone.
//!
//! A. The attitude of the reference: roll and pitch are computed in Z-Y-X order, but turned into a quaternion as X-Y-Z.
//!    `q3` of the reference is then not 0, and its thrust axis is not the one that the acceleration asks for.
//! B. In Phi, `dq0/dt` uses `T j_z - T'` where `T j_z - (a_z + g) T'` is right; the quotient rule carries the error on
//!    to `dq1/dt`, `dq2/dt` and with them to the body rates.

use nalgebra::{Quaternion, SVector, Vector3, Vector4};
use quatrack_design::model::flat::{ReferencePoint, Thrust, reference_point};
use quatrack_design::model::{
    ATTITUDE, GRAVITY_M_S2, InputVector, StateVector, attitude, hover_input, position, thrust_axis, velocity,
};
use quatrack_plan::trajectory::Trajectory;

use crate::flight::law::{EquilibriumGain, FlatOutputGain};

/// The reference with slip A.
pub fn reference(trajectory: &dyn Trajectory, t_s: f64) -> ReferencePoint {
    let mut point = reference_point(&trajectory.at(t_s));
    let n = thrust_axis(&attitude(&point.state));
    let (half_roll, half_pitch) = (-0.5 * n.y.asin(), 0.5 * n.x.atan2(n.z));
    let (s1, c1) = half_roll.sin_cos();
    let (s2, c2) = half_pitch.sin_cos();
    point.state.fixed_rows_mut::<4>(ATTITUDE).copy_from(&Vector4::new(c1 * c2, s1 * c2, c1 * s2, s1 * s2));
    point
}

/// (LYAP-E), (LQR-E) as simulated: the controller has no slip of its own.
pub fn equilibrium_input(gain: &EquilibriumGain, state: &StateVector, target: &ReferencePoint) -> InputVector {
    let error = state - target.state;
    // S_c T_e takes delta q0 out.
    let reduced = SVector::<f64, 9>::from_fn(|i, _| error[if i < 3 { i } else { i + 1 }]);
    hover_input() - gain * reduced
}

/// (LYAP-F), (LQR-F) as simulated, with slip B in Phi.
pub fn flat_output_input(gain: &FlatOutputGain, state: &StateVector, target: &ReferencePoint) -> InputVector {
    let thrust = target.input[0];
    let flat_state = |x: &StateVector| {
        let acceleration = thrust_axis(&attitude(x)) * thrust - Vector3::new(0.0, 0.0, GRAVITY_M_S2);
        let (r, v) = (position(x), velocity(x));
        SVector::<f64, 10>::from_iterator(
            r.iter().chain(v.iter()).chain(acceleration.iter()).copied().chain([x[ATTITUDE + 3]]),
        )
    };
    let z = flat_state(state);
    let v = -gain * (z - flat_state(&target.state));
    phi_with_slip(&v.fixed_rows::<3>(0).into_owned(), &v.fixed_rows::<3>(3).into_owned(), z[9], v[6])
}

/// Phi with slip B: body rates from `(0, p, q, r) = 2 q* dq/dt`.
fn phi_with_slip(acceleration: &Vector3<f64>, jerk: &Vector3<f64>, q3: f64, q3_rate: f64) -> InputVector {
    let thrust = Thrust::new(acceleration, jerk);
    let (magnitude, n, n_rate) = (thrust.magnitude_m_s2, thrust.axis, thrust.axis_rate);
    let q = thrust.attitude_with_q3(q3);
    let slip = (magnitude * jerk.z - thrust.rate_m_s3) / (2.0 * magnitude * magnitude);
    let q0_rate = (slip - 2.0 * q3 * q3_rate) / (2.0 * q[0]);
    let s = q[0] * q[0] + q3 * q3;
    let s_rate = 2.0 * q[0] * q0_rate + 2.0 * q3 * q3_rate;
    let q1_rate = (q3_rate * n.x + q3 * n_rate.x - q0_rate * n.y - q[0] * n_rate.y) / (2.0 * s) - q[1] * s_rate / s;
    let q2_rate = (q0_rate * n.x + q[0] * n_rate.x + q3_rate * n.y + q3 * n_rate.y) / (2.0 * s) - q[2] * s_rate / s;
    let conjugate = Quaternion::new(q[0], -q[1], -q[2], -q[3]);
    let rates = conjugate * Quaternion::new(q0_rate, q1_rate, q2_rate, q3_rate) * 2.0;
    InputVector::new(magnitude, rates.i, rates.j, rates.k)
}
