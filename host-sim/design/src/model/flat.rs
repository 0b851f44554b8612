//! The flat map Phi (5) in f64, from the text of the paper: acceleration, jerk and heading in; state and input out.
//!
//! Written from rotation matrices and nalgebra's own quaternion, so that it shares no line with the `f32` core that it
//! is compared with.

use nalgebra::{Quaternion, UnitQuaternion, Vector3, Vector4};

use super::{GRAVITY_M_S2, InputVector, StateVector};

/// The flat output and its derivatives at one time, world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatSample {
    /// Position, m.
    pub position_m: Vector3<f64>,
    /// Velocity, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Acceleration without gravity, m/s^2.
    pub acceleration_m_s2: Vector3<f64>,
    /// Jerk, m/s^3.
    pub jerk_m_s3: Vector3<f64>,
    /// Heading psi of `q = q_tilt(n) q_z(psi)`, rad.
    pub heading_rad: f64,
    /// Its time derivative, rad/s.
    pub heading_rate_rad_s: f64,
}

/// A point of a reference: the state that the laws compare the craft with, and the input that they may feed forward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferencePoint {
    /// State `x_r`, unit quaternion.
    pub state: StateVector,
    /// Input `u_r`.
    pub input: InputVector,
    /// Acceleration without gravity, m/s^2.
    pub acceleration_m_s2: Vector3<f64>,
    /// Jerk, m/s^3.
    pub jerk_m_s3: Vector3<f64>,
    /// Heading psi, rad.
    pub heading_rad: f64,
    /// Its rate, rad/s.
    pub heading_rate_rad_s: f64,
}

/// Thrust, its direction, and how both change.
#[derive(Clone, Copy, Debug)]
pub struct Thrust {
    /// `T = |a + g z|`, m/s^2.
    pub magnitude_m_s2: f64,
    /// `T'`, m/s^3.
    pub rate_m_s3: f64,
    /// `n = (a + g z) / T`.
    pub axis: Vector3<f64>,
    /// `n'`, 1/s.
    pub axis_rate: Vector3<f64>,
}

impl Thrust {
    /// From acceleration and jerk.
    pub fn new(acceleration_m_s2: &Vector3<f64>, jerk_m_s3: &Vector3<f64>) -> Self {
        let h = acceleration_m_s2 + Vector3::new(0.0, 0.0, GRAVITY_M_S2);
        let magnitude_m_s2 = h.norm();
        let axis = h / magnitude_m_s2;
        let rate_m_s3 = axis.dot(jerk_m_s3);
        Self { magnitude_m_s2, rate_m_s3, axis, axis_rate: (jerk_m_s3 - axis * rate_m_s3) / magnitude_m_s2 }
    }

    /// The attitude with this thrust axis and a given `q3`, scalar first; NaN where `|q3| > cos(tilt/2)`.
    pub fn attitude_with_q3(&self, q3: f64) -> Vector4<f64> {
        let (n, s) = (self.axis, 0.5 * (1.0 + self.axis.z));
        let q0 = (s - q3 * q3).sqrt();
        Vector4::new(q0, (q3 * n.x - q0 * n.y) / (2.0 * s), (q0 * n.x + q3 * n.y) / (2.0 * s), q3)
    }

    /// Body rates `p = -y_B . n'`, `q = x_B . n'`.
    fn roll_pitch_rates(&self, attitude: &Vector4<f64>) -> (f64, f64) {
        let rotation = unit(attitude).to_rotation_matrix();
        let matrix = rotation.matrix();
        (-matrix.column(1).dot(&self.axis_rate), matrix.column(0).dot(&self.axis_rate))
    }
}

/// A quaternion vector, scalar first, as nalgebra's.
pub fn unit(q: &Vector4<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3]))
}

/// nalgebra's quaternion as a vector, scalar first.
pub fn scalar_first(q: &UnitQuaternion<f64>) -> Vector4<f64> {
    Vector4::new(q.w, q.i, q.j, q.k)
}

/// Phi in the paper's chart: attitude (scalar first) and input from acceleration, jerk, `q3` and its rate. NaN at the
/// singularities (free fall, thrust downwards, end of the chart).
pub fn phi(
    acceleration_m_s2: &Vector3<f64>,
    jerk_m_s3: &Vector3<f64>,
    q3: f64,
    q3_rate_1_s: f64,
) -> (Vector4<f64>, InputVector) {
    let thrust = Thrust::new(acceleration_m_s2, jerk_m_s3);
    let attitude = thrust.attitude_with_q3(q3);
    let (p, q) = thrust.roll_pitch_rates(&attitude);
    let r = (2.0 * q3_rate_1_s + p * attitude[2] - q * attitude[1]) / attitude[0];
    (attitude, InputVector::new(thrust.magnitude_m_s2, p, q, r))
}

/// The reference that flies a flat output, for any heading: `q = q_tilt(n) q_z(psi)`.
pub fn reference_point(sample: &FlatSample) -> ReferencePoint {
    let thrust = Thrust::new(&sample.acceleration_m_s2, &sample.jerk_m_s3);
    let tilt = thrust.attitude_with_q3(0.0);
    let (p, q) = thrust.roll_pitch_rates(&tilt);
    // Rates of the tilt alone, in its own frame; the heading turns them and adds its own.
    let tilt_rates = Vector3::new(p, q, (p * tilt[2] - q * tilt[1]) / tilt[0]);
    // Not from_axis_angle: psi and psi + 2 pi stay apart, so that q is continuous along a turning trajectory.
    let (sin, cos) = (0.5 * sample.heading_rad).sin_cos();
    let heading = UnitQuaternion::new_unchecked(Quaternion::new(cos, 0.0, 0.0, sin));
    let rates = heading.inverse() * tilt_rates + Vector3::new(0.0, 0.0, sample.heading_rate_rad_s);
    let mut state = StateVector::zeros();
    state.fixed_rows_mut::<3>(super::POSITION).copy_from(&sample.position_m);
    state.fixed_rows_mut::<4>(super::ATTITUDE).copy_from(&scalar_first(&(unit(&tilt) * heading)));
    state.fixed_rows_mut::<3>(super::VELOCITY).copy_from(&sample.velocity_m_s);
    ReferencePoint {
        state,
        input: InputVector::new(thrust.magnitude_m_s2, rates.x, rates.y, rates.z),
        acceleration_m_s2: sample.acceleration_m_s2,
        jerk_m_s3: sample.jerk_m_s3,
        heading_rad: sample.heading_rad,
        heading_rate_rad_s: sample.heading_rate_rad_s,
    }
}
