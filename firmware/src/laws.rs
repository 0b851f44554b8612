//! Which law is flown: choices and accepted gain tables in, the command of a step out; from one law to the next without a
//! jump.
//!
//! A table in flash is stepped as it is. A loaded one lies in a store that the next upload changes, so that nothing can
//! borrow it for longer than a step: its tracker is made anew for each. What is loaded stays until the power goes, or the
//! rate of the steps changes.

use quatrack::gains::paper;
use quatrack::gains::table::{AcceptError, AcceptedTable, Name, TableKind, Vehicle};
use quatrack::link::{GainStore, LawChoice, Table};
use quatrack::{Crossfade, Equilibrium, Limits, Rate, Reference, State, Step, StepError, Tracker};

/// Whose tables are flown: the Crazyflie 2.1 by its figures in `gains/vehicles/crazyflie-2.1.toml`.
pub const VEHICLE: Vehicle = Vehicle { name: Name::literal("crazyflie-2.1"), id: 0x8983_3c06 };

/// Steps from one law to another in flight: a tenth of a second at 500 Hz.
pub const FADE_STEPS: u16 = 50;

/// Why a law or a table is not taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refused {
    /// There is no such table on board.
    NoTable,
    /// The last change of the law is still on its way, or the table that would make room is flown.
    Busy,
    /// The table remembers from step to step, which this loop does not.
    Kind(TableKind),
    /// The table is for another board.
    Accept(AcceptError),
}

/// The law in force, and the way to it from the one before.
pub struct Laws {
    choice: LawChoice,
    limits: Limits,
    /// Of the choice, if its table is in flash.
    tracker: Tracker<'static>,
    /// Whether it is all there is to step: the choice is in flash, and no other law on its way out.
    alone: bool,
    before: LawChoice,
    fade: Crossfade,
    store: &'static mut GainStore,
}

/// What a board flies that is told nothing.
const DEFAULT: LawChoice = LawChoice::new(Table::LqrE);

impl Laws {
    /// LQR-E within these limits, nothing loaded.
    #[inline(always)]
    pub fn new(store: &'static mut GainStore, limits: Limits, rate: Option<Rate>) -> Self {
        let tracker = Tracker::new(Equilibrium::new(&paper::LQR_E), limits);
        let fade = Crossfade::over(0);
        store.assign(rate.map(|rate| (VEHICLE, rate)));
        Self { choice: DEFAULT, limits, tracker, alone: true, before: DEFAULT, fade, store }
    }

    /// The law in force, or on its way there.
    pub fn choice(&self) -> LawChoice {
        self.choice
    }

    /// The rate that loaded tables must be certified at; nothing where none can be.
    pub fn rate(&self) -> Option<Rate> {
        self.store.board().map(|(_, rate)| *rate)
    }

    /// Sets the rate of the steps. At another one nothing that was loaded is flown: it is dropped.
    #[cold]
    pub fn set_rate(&mut self, rate: Option<Rate>) {
        if rate == self.rate() {
            return;
        }
        self.store.assign(rate.map(|rate| (VEHICLE, rate)));
        if matches!(self.choice.table, Table::Loaded(_)) {
            self.choice = DEFAULT;
        }
        self.settle();
    }

    /// The limits of every law.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Sets the limits of every law, from the next step on.
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
        self.tracker_of(&choice).ok_or(Refused::NoTable)?;
        self.change(choice, self.choice, steps)
    }

    /// Puts an accepted table in the place of the uploaded one, which becomes the one before. Where it is flown, the flight
    /// goes over to the new one in so many steps.
    ///
    /// # Errors
    /// [`Refused`]; nothing changes then.
    #[cold]
    pub fn load(&mut self, table: &AcceptedTable, steps: u16) -> Result<(), Refused> {
        let in_flight = steps > 0;
        if in_flight && (!self.fade.is_over() || self.choice.table == Table::Loaded(1)) {
            return Err(Refused::Busy);
        }
        if !matches!(table.kind(), TableKind::Equilibrium | TableKind::FlatOutput) {
            return Err(Refused::Kind(table.kind()));
        }
        self.store.activate(table).map_err(Refused::Accept)?;
        match self.choice.table {
            Table::Loaded(0) => self.change(self.choice, LawChoice { table: Table::Loaded(1), ..self.choice }, steps),
            _ => Ok(()),
        }
    }

    /// Ends the way from one law to another where it is: for the start of a flight.
    #[cold]
    #[inline(never)]
    pub fn settle(&mut self) {
        // The choice is on board.
        let _ = self.change(self.choice, self.choice, 0);
    }

    #[inline(never)]
    fn change(&mut self, choice: LawChoice, before: LawChoice, steps: u16) -> Result<(), Refused> {
        if steps > 0 && !self.fade.is_over() {
            return Err(Refused::Busy);
        }
        let built_in = built_in(&choice, self.limits);
        if let Some(tracker) = built_in {
            self.tracker = tracker;
        }
        (self.choice, self.before, self.fade) = (choice, before, Crossfade::over(steps));
        self.alone = built_in.is_some() && self.fade.is_over();
        Ok(())
    }

    /// The command of a step.
    ///
    /// # Errors
    /// As [`Tracker::step`].
    #[inline]
    pub fn step(&mut self, state: &State, reference: &Reference) -> Result<Step, StepError> {
        if self.alone { self.tracker.step(state, reference) } else { self.otherwise(state, reference) }
    }

    /// A step of a loaded table, or on the way from one law to another.
    #[cold]
    #[inline(never)]
    fn otherwise(&mut self, state: &State, reference: &Reference) -> Result<Step, StepError> {
        // What is chosen is on board; were it not, there would be no command.
        let Some(new) = self.tracker_of(&self.choice) else { return Err(StepError::Singular) };
        if self.fade.is_over() {
            return new.step(state, reference);
        }
        let old = self.tracker_of(&self.before).unwrap_or(new);
        let mut fade = self.fade;
        let step = fade.step(&old, &new, state, reference);
        self.fade = fade;
        self.alone = self.fade.is_over() && !matches!(self.choice.table, Table::Loaded(_));
        step
    }

    #[inline(never)]
    fn tracker_of(&self, choice: &LawChoice) -> Option<Tracker<'_>> {
        match choice.table {
            Table::Loaded(_) => Some(Tracker::new(self.store.law(choice)?, self.limits)),
            _ => built_in(choice, self.limits),
        }
    }
}

#[inline(never)]
fn built_in(choice: &LawChoice, limits: Limits) -> Option<Tracker<'static>> {
    choice.built_in().map(|law| Tracker::new(law, limits))
}
