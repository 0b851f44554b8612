//! The laws of an image without the feature `motors`: the paper's alone, whose steps end at thrust and body rates.

use quatrack::gains::table::{AcceptedTable, TableKind};
use quatrack::link::{LawChoice, Table};
use quatrack::supervisor::{Certified, Levelled, Looked};
use quatrack::{
    Actuation, Controller, FifthOrderSample, Heading, Law, Limits, Measured, Memory, Output, Settings, StepError,
    Target,
};

use super::Laws;
use crate::rates::TICK_RATE;

/// There is none.
pub(crate) const fn cascade() -> Option<Law<'static>> {
    None
}

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

    /// The settings with which a table's controller is made.
    pub(crate) const fn settings(&self, choice: &LawChoice, limits: Limits) -> Settings<'_> {
        Settings {
            feed_forward: choice.feed_forward,
            error_form: choice.error_form,
            ..Settings::new(limits, TICK_RATE)
        }
    }
}

impl Laws {
    /// Nothing is driven.
    pub(crate) const fn covers(&self, _are_driven: bool) -> Certified {
        Certified::NoMotors
    }

    /// Nobody asks.
    #[inline(always)]
    pub(crate) const fn thrust_m_s2(&self) -> f32 {
        0.0
    }

    /// Not without motors.
    pub(crate) fn brake(
        &mut self,
        _looked: &Looked<'_>,
        _sample: &FifthOrderSample,
        _heading: Heading,
    ) -> Result<Output, StepError> {
        Err(StepError::NoActuation)
    }

    /// Not without motors.
    pub(crate) fn level(&mut self, _levelled: &Levelled) -> Result<Output, StepError> {
        Err(StepError::NoActuation)
    }
}

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
