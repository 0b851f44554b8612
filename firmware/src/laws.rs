//! Which law is flown: choices and accepted gain tables in, the output of a step out; from one law to the next without a
//! jump.
//!
//! A table in flash is stepped as it is. A loaded one lies in a store that the next upload changes, so that nothing can
//! borrow it for longer than a step: its controller is made anew for each. A loaded table stays until the power goes, or
//! the rate of the steps changes.

#[cfg(not(feature = "motors"))]
#[path = "laws/commands_only.rs"]
mod motors;
#[cfg(feature = "motors")]
mod motors;
#[cfg(feature = "motors")]
mod rescue;
mod stepping;

use quatrack::gains::paper;
use quatrack::gains::table::{AcceptError, AcceptedTable};
use quatrack::link::{GainStore, LawChoice, Table};
use quatrack::{Controller, Equilibrium, Handover, Limits, Memory, Rate};

pub use self::motors::Actuations;
use self::motors::{cascade, loaded};
use crate::vehicle::{STEP_RATE, VEHICLE};

/// Steps from one law to another in flight: a tenth of a second at 500 Hz.
pub const FADE_STEPS: u16 = 50;

/// Why a law or a table is not taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refused {
    /// There is no such table on board.
    NoTable,
    /// The last change of the law is still on its way, or the table that would make room is flown.
    Busy,
    /// The table is for another board.
    Accept(AcceptError),
}

/// The kind of target that the stepped laws follow.
#[cfg(feature = "motors")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Follow {
    /// References: the laws of the paper, and those past it.
    References,
    /// The flat output itself: the cascade.
    Samples,
    /// One of each, on the way from one to the other.
    Both,
}

/// The law in force, the way to it from the one before, and the memory of both.
pub struct Laws {
    choice: LawChoice,
    limits: Limits,
    memory: Memory,
    /// Of the choice, if its table is in flash.
    controller: Controller<'static>,
    /// Whether it is all there is to step: the choice is in flash, and no other law on its way out.
    is_alone: bool,
    before: LawChoice,
    handover: Handover,
    /// Body-rate loop, mixer and motor model, which carry commands to the motors.
    pub actuations: Actuations,
    /// Somebody has chosen the law.
    is_chosen: bool,
    /// Another law has taken over from the one in force.
    is_rescued: bool,
    store: &'static mut GainStore,
}

/// The law where nobody has chosen one and there are no body rates; where there are, it is the cascade.
const DEFAULT: LawChoice = LawChoice::new(Table::LqrE);

impl Laws {
    /// LQR-E within these limits, nothing loaded.
    #[inline(always)]
    pub fn new(store: &'static mut GainStore, limits: Limits, rate: Option<Rate>) -> Self {
        store.assign(rate.map(|rate| (VEHICLE, rate)));
        Self {
            choice: DEFAULT,
            limits,
            memory: Memory::at_rest(),
            controller: Controller::new(Equilibrium::new(&paper::LQR_E), limits),
            is_alone: true,
            before: DEFAULT,
            handover: Handover::OVER,
            actuations: Actuations::new(),
            is_chosen: false,
            is_rescued: false,
            store,
        }
    }

    /// The law in force, or on its way there.
    pub fn choice(&self) -> LawChoice {
        self.choice
    }

    /// The rate that loaded tables must be certified at; nothing where none can be.
    pub fn rate(&self) -> Option<Rate> {
        self.store.board().map(|(_, rate)| *rate)
    }

    /// Sets the rate of the steps. At another rate no table that was made for the one before is flown: the loaded ones
    /// are dropped.
    #[cold]
    pub fn set_rate(&mut self, rate: Option<Rate>) {
        if rate == self.rate() {
            return;
        }
        self.store.assign(rate.map(|rate| (VEHICLE, rate)));
        if matches!(self.choice.table, Table::Loaded(_) | Table::Cascade) {
            self.choice = DEFAULT;
        }
        self.settle();
    }

    /// The limits of the board.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Sets them, from the next step on.
    #[cold]
    pub fn set_limits(&mut self, limits: Limits) {
        self.limits = limits;
        self.settle();
    }

