//! Trajectories of the flat output: control points, polynomial pieces or samples in; position and derivatives at a time
//! out.

pub mod bspline;
pub mod fifth_order;
pub mod file;
pub mod on_board;
pub mod poly4d;
pub mod polynomial;
pub mod refit;

use nalgebra::Vector3;

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

/// Something to fly: a flat output over `0 <= t <= duration_s`; outside, it rests at the nearer end.
pub trait Trajectory {
    /// Length in time, s; positive and finite.
    fn duration_s(&self) -> f64;
    /// The flat output at time `t_s`.
    fn at(&self, t_s: f64) -> FlatSample;
}
