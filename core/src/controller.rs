//! Any law, those included that remember or that follow a clock: one step takes what it remembers, where on which
//! trajectory it is, a state and a reference, and gives a command within the limits.
//!
//! Nothing above needs to know which law runs: every step is given all of it, and a law takes what it needs. What is
//! configured ([`Controller`]) and what is remembered ([`Memory`]) are apart, so that a law can be swapped in flight and a
//! flight begun anew. For the laws that remember nothing, [`Tracker`] is the same without either.

use nalgebra::Vector3;

use crate::command::Limits;
use crate::error::StepError;
use crate::law::{AlongTrajectory, FlightLaw, IntegralAction};
use crate::reference::Reference;
use crate::state::State;
use crate::tracker::{Step, Tracker, refuse};
use crate::trajectory::Progress;

/// What a law remembers from one step to the next. A flight begins with a new one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Memory {
    /// Sum over the steps of the position error times the period, world frame, metre seconds.
    pub position_integral_metre_seconds: Vector3<f32>,
}

impl Memory {
    /// Nothing remembered.
    pub const fn new() -> Self {
        Self { position_integral_metre_seconds: Vector3::new(0.0, 0.0, 0.0) }
    }
}

impl Default for Memory {
    fn default() -> Self {
        Self::new()
    }
}

/// A law and the limits of the vehicle that it flies. To be called at a fixed rate.
#[derive(Clone, Copy, Debug)]
pub struct Controller<'a> {
    flown: Flown<'a>,
}

#[derive(Clone, Copy, Debug)]
enum Flown<'a> {
    Fixed(Tracker<'a>),
    Integral(IntegralAction<'a>, Limits),
    Along(AlongTrajectory<'a>, Limits),
}

impl<'a> Controller<'a> {
    /// A controller that flies `law` within `limits`.
    pub fn new(law: impl Into<FlightLaw<'a>>, limits: Limits) -> Self {
        let flown = match law.into() {
            FlightLaw::Fixed(law) => Flown::Fixed(Tracker::new(law, limits)),
            FlightLaw::Integral(law) => Flown::Integral(law, limits),
            FlightLaw::Along(law) => Flown::Along(law, limits),
        };
        Self { flown }
    }

    /// The command for this step. `progress` is where the reference is on which trajectory; nothing where it comes from
    /// elsewhere.
    ///
    /// # Errors
    /// As [`Tracker::step`]; what is remembered stays as it was.
    pub fn step(
        &self,
        memory: &mut Memory,
        progress: Option<Progress>,
        state: &State,
        reference: &Reference,
    ) -> Result<Step, StepError> {
        match &self.flown {
            Flown::Fixed(tracker) => tracker.step(state, reference),
            Flown::Integral(law, limits) => integral(law, limits, memory, state, reference),
            Flown::Along(law, limits) => along(law, limits, progress, state, reference),
        }
    }
}

// Out of line, so that no law pays for the registers of another.

#[inline(never)]
fn integral(
    law: &IntegralAction<'_>,
    limits: &Limits,
    memory: &mut Memory,
    state: &State,
    reference: &Reference,
) -> Result<Step, StepError> {
    let Some(measured) = state.measured() else { return refuse(state) };
    let sum = &mut memory.position_integral_metre_seconds;
    let Some((command, limited)) = limits.saturate(&law.command(sum, &measured, reference)) else {
        return refuse(state);
    };
    *sum = law.advanced(sum, state, reference, limited);
    Ok(Step { command, limited })
}

#[inline(never)]
fn along(
    law: &AlongTrajectory<'_>,
    limits: &Limits,
    progress: Option<Progress>,
    state: &State,
    reference: &Reference,
) -> Result<Step, StepError> {
    let Some(measured) = state.measured() else { return refuse(state) };
    match limits.saturate(&law.command(progress, &measured, reference)) {
        Some((command, limited)) => Ok(Step { command, limited }),
        None => refuse(state),
    }
}
