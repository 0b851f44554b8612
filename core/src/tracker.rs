//! One control step: an estimated state and a reference in, a command within the limits out, or the reason for none.

use crate::command::{Command, Limited, Limits};
use crate::error::StepError;
use crate::law::{AnyLaw, ControlLaw};
use crate::reference::Reference;
use crate::state::State;

/// A law and the limits of the vehicle that it flies. To be called at a fixed rate.
#[derive(Clone, Copy, Debug)]
pub struct Tracker<'a> {
    law: AnyLaw<'a>,
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
        Self { law: law.into(), limits }
    }

    /// The limits.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The command for this step. The measured quaternion may have either sign.
    ///
    /// # Errors
    /// [`StepError`] where the state is no state or the law has no answer. There is then no command: the caller stops
    /// or levels, and never holds the last one.
    #[inline]
    pub fn step(&self, state: &State, reference: &Reference) -> Result<Step, StepError> {
        let state = state.normalised().map_err(StepError::State)?;
        let command = self.law.command(&state, reference);
        match self.limits.saturate(&command) {
            Some((command, limited)) => Ok(Step { command, limited }),
            None => Err(Self::fault(&state)),
        }
    }

    /// Why the command is not finite. The reference has been checked when it was made.
    #[cold]
    fn fault(state: &State) -> StepError {
        state.non_finite().map_or(StepError::Singular, StepError::State)
    }
}
