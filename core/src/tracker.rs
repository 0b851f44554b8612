//! One control step: an estimated state and a reference in, a command within the limits out, or the reason for none.

use crate::command::{Command, Limited, Limits};
use crate::error::StepError;
use crate::law::{AnyLaw, ControlLaw, Equilibrium, FlatOutput};
use crate::reference::Reference;
use crate::state::State;

/// A law and the limits of the vehicle that it flies. To be called at a fixed rate.
#[derive(Clone, Copy, Debug)]
pub struct Tracker<'a> {
    flown: Flown<'a>,
}

/// Which law is flown, each beside the limits: a step then takes one pointer to both.
#[derive(Clone, Copy, Debug)]
enum Flown<'a> {
    Equilibrium(Limiting<Equilibrium<'a>>),
    FlatOutput(Limiting<FlatOutput<'a>>),
}

#[derive(Clone, Copy, Debug)]
struct Limiting<L> {
    law: L,
    limits: Limits,
}

/// What one step gives.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Step {
    /// The command, finite and within the limits.
    pub command: Command,
    /// What was cut to stay there.
    pub limited: Limited,
}

impl<'a> Tracker<'a> {
    /// A tracker that flies `law` within `limits`.
    pub fn new(law: impl Into<AnyLaw<'a>>, limits: Limits) -> Self {
        let flown = match law.into() {
            AnyLaw::Equilibrium(law) => Flown::Equilibrium(Limiting { law, limits }),
            AnyLaw::FlatOutput(law) => Flown::FlatOutput(Limiting { law, limits }),
        };
        Self { flown }
    }

    /// The command for this step. The measured quaternion may have either sign.
    ///
    /// # Errors
    /// [`StepError`] where the state is no state or the law has no answer. There is then no command: the caller stops
    /// or levels, and never holds the last one.
    pub fn step(&self, state: &State, reference: &Reference) -> Result<Step, StepError> {
        match &self.flown {
            Flown::Equilibrium(limiting) => limiting.step(state, reference),
            Flown::FlatOutput(limiting) => limiting.step(state, reference),
        }
    }
}

impl<L: ControlLaw> Limiting<L> {
    /// Out of line, so that no law pays for the registers of another.
    #[inline(never)]
    fn step(&self, state: &State, reference: &Reference) -> Result<Step, StepError> {
        let Some(measured) = state.measured() else { return refuse(state) };
        match self.limits.saturate(&self.law.command(&measured, reference)) {
            Some((command, limited)) => Ok(Step { command, limited }),
            None => refuse(state),
        }
    }
}

/// Why there is no command. The reference has been checked when it was made.
#[cold]
#[inline(never)]
fn refuse(state: &State) -> Result<Step, StepError> {
    Err(state.fault().map_or(StepError::Singular, StepError::State))
}
