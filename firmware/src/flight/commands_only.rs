//! A flight that ends at its commands, for an image without the feature `motors`: what the paper's laws take by themselves
//! is weighed and counted with it.

use quatrack::gains::table::{AcceptedTable, TableKind};
use quatrack::link::{NoCommand, Table};
use quatrack::nalgebra::Vector3;
use quatrack::{
    Actuation, ActuatorAware, Controller, Law, Measured, Memory, MotorForces, Output, Settings, State, StepError,
    Target, Tick,
};

use crate::craft::BodyRates;
use crate::drivers::battery::CellVoltage;
use crate::laws::Laws;
use crate::playback::Playback;
use crate::vehicle::STOPPED;

/// There is none.
pub(crate) const BUILT_IN_TO_MOTORS: Option<ActuatorAware<'static>> = None;

/// None.
pub struct Actuations;

#[expect(clippy::unused_self, reason = "the same to call as with motors")]
impl Actuations {
    pub(crate) const fn new() -> Self {
        Self
    }

    pub(crate) fn load(&mut self, _table: &AcceptedTable<'_>) {}

    #[inline(always)]
    pub(crate) const fn of(&self, _table: Table) -> Option<&Actuation> {
        None
    }
}

/// Nothing.
pub struct ToMotors;

/// A step of one of the paper's laws; no other is linked.
#[inline(always)]
pub(crate) fn step(
    controller: &Controller<'_>,
    memory: &mut Memory,
    measured: Measured<'_>,
    target: Target<'_>,
) -> Result<Output, StepError> {
    // Each by itself: the compiler then knows that it is no other.
    if let Law::Equilibrium(_) = controller.law() {
        controller.step(memory, measured, target)
    } else if let Law::FlatOutput(_) = controller.law() {
        controller.step(memory, measured, target)
    } else {
        Err(StepError::NoActuation)
    }
}

/// The controller of a loaded table for one of these laws.
pub(crate) fn loaded<'t>(table: &AcceptedTable<'t>, settings: &Settings<'t>) -> Option<Controller<'t>> {
    let (TableKind::Equilibrium | TableKind::FlatOutput) = table.kind() else { return None };
    table.controller(settings).ok()
}

#[expect(clippy::unused_self, reason = "the same to call as with motors")]
impl ToMotors {
    pub(super) const fn new() -> Self {
        Self
    }

    /// Nobody asks.
    pub const fn battery(&self) -> CellVoltage {
        CellVoltage::NOMINAL
    }

    /// None.
    pub const fn forces_n(&self) -> &MotorForces {
        &STOPPED
    }

    #[inline(always)]
    pub(super) fn accept(&mut self, _body_rates_rad_s: Option<Vector3<f32>>) {}

    #[inline(always)]
    pub(super) fn look_at(&mut self, _rates: BodyRates) {}

    /// A step down to its command.
    #[inline(always)]
    pub(super) fn step(
        &mut self,
        laws: &mut Laws,
        playback: &mut Playback,
        tick: Tick,
        state: Option<&State>,
        _rates: BodyRates,
    ) -> Result<Output, NoCommand> {
        let Some(state) = state.filter(|_| playback.is_there()) else { return Err(NoCommand::NoReference) };
        // Looked at where it lies: to move a reference out costs as many instructions as the product with a gain.
        match &playback.reference(tick) {
            Ok(reference) => laws.step(Measured::new(state), Target::new(reference)).map_err(NoCommand::Step),
            Err(error) => Err(NoCommand::Reference(*error)),
        }
    }

    pub(super) fn pass(&mut self, _output: &Output) {}

    pub(super) fn stop(&mut self) {}

    #[inline(always)]
    pub(super) const fn answers_by_forces(&self) -> bool {
        false
    }
}
