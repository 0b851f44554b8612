//! Steps of the core's controller as the tests ask for them: by laws of thrust and body rates.

use quatrack::{Controller, Memory, Output, Reference, State, Step, StepError, Target};

/// A step of a law that remembers nothing.
///
/// # Errors
/// As [`Controller::step`].
pub fn step(controller: &Controller<'_>, state: &State, reference: &Reference) -> Result<Step, StepError> {
    step_on(controller, &mut Memory::at_rest(), state, Target::new(reference))
}

/// A step on the remembered values.
///
/// # Errors
/// As [`Controller::step`].
pub fn step_on(
    controller: &Controller<'_>,
    memory: &mut Memory,
    state: &State,
    target: Target<'_>,
) -> Result<Step, StepError> {
    controller.step(memory, state.into(), target).map(command)
}

/// An output that is a command.
///
/// # Panics
/// Where it is motor forces.
pub fn command(output: Output) -> Step {
    *output.command().expect("the law gives thrust and body rates")
}
