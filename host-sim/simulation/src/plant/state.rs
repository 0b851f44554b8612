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
        self.to_vector().iter().all(|value| value.is_finite())
    }

    pub(super) fn to_vector(self) -> RigidVector {
        let (r, v, q, w, f) =
            (&self.position_m, &self.velocity_m_s, self.attitude.quaternion(), &self.body_rates_rad_s, &self.thrusts_n);
        // Entry by entry: chained iterators cost as much as a stage of the integration.
        SVector::from([r.x, r.y, r.z, v.x, v.y, v.z, q.w, q.i, q.j, q.k, w.x, w.y, w.z, f[0], f[1], f[2], f[3]])
    }

    pub(super) fn from_vector(x: &RigidVector) -> Self {
        Self {
            position_m: x.fixed_rows::<3>(0).into_owned(),
            velocity_m_s: x.fixed_rows::<3>(3).into_owned(),
            attitude: UnitQuaternion::from_quaternion(Quaternion::new(x[6], x[7], x[8], x[9])),
            body_rates_rad_s: x.fixed_rows::<3>(10).into_owned(),
            thrusts_n: x.fixed_rows::<4>(13).into_owned(),
        }
    }
}
