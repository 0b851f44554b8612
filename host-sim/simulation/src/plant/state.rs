//! The state of a craft, as fields and as the vector that integrators take.

use nalgebra::{Quaternion, SVector, UnitQuaternion, Vector3, Vector4};

/// Position, velocity, attitude, body rates and thrusts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidState {
    /// Position of the centre of mass, world frame, m.
    pub position_m: Vector3<f64>,
    /// Velocity, world frame, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Body to world.
    pub attitude: UnitQuaternion<f64>,
    /// Body rates, body frame, rad/s.
    pub body_rates_rad_s: Vector3<f64>,
    /// Thrust of each motor, N.
    pub thrusts_n: Vector4<f64>,
}

/// `[r v q omega f]`, the quaternion scalar first and free in length.
pub(super) type RigidVector = SVector<f64, 17>;

impl RigidState {
    /// At rest and upright at a position, with heading 0 and equal thrusts.
    pub fn at_rest(position_m: Vector3<f64>, thrust_n: f64) -> Self {
        Self {
            position_m,
            velocity_m_s: Vector3::zeros(),
            attitude: UnitQuaternion::identity(),
            body_rates_rad_s: Vector3::zeros(),
            thrusts_n: Vector4::repeat(thrust_n),
        }
    }

    /// Body z axis, the direction of thrust, world frame.
    pub fn thrust_axis(&self) -> Vector3<f64> {
        self.attitude * Vector3::z()
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        // Times 0 each is 0 or NaN.
        let [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q] =
            <[f64; 17]>::from(self.to_vector()).map(|value| 0.0 * value);
        ((a + b) + (c + d)) + ((e + f) + (g + h)) + ((i + j) + (k + l)) + ((m + n) + (o + p)) + q == 0.0
    }

    pub(super) fn to_vector(self) -> RigidVector {
        let (r, v, q, w, f) =
            (&self.position_m, &self.velocity_m_s, self.attitude.quaternion(), &self.body_rates_rad_s, &self.thrusts_n);
        // Entry by entry: chained iterators cost as much as a stage of the integration.
        SVector::from([r.x, r.y, r.z, v.x, v.y, v.z, q.w, q.i, q.j, q.k, w.x, w.y, w.z, f[0], f[1], f[2], f[3]])
    }

    pub(super) fn from_vector(x: &RigidVector) -> Self {
        let attitude = UnitQuaternion::from_quaternion(Quaternion::new(x[6], x[7], x[8], x[9]));
        Self { attitude, ..Self::of_numbers((*x).into()) }
    }

    /// Of numbers, the quaternion as long as it is.
    pub(super) fn of_numbers(x: [f64; 17]) -> Self {
        let [rx, ry, rz, vx, vy, vz, w, i, j, k, p, q, r, f1, f2, f3, f4] = x;
        Self {
            position_m: Vector3::new(rx, ry, rz),
            velocity_m_s: Vector3::new(vx, vy, vz),
            attitude: UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k)),
            body_rates_rad_s: Vector3::new(p, q, r),
            thrusts_n: Vector4::new(f1, f2, f3, f4),
        }
    }
}
