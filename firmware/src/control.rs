//! The control step against four small traits: a clock, a state, a reference in; one command out. No hardware.

use quatrack::link::NoCommand;
use quatrack::{Command, FlatSample, Reference, State, Step, Tick, Tracker};

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
    /// The flat output at a tick, if there is anything to follow.
    fn at(&mut self, now: Tick) -> Option<FlatSample>;
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
    tracker: &Tracker<'_>,
) -> Result<Step, NoCommand> {
    let state = states.newest().ok_or(NoCommand::NoReference)?;
    // Looked at where they lie: to move a sample or a reference out costs as many instructions as a law's product.
    let Some(sample) = &references.at(clock.now()) else { return Err(NoCommand::NoReference) };
    match &Reference::from_flat(sample) {
        Ok(reference) => tracker.step(state, reference).map_err(NoCommand::Step),
        Err(error) => Err(NoCommand::Reference(*error)),
    }
}
