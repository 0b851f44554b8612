//! The flat map Phi (5) and its inverse: acceleration, jerk and heading in; attitude, thrust and body rates out.
//!
//! With `h = a + g z`, thrust is `T = |h|` and its direction `n = h / T`. The attitude is the smallest rotation that
//! tilts the body z axis to `n`, after a rotation about the vertical that is given either by `q3` (the paper's flat
//! output, a chart that ends at `|q3| = cos(tilt/2)`) or by a [`Heading`] (no such end). Body rates are computed in the
//! frame of the tilt alone and turned by the heading at the end.

use nalgebra::Vector3;

use crate::command::Command;
use crate::error::{Field, ReferenceError};
use crate::math::sqrt;
use crate::quaternion::{Heading, Quaternion};

/// Gravitational acceleration of the paper, m/s^2.
pub const GRAVITY_M_S2: f32 = 9.81;

/// Smallest thrust of a reference, m/s^2: 1 % of hover. Below it the attitude follows noise.
pub const MIN_THRUST_M_S2: f32 = 0.1;

/// Smallest vertical component of a reference's thrust axis: a tilt of 177 degrees, next to the singularity at 180.
pub const MIN_AXIS_Z: f32 = -0.998_6;

/// State and input of the flat map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttitudeAndInput {
    /// Attitude, body to world, of unit norm.
    pub attitude: Quaternion,
    /// Thrust and body rates.
    pub input: Command,
}

/// The flat output and its derivatives of the inverse map, at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatDerivatives {
    /// Acceleration without gravity, m/s^2.
    pub acceleration_m_s2: Vector3<f32>,
    /// Jerk, m/s^3.
    pub jerk_m_s3: Vector3<f32>,
    /// Third vector component of the quaternion.
    pub q3: f32,
    /// Its rate, 1/s.
    pub q3_rate_1_s: f32,
}

/// Phi in the paper's chart: heading given by `q3` and its rate.
///
/// # Errors
/// [`ReferenceError`] at free fall, with the thrust downwards, and where `|q3|` exceeds `cos(tilt/2)`.
pub fn phi(
    acceleration_m_s2: Vector3<f32>,
    jerk_m_s3: Vector3<f32>,
    q3: f32,
    q3_rate_1_s: f32,
) -> Result<AttitudeAndInput, ReferenceError> {
    let tilt = Tilt::new(acceleration_m_s2, jerk_m_s3);
    if !tilt.is_regular() {
        return Err(tilt.fault());
    }
    let mapped = tilt.with_q3(q3, q3_rate_1_s);
    // Zero at the end of the chart, NaN beyond.
    if mapped.attitude.w > 0.0 { Ok(mapped) } else { Err(ReferenceError::HeadingInfeasible { q3 }) }
}

/// Phi with the heading given as an angle about the vertical and its rate, for any angle.
///
/// # Errors
/// [`ReferenceError`] at free fall and with the thrust downwards.
pub fn phi_at_heading(
    acceleration_m_s2: Vector3<f32>,
    jerk_m_s3: Vector3<f32>,
    heading: Heading,
    heading_rate_rad_s: f32,
) -> Result<AttitudeAndInput, ReferenceError> {
    let tilt = Tilt::new(acceleration_m_s2, jerk_m_s3);
    if !tilt.is_regular() {
        return Err(tilt.fault());
    }
    Ok(tilt.with_heading(heading, heading_rate_rad_s))
}

/// The inverse of Phi: the derivatives of the flat output under an attitude, an input and the rate of the thrust, which the
/// model (1) leaves free.
pub fn phi_inverse(attitude: Quaternion, input: &Command, thrust_rate_m_s3: f32) -> FlatDerivatives {
    let n = attitude.thrust_axis();
    let omega = input.body_rates_rad_s;
    // The body z axis turns with omega x z = (q, -p, 0), seen from the world.
    let turn = Quaternion::new(0.0, omega.y, -omega.x, 0.0);
    let n_rate = (attitude * turn * attitude.conjugate()).vector();
    FlatDerivatives {
        acceleration_m_s2: n * input.thrust_m_s2 - Vector3::new(0.0, 0.0, GRAVITY_M_S2),
        jerk_m_s3: n * thrust_rate_m_s3 + n_rate * input.thrust_m_s2,
        q3: attitude.z,
        q3_rate_1_s: 0.5 * (attitude.w * omega.z + attitude.x * omega.y - attitude.y * omega.x),
    }
}

/// Direction of the thrust and how it turns: the part that both forms of Phi share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tilt {
    thrust_m_s2: f32,
    axis: Vector3<f32>,
    /// `1 / (1 + n_z)`.
    scale: f32,
    /// Rates of the tilt about the body axes at heading 0: `q = A`, `p = -B`.
    rate_a: f32,
    rate_b: f32,
}