    /// Chooses a law, over so many steps. The one in force again changes nothing.
    ///
    /// # Errors
    /// [`Refused::NoTable`], [`Refused::Busy`]; the one in force stays.
    #[cold]
    pub fn select(&mut self, choice: LawChoice, steps: u16) -> Result<(), Refused> {
        if choice == self.choice && steps > 0 {
            return Ok(());
        }
        self.controller_of(&choice).ok_or(Refused::NoTable)?;
        self.is_chosen = true;
        self.change(choice, self.choice, steps)
    }

    /// Before arming, where nobody has chosen: the cascade where there are body rates to fly it on.
    #[cold]
    pub fn choose_default(&mut self, has_body_rates: bool) {
        let table = if has_body_rates { Table::Cascade } else { DEFAULT.table };
        let choice = LawChoice::new(table);
        if !self.is_chosen && self.controller_of(&choice).is_some() {
            // It is on board.
            let _ = self.change(choice, choice, 0);
        }
    }

    /// Puts an accepted table in the place of the uploaded one, which becomes the one before. Where it is flown, the flight
    /// goes over to the new one in so many steps.
    ///
    /// # Errors
    /// [`Refused`]; nothing changes then.
    #[cold]
    pub fn load(&mut self, table: &AcceptedTable<'_>, steps: u16) -> Result<(), Refused> {
        let in_flight = steps > 0;
        if in_flight && (!self.handover.is_over() || self.choice.table == Table::Loaded(1)) {
            return Err(Refused::Busy);
        }
        self.store.activate(table).map_err(Refused::Accept)?;
        self.actuations.load(table);
        match self.choice.table {
            Table::Loaded(0) => self.change(self.choice, LawChoice { table: Table::Loaded(1), ..self.choice }, steps),
            _ => Ok(()),
        }
    }

    /// Ends the way from one law to another where it is.
    #[cold]
    #[inline(never)]
    pub fn settle(&mut self) {
        // The choice is on board.
        let _ = self.change(self.choice, self.choice, 0);
    }

    /// Before a flight: the motors have been off.
    #[cold]
    pub fn begin(&mut self) {
        self.settle();
        self.is_rescued = false;
        self.memory = Memory::at_rest();
    }

    #[inline(never)]
    fn change(&mut self, choice: LawChoice, before: LawChoice, steps: u16) -> Result<(), Refused> {
        if steps > 0 && !self.handover.is_over() {
            return Err(Refused::Busy);
        }
        let handover = self.begin_handover(&choice, &before, steps);
        let built_in = self.built_in(&choice);
        if let Some(controller) = built_in {
            self.controller = controller;
        }
        (self.choice, self.before, self.handover) = (choice, before, handover);
        self.is_alone = built_in.is_some() && self.handover.is_over();
        Ok(())
    }

    #[cfg(not(feature = "motors"))]
    fn begin_handover(&mut self, _choice: &LawChoice, _before: &LawChoice, steps: u16) -> Handover {
        Handover::of_commands(steps)
    }

    #[cfg(feature = "motors")]
    fn begin_handover(&mut self, choice: &LawChoice, before: &LawChoice, steps: u16) -> Handover {
        let mut memory = self.memory;
        let (Some(old), Some(new)) = (self.controller_of(before), self.controller_of(choice)) else {
            return Handover::OVER;
        };
        let handover = Handover::begin(steps, old.law(), new.law(), &mut memory);
        self.memory = memory;
        handover
    }

    #[inline(never)]
    fn controller_of(&self, choice: &LawChoice) -> Option<Controller<'_>> {
        let Table::Loaded(slot) = choice.table else { return self.built_in(choice) };
        let settings = self.actuations.settings(choice, self.limits);
        loaded(&self.store.table(slot)?, &settings)
    }

    /// The controller of a table in flash, if it is made for the rate of the steps.
    #[inline(never)]
    fn built_in(&self, choice: &LawChoice) -> Option<Controller<'static>> {
        let law = match choice.table {
            Table::Cascade if self.rate() == Some(STEP_RATE) => cascade()?,
            _ => choice.built_in()?,
        };
        Some(Controller::new(law, self.limits))
    }
}
