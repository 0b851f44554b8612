//! Every law, and the board's ways to its motors.

use quatrack::body_rate::BandwidthError;
use quatrack::cascade::{Cascade, CascadeLimits};
use quatrack::gains::table::{AcceptedTable, CascadeTable};
use quatrack::link::{LawChoice, Table};
use quatrack::{
    Actuation, BodyRateLoop, Controller, Law, Limits, Measured, Memory, Output, Settings, StepError, Target,
};

use super::rescue::CASCADE;
use crate::rates::TICK_RATE;
use crate::vehicle::{ACTUATION, AIRFRAME};

/// The law of nested loops in the image, for steps at [`crate::vehicle::STEP_RATE`].
pub(crate) fn cascade() -> Option<Law<'static>> {
    Some(Law::from(&CASCADE))
}

/// The board's ways to its motors: its own, and that of each slot's table, which may reckon with another motor lag; and the
/// cascades that are made of loaded tables.
pub struct Actuations {
    board: Actuation,
    of_slots: [Actuation; 2],
    cascades: [Option<Cascade>; 2],
    bandwidth_rad_s: [f32; 3],
}

impl Actuations {
    /// The craft's own, with the body-rate loop that fits its motors' lag.
    #[inline(always)]
    pub(crate) const fn new() -> Self {
        let bandwidth_rad_s = [0.5 / AIRFRAME.figures().motor_lag_s; 3];
        Self { board: ACTUATION, of_slots: [ACTUATION; 2], cascades: [None; 2], bandwidth_rad_s }
    }

    /// Bandwidth of the body-rate loop, rad/s.
    pub const fn bandwidth_rad_s(&self) -> [f32; 3] {
        self.bandwidth_rad_s
    }

    /// Sets it.
    ///
    /// # Errors
    /// As [`BodyRateLoop::new`]; the old setting stays.
    #[cold]
    pub fn set_bandwidth(&mut self, bandwidth_rad_s: [f32; 3]) -> Result<(), BandwidthError> {
        let body_rates = BodyRateLoop::new(&AIRFRAME, bandwidth_rad_s)?;
        self.bandwidth_rad_s = bandwidth_rad_s;
        for actuation in self.of_slots.iter_mut().chain([&mut self.board]) {
            *actuation = actuation.with_body_rates(body_rates);
        }
        Ok(())
    }

    /// A table has been put to use: it is in slot 0, and the one before in slot 1.
    pub(crate) fn load(&mut self, table: &AcceptedTable<'_>) {
        let [in_use, _] = self.of_slots;
        self.of_slots = [table.actuation(&self.board), in_use];
        let [in_use, _] = self.cascades;
        let flown = |of: &CascadeTable| of.flown(&AIRFRAME, table.rate(), &CascadeLimits::STANDARD, &of.air).ok();
        self.cascades = [table.cascade().and_then(flown), in_use];
    }

    /// That of a table.
    #[inline]
    pub(crate) const fn of(&self, table: Table) -> Option<&Actuation> {
        if let Some(cascade) = self.cascade(table) {
            return Some(cascade.actuation());
        }
        let [in_use, before] = &self.of_slots;
        Some(match table {
            Table::Loaded(0) => in_use,
            Table::Loaded(_) => before,
            _ => &self.board,
        })
    }

    /// The cascade of a table, if it is one of it.
    const fn cascade(&self, table: Table) -> Option<&Cascade> {
        let [in_use, before] = &self.cascades;
        match table {
            Table::Loaded(0) => in_use.as_ref(),
            Table::Loaded(_) => before.as_ref(),
            Table::Cascade => Some(&CASCADE),
            _ => None,
        }
    }

    /// The settings with which a table's controller is made.
    pub(crate) const fn settings(&self, choice: &LawChoice, limits: Limits) -> Settings<'_> {
        Settings {
            actuation: self.of(choice.table),
            cascade: self.cascade(choice.table),
            feed_forward: choice.feed_forward,
            error_form: choice.error_form,
            ..Settings::new(limits, TICK_RATE)
        }
    }
}

/// A step of any law.
#[inline(always)]
pub(crate) fn step(
    controller: &Controller<'_>,
    memory: &mut Memory,
    measured: Measured<'_>,
    target: Target<'_>,
) -> Result<Output, StepError> {
    controller.step(memory, measured, target)
}

/// The controller of a loaded table.
#[inline]
pub(crate) fn loaded<'t>(table: &AcceptedTable<'t>, settings: &Settings<'t>) -> Option<Controller<'t>> {
    table.controller(settings).ok()
}
