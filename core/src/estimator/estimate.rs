//! The state of an estimator at a time.

use nalgebra::Vector3;

use super::covariance::Covariance;
use crate::rigid_state::RigidState;
use crate::state::State;

/// A state and how well it is known. Made by [`super::Estimator::start`], carried on by the estimator's other
/// functions; always of finite numbers, with an attitude of norm 1.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Estimate {
    pub(super) state: State,
    pub(super) covariance: Covariance,
}

impl Estimate {
    /// Position, attitude and velocity.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The same with the body rates, which a gyroscope measures and no filter has to estimate.
    pub fn rigid_state(&self, body_rates_rad_s: Vector3<f32>) -> RigidState {
        RigidState { state: self.state, body_rates_rad_s }
    }

    /// Covariance of the errors.
    pub fn covariance(&self) -> &Covariance {
        &self.covariance
    }
}
