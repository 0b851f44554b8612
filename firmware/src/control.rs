//! The control step against four small traits: a clock, a state, a reference in; one command out. No hardware.

use quatrack::link::NoCommand;
use quatrack::{Command, Reference, ReferenceError, State, Step, Tick};

use crate::laws::Laws;

/// Which tick it is, on the clock that the reference is played by.
pub trait Clock {
    /// The tick of this step.
    fn now(&self) -> Tick;
}

/// Where states come from: a link; an estimator where there is one.
pub trait StateSource {
    /// The newest state, if there has been one.
    fn newest(&self) -> Option<&State>;
}

/// Where references come from: a stored trajectory, or a link.
pub trait ReferenceSource {
    /// Whether there is anything to follow.
    fn is_there(&self) -> bool;

    /// The reference at a tick.
    ///
    /// # Errors
    /// [`ReferenceError`] where it cannot be flown.
    fn at(&mut self, now: Tick) -> Result<Reference, ReferenceError>;
}

/// Where commands go: nowhere yet; the rate loop and its motors where there are some.
pub trait CommandSink {
    /// Takes the command of this step. [`Command::ZERO`] stops the motors.
    fn put(&mut self, command: &Command);
}

/// One step of the law.
///
/// # Errors
/// [`NoCommand`] where there is no state, no reference, or no answer of the law.
#[inline]
pub fn step(
    clock: &impl Clock,
    states: &impl StateSource,
    references: &mut impl ReferenceSource,
    laws: &mut Laws,
) -> Result<Step, NoCommand> {
    let Some(state) = states.newest().filter(|_| references.is_there()) else { return Err(NoCommand::NoReference) };
    // Looked at where it lies: to move a reference out costs as many instructions as the product with a gain.
    match &references.at(clock.now()) {
        Ok(reference) => laws.step(state, reference).map_err(NoCommand::Step),
        Err(error) => Err(NoCommand::Reference(*error)),
    }
}
