//! The estimated state of a craft with inertia: position, velocity (world frame, m, m/s), attitude, and the body rates
//! (rad/s) that the paper's model takes as an input.

use nalgebra::Vector3;

use crate::state::State;

/// The state of a craft with inertia: the paper's, and the gyroscope's body rates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RigidState {
    /// Position, attitude and velocity.
    pub state: State,
    /// Body rates `p q r`, rad/s.
    pub body_rates_rad_s: Vector3<f32>,
}
