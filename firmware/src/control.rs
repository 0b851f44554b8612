//! The control loop: the newest state and the reference of a tick in, one command out, against traits alone.

use quatrack::{Command, FlatSample, Player, Reference, ReferenceError, State, Step, StepError, Tick, Tracker};

/// Where states come from: a link, later an estimator.
pub trait StateSource {
    /// The newest state, if there has been one.
    fn newest(&mut self) -> Option<State>;
}

/// Where references come from: a stored trajectory, or a link.
pub trait ReferenceSource {
    /// The flat output at a tick.
    fn at(&mut self, tick: Tick) -> FlatSample;
}

/// Where commands go: a link, later the rate loop and its motors.
pub trait CommandSink {
    /// Takes the command of this tick.
    fn put(&mut self, command: &Command);
}

impl ReferenceSource for Player<'_> {
    #[inline]
    fn at(&mut self, tick: Tick) -> FlatSample {
        Player::at(self, tick)
    }
}

/// Why a tick gave the zero command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TickError {
    /// No state has come yet.
    NoState,
    /// The reference cannot be flown.
    Reference(ReferenceError),
    /// The law gave none.
    Step(StepError),
}

/// One tick: the command of the law, or zero and the reason.
///
/// # Errors
/// [`TickError`]; the sink has then been given [`Command::ZERO`].
#[inline]
pub fn tick(
    tick: Tick,
    tracker: &Tracker<'_>,
    states: &mut impl StateSource,
    references: &mut impl ReferenceSource,
    commands: &mut impl CommandSink,
) -> Result<Step, TickError> {
    let step = step(tick, tracker, states, references);
    commands.put(step.as_ref().map_or(&Command::ZERO, |step| &step.command));
    step
}

#[inline]
fn step(
    tick: Tick,
    tracker: &Tracker<'_>,
    states: &mut impl StateSource,
    references: &mut impl ReferenceSource,
) -> Result<Step, TickError> {
    let state = states.newest().ok_or(TickError::NoState)?;
    let reference = Reference::from_flat(&references.at(tick)).map_err(TickError::Reference)?;
    tracker.step(&state, &reference).map_err(TickError::Step)
}
