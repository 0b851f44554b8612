//! Position and its derivatives to the jerk (world frame, SI), as setpoints have them.

use quatrack::nalgebra::Vector3;

/// Position and its derivatives at one time, world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// m.
    pub position_m: Vector3<f32>,
    /// m/s.
    pub velocity_m_s: Vector3<f32>,
    /// m/s^2.
    pub acceleration_m_s2: Vector3<f32>,
    /// m/s^3.
    pub jerk_m_s3: Vector3<f32>,
}

impl Motion {
    /// At rest at the origin.
    pub const ZERO: Self = Self {
        position_m: Vector3::new(0.0, 0.0, 0.0),
        velocity_m_s: Vector3::new(0.0, 0.0, 0.0),
        acceleration_m_s2: Vector3::new(0.0, 0.0, 0.0),
        jerk_m_s3: Vector3::new(0.0, 0.0, 0.0),
    };
}
