//! The control laws: a measured state and a reference in, a command before saturation out.
//!
//! A law does not check its inputs and does not fail: numbers that are not finite, and inputs outside the domain of its
//! map, come out as a command that is not finite, which [`crate::control`] refuses.

#[cfg(feature = "actuator-aware")]
mod actuator_aware;
mod along_trajectory;
mod equilibrium;
mod flat_output;
#[cfg(feature = "actuator-aware")]
mod force_range;
mod integral_action;

#[cfg(feature = "actuator-aware")]
pub use actuator_aware::{ActuatorAware, ActuatorAwareGain};
pub use along_trajectory::{AlongTrajectory, GainSchedule, Knot, ScheduleError};
pub use equilibrium::{Equilibrium, EquilibriumGain, ErrorForm};
pub use flat_output::{FlatOutput, FlatOutputGain};
pub use integral_action::{IntegralAction, IntegralGain};

use nalgebra::Vector3;

use crate::command::Command;
use crate::reference::Reference;
use crate::state::NormalizedState;

/// Whether the reference's own input is added to the feedback.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FeedForward {
    /// Feedback around hover alone, as in the paper.
    #[default]
    Without,
    /// The reference's thrust and body rates (or acceleration, jerk and heading rate) are fed forward.
    With,
}

/// A state feedback law.
pub trait ControlLaw {
    /// The command before saturation; not finite where an input is not or where the law is singular.
    fn command(&self, state: &NormalizedState<'_>, reference: &Reference) -> Command;
}

/// `a - b`, component by component: three subtractions in registers, where the matrix type's operator loops over memory.
#[inline]
pub(crate) fn difference(a: &Vector3<f32>, b: &Vector3<f32>) -> Vector3<f32> {
    Vector3::new(a.x - b.x, a.y - b.y, a.z - b.z)
}
