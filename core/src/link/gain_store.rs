//! Uploaded gain tables: a blob in, the table that is flown out, and the one before kept to go back to.
//!
//! The blob is a table as [`crate::gains::table`] has it. Between two steps a commit changes the table as a whole: a step
//! sees the old one or the new one. Where reading takes longer than a period, it is done outside the step's lock:
//!
//! ```
//! use quatrack::gains::table::{AcceptedTable, LoadError};
//! use quatrack::link::GainStore;
//!
//! /// In the task of the link. Only the last line keeps the control loop waiting.
//! fn commit(store: &mut GainStore, blob: &[u8]) -> Result<(), LoadError> {
//!     let (vehicle, rate) = (*store.vehicle(), store.rate());
//!     let table = AcceptedTable::from_bytes(blob, &vehicle, rate)?;
//!     Ok(store.activate(&table)?)
//! }
//! ```

use super::law_choice::{LawChoice, Table};
use super::trajectory_store::BlobError;
use crate::clock::Rate;
use crate::gains::table::{AcceptError, AcceptedTable, LoadError, Vehicle};
use crate::law::{AnyLaw, FlightLaw};

/// Two slots: the table in use, and the one before it, which makes room for the next.
#[derive(Clone, Debug)]
pub struct GainStore {
    vehicle: Vehicle,
    rate: Rate,
    slots: [Option<AcceptedTable>; 2],
    second_in_use: bool,
}

impl GainStore {
    /// Both slots empty, for tables of this vehicle at this rate of control steps.
    pub const fn new(vehicle: Vehicle, rate: Rate) -> Self {
        Self { vehicle, rate, slots: [None; 2], second_in_use: false }
    }

    /// Whose tables are taken.
    pub const fn vehicle(&self) -> &Vehicle {
        &self.vehicle
    }

    /// The rate of control steps that tables must be certified at.
    pub const fn rate(&self) -> Rate {
        self.rate
    }

    /// Reads and checks a blob, and only then puts it to use.
    ///
    /// # Errors
    /// [`LoadError`]; what was in use stays in use, and what was before it stays too.
    pub fn commit(&mut self, blob: &[u8]) -> Result<(), LoadError> {
        let table = AcceptedTable::from_bytes(blob, &self.vehicle, self.rate)?;
        self.put_to_use(&table);
        Ok(())
    }

    /// Puts to use what has been read elsewhere.
    ///
    /// # Errors
    /// [`AcceptError`] where it was accepted for another board; nothing changes then.
    pub fn activate(&mut self, table: &AcceptedTable) -> Result<(), AcceptError> {
        table.head().accept_for(&self.vehicle, self.rate)?;
        self.put_to_use(table);
        Ok(())
    }

    /// Goes back to the table before the one in use; says whether there was one. Twice leads back again.
    pub fn revert(&mut self) -> bool {
        let possible = self.previous().is_some();
        self.second_in_use ^= possible;
        possible
    }

    /// The table in use.
    pub const fn active(&self) -> Option<&AcceptedTable> {
        let [first, second] = &self.slots;
        if self.second_in_use { second.as_ref() } else { first.as_ref() }
    }

    /// The table that was in use before.
    pub const fn previous(&self) -> Option<&AcceptedTable> {
        let [first, second] = &self.slots;
        if self.second_in_use { first.as_ref() } else { second.as_ref() }
    }

    /// The loaded table that a choice names: slot 0 is the one in use, slot 1 the one before.
    pub const fn table(&self, slot: u8) -> Option<&AcceptedTable> {
        match slot {
            0 => self.active(),
            1 => self.previous(),
            _ => None,
        }
    }

    /// The chosen law, of a table in the image or of a loaded one, for [`crate::Controller`].
    pub fn flight_law(&self, choice: &LawChoice) -> Option<FlightLaw<'_>> {
        match choice.table {
            Table::Loaded(slot) => Some(self.table(slot)?.law(choice.feed_forward, choice.error_form)),
            _ => choice.built_in().map(FlightLaw::Fixed),
        }
    }

    /// The same for [`crate::Tracker`]: nothing where the law remembers anything.
    pub fn law(&self, choice: &LawChoice) -> Option<AnyLaw<'_>> {
        self.flight_law(choice).and_then(FlightLaw::fixed)
    }

    fn put_to_use(&mut self, table: &AcceptedTable) {
        let [first, second] = &mut self.slots;
        *(if self.second_in_use { first } else { second }) = Some(*table);
        self.second_in_use = !self.second_in_use;
    }
}

impl From<LoadError> for BlobError {
    fn from(error: LoadError) -> Self {
        Self::GainTable(error)
    }
}