impl Tilt {
    /// Not finite where the map is singular.
    #[inline]
    pub(crate) fn new(acceleration_m_s2: Vector3<f32>, jerk_m_s3: Vector3<f32>) -> Self {
        let (a, j) = (acceleration_m_s2, jerk_m_s3);
        let h = Vector3::new(a.x, a.y, a.z + GRAVITY_M_S2);
        let thrust = sqrt(h.x * h.x + h.y * h.y + h.z * h.z);
        let inverse = 1.0 / thrust;
        let n = Vector3::new(h.x * inverse, h.y * inverse, h.z * inverse);
        let thrust_rate = n.x * j.x + n.y * j.y + n.z * j.z;
        let n_rate = Vector3::new(
            (j.x - n.x * thrust_rate) * inverse,
            (j.y - n.y * thrust_rate) * inverse,
            (j.z - n.z * thrust_rate) * inverse,
        );
        let scale = 1.0 / (1.0 + n.z);
        let k = n_rate.z * scale;
        Self { thrust_m_s2: thrust, axis: n, scale, rate_a: n_rate.x - n.x * k, rate_b: n_rate.y - n.y * k }
    }

    /// Whether the map is away from its singularities and all of it finite; false for NaN.
    #[inline]
    pub(crate) fn is_regular(&self) -> bool {
        self.thrust_m_s2 >= MIN_THRUST_M_S2
            && self.axis.z >= MIN_AXIS_Z
            // Thrust and jerk beyond the range of f32 show here.
            && (self.rate_a + self.rate_b).abs() <= f32::MAX
    }

    /// Why it is not.
    #[cold]
    pub(crate) fn fault(&self) -> ReferenceError {
        if self.thrust_m_s2 < MIN_THRUST_M_S2 {
            ReferenceError::NoThrust { thrust_m_s2: self.thrust_m_s2 }
        } else if self.axis.z < MIN_AXIS_Z {
            ReferenceError::Inverted { axis_z: self.axis.z }
        } else {
            ReferenceError::NonFinite { field: Field::Jerk, value: self.rate_a + self.rate_b }
        }
    }

    /// `s = cos^2(tilt/2) = q0^2 + q3^2`.
    fn cos_half_tilt_squared(&self) -> f32 {
        0.5 * (1.0 + self.axis.z)
    }

    fn attitude(&self, q0: f32, q3: f32) -> Quaternion {
        let (n, i) = (self.axis, self.scale);
        Quaternion::new(q0, (q3 * n.x - q0 * n.y) * i, (q0 * n.x + q3 * n.y) * i, q3)
    }

    /// Not finite beyond the end of the chart.
    #[inline]
    pub(crate) fn with_q3(&self, q3: f32, q3_rate_1_s: f32) -> AttitudeAndInput {
        let q0 = sqrt(self.cos_half_tilt_squared() - q3 * q3);
        let attitude = self.attitude(q0, q3);
        let h = 4.0 * self.scale * q3;
        let (cos, sin) = (1.0 - h * q3, h * q0);
        let (p, q) = self.turned(cos, sin);
        let r = (2.0 * q3_rate_1_s + p * attitude.y - q * attitude.x) / q0;
        self.mapped(attitude, Vector3::new(p, q, r))
    }

    #[inline]
    pub(crate) fn with_heading(&self, heading: Heading, heading_rate_rad_s: f32) -> AttitudeAndInput {
        let root = sqrt(self.cos_half_tilt_squared());
        let attitude = self.attitude(root * heading.cos_half(), root * heading.sin_half());
        let (cos, sin) = heading.cos_sin();
        let (p, q) = self.turned(cos, sin);
        let r = heading_rate_rad_s + (self.rate_a * self.axis.y - self.rate_b * self.axis.x) * self.scale;
        self.mapped(attitude, Vector3::new(p, q, r))
    }

    /// [`Self::with_heading`] at heading 0.
    #[inline]
    pub(crate) fn straight(&self, heading_rate_rad_s: f32) -> AttitudeAndInput {
        let root = sqrt(self.cos_half_tilt_squared());
        let (n, half) = (self.axis, root * self.scale);
        let attitude = Quaternion::new(root, -n.y * half, n.x * half, 0.0);
        let r = heading_rate_rad_s + (self.rate_a * n.y - self.rate_b * n.x) * self.scale;
        self.mapped(attitude, Vector3::new(-self.rate_b, self.rate_a, r))
    }

    fn turned(&self, cos: f32, sin: f32) -> (f32, f32) {
        (sin * self.rate_a - cos * self.rate_b, cos * self.rate_a + sin * self.rate_b)
    }

    fn mapped(&self, attitude: Quaternion, body_rates_rad_s: Vector3<f32>) -> AttitudeAndInput {
        AttitudeAndInput { attitude, input: Command { thrust_m_s2: self.thrust_m_s2, body_rates_rad_s } }
    }
}
