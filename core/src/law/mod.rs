//! The control laws: a measured state and a reference in, a command before saturation out.
//!
//! A law does not check its inputs and does not fail: what is not finite, and what its map has no answer to, comes out
//! as a command that is not finite, which [`crate::tracker`] refuses.

mod actuator_aware;
mod along_trajectory;
mod equilibrium;
mod flat_output;
mod integral_action;

pub use actuator_aware::{ActuatorAware, ActuatorAwareGain, ActuatorMemory};
pub use along_trajectory::{AlongTrajectory, GainSchedule, Knot, ScheduleError};
pub use equilibrium::{Equilibrium, EquilibriumGain, ErrorForm};
pub use flat_output::{FlatOutput, FlatOutputGain};
pub use integral_action::{IntegralAction, IntegralGain};

use nalgebra::Vector3;

use crate::command::Command;
use crate::reference::Reference;
use crate::state::Measured;

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
    fn command(&self, state: &Measured<'_>, reference: &Reference) -> Command;
}

/// Any of the laws, to be chosen at run time.
#[derive(Clone, Copy, Debug)]
pub enum AnyLaw<'a> {
    /// Linear in the state's error around hover.
    Equilibrium(Equilibrium<'a>),
    /// Linear in the flat state's error, through the flat map.
    FlatOutput(FlatOutput<'a>),
}

impl ControlLaw for AnyLaw<'_> {
    #[inline]
    fn command(&self, state: &Measured<'_>, reference: &Reference) -> Command {
        match self {
            Self::Equilibrium(law) => law.command(state, reference),
            Self::FlatOutput(law) => law.command(state, reference),
        }
    }
}

impl<'a> From<Equilibrium<'a>> for AnyLaw<'a> {
    fn from(law: Equilibrium<'a>) -> Self {
        Self::Equilibrium(law)
    }
}

impl<'a> From<FlatOutput<'a>> for AnyLaw<'a> {
    fn from(law: FlatOutput<'a>) -> Self {
        Self::FlatOutput(law)
    }
}

/// Any law that gives thrust and body rates, those included that need more than a state and a reference; flown by
/// [`crate::Controller`].
#[derive(Clone, Copy, Debug)]
pub enum FlightLaw<'a> {
    /// The same gains all the time, nothing remembered.
    Fixed(AnyLaw<'a>),
    /// With the integral of the position error.
    Integral(IntegralAction<'a>),
    /// Gains over time along a trajectory.
    Along(AlongTrajectory<'a>),
}

impl<'a> FlightLaw<'a> {
    /// The law, if it is one for [`crate::Tracker`], which remembers nothing.
    pub const fn fixed(self) -> Option<AnyLaw<'a>> {
        match self {
            Self::Fixed(law) => Some(law),
            Self::Integral(_) | Self::Along(_) => None,
        }
    }
}

impl<'a, L: Into<AnyLaw<'a>>> From<L> for FlightLaw<'a> {
    fn from(law: L) -> Self {
        Self::Fixed(law.into())
    }
}

impl<'a> From<IntegralAction<'a>> for FlightLaw<'a> {
    fn from(law: IntegralAction<'a>) -> Self {
        Self::Integral(law)
    }
}

impl<'a> From<AlongTrajectory<'a>> for FlightLaw<'a> {
    fn from(law: AlongTrajectory<'a>) -> Self {
        Self::Along(law)
    }
}

/// `a - b`, component by component: three subtractions in registers, where the matrix type's operator loops over memory.
#[inline]
pub(crate) fn difference(a: &Vector3<f32>, b: &Vector3<f32>) -> Vector3<f32> {
    Vector3::new(a.x - b.x, a.y - b.y, a.z - b.z)
}
