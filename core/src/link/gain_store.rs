//! Uploaded gain tables of any kind: a blob in, the table that is flown out, and the one before kept to go back to.
//!
//! The blob is a table as [`crate::gains::table`] has it. Between two steps a commit changes the table as a whole: a step
//! sees the old one or the new one. Where reading takes longer than a period, it is done outside the step's lock:
//!
//! ```
//! use quatrack::Rate;
//! use quatrack::gains::table::{GainTable, LoadError, Vehicle};
//! use quatrack::link::GainStore;
//!
//! /// In the task of the link. Only the last line keeps the control loop waiting.
//! fn commit(store: &mut GainStore, blob: &[u8], vehicle: &Vehicle, rate: Rate) -> Result<(), LoadError> {
//!     let table = GainTable::from_bytes(blob)?;
//!     let accepted = table.accept_for(vehicle, rate)?;
//!     Ok(store.activate(&accepted)?)
//! }
//! ```

use heapless::Vec;

use super::trajectory_store::BlobError;
use crate::clock::Rate;
use crate::gains::table::{AcceptError, AcceptedTable, Content, GainTable, KNOTS_MAX, LoadError, TableHead, Vehicle};
use crate::law::Knot;

/// Two slots: the table in use, and the one before it, which makes room for the next. Each has room for `KNOTS` gains along a
/// trajectory, 144 bytes each: a store belongs in a static.
#[derive(Clone, Debug)]
pub struct GainStore<const KNOTS: usize = KNOTS_MAX> {
    board: Option<(Vehicle, Rate)>,
    slots: [Slot<KNOTS>; 2],
    second_in_use: bool,
}

/// Of one table or none. Not an option of one: an empty slot is all zero bytes, and a static one then takes no flash.
#[derive(Clone, Debug)]
struct Slot<const KNOTS: usize> {
    content: Vec<Content, 1>,
    knots: Vec<Knot, KNOTS>,
}

impl<const KNOTS: usize> Slot<KNOTS> {
    const EMPTY: Self = Self { content: Vec::new(), knots: Vec::new() };

    fn clear(&mut self) {
        self.content.clear();
        self.knots.clear();
    }

    fn table(&self) -> Option<AcceptedTable<'_>> {
        Some(AcceptedTable::of(self.content.first()?, &self.knots))
    }
}

impl<const KNOTS: usize> GainStore<KNOTS> {
    /// Both slots empty, for tables of this vehicle at this rate of control steps.
    pub const fn new(vehicle: Vehicle, rate: Rate) -> Self {
        Self { board: Some((vehicle, rate)), slots: [Slot::EMPTY; 2], second_in_use: false }
    }

    /// Takes no table before it is assigned; all zeros.
    pub const fn unassigned() -> Self {
        Self { board: None, slots: [Slot::EMPTY; 2], second_in_use: false }
    }

    /// Takes tables of this vehicle at this rate from now on, or none at all. Tables loaded before are dropped.
    pub fn assign(&mut self, board: Option<(Vehicle, Rate)>) {
        self.board = board;
        self.slots.iter_mut().for_each(Slot::clear);
    }

    /// The vehicle whose tables are taken, and the rate of control steps that they must be certified at.
    pub const fn board(&self) -> Option<&(Vehicle, Rate)> {
        self.board.as_ref()
    }

    /// Reads and checks a blob, and only then puts it to use.
    ///
    /// # Errors
    /// [`LoadError`]; the table in use stays in use, and the one before it stays too.
    pub fn commit(&mut self, blob: &[u8]) -> Result<(), LoadError> {
        let table = GainTable::from_bytes(blob)?;
        let (vehicle, rate) = *self.board_for(table.head())?;
        Ok(self.put_to_use(&table.accept_for(&vehicle, rate)?)?)
    }

    /// Puts to use a table that has been read elsewhere.
    ///
    /// # Errors
    /// [`AcceptError`] where it was accepted for another board, or has more knots than there is room for; nothing changes then.
    pub fn activate(&mut self, table: &AcceptedTable<'_>) -> Result<(), AcceptError> {
        let (vehicle, rate) = self.board_for(table.head())?;
        table.head().accept_for(vehicle, *rate)?;
        self.put_to_use(table)
    }

    /// Goes back to the table before the one in use; says whether there was one. Twice leads back again.
    pub fn revert(&mut self) -> bool {
        let possible = self.previous().is_some();
        self.second_in_use ^= possible;
        possible
    }

    /// The table in use.
    pub fn active(&self) -> Option<AcceptedTable<'_>> {
        let [first, second] = &self.slots;
        if self.second_in_use { second.table() } else { first.table() }
    }

    /// The table that was in use before.
    pub fn previous(&self) -> Option<AcceptedTable<'_>> {
        let [first, second] = &self.slots;
        if self.second_in_use { first.table() } else { second.table() }
    }

    /// The loaded table that a choice names: slot 0 is the one in use, slot 1 the one before.
    pub fn table(&self, slot: u8) -> Option<AcceptedTable<'_>> {
        match slot {
            0 => self.active(),
            1 => self.previous(),
            _ => None,
        }
    }

    /// The vehicle and the rate that this board is assigned to. A board that is assigned to none refuses every table.
    fn board_for(&self, table: &TableHead) -> Result<&(Vehicle, Rate), AcceptError> {
        self.board.as_ref().ok_or(AcceptError::Vehicle { table: table.vehicle })
    }

    fn put_to_use(&mut self, table: &AcceptedTable<'_>) -> Result<(), AcceptError> {
        let (content, knots) = table.parts();
        if knots.len() > KNOTS {
            let count = |knots: usize| u16::try_from(knots).unwrap_or(u16::MAX);
            return Err(AcceptError::Knots { knots: count(knots.len()), room: count(KNOTS) });
        }
        let [first, second] = &mut self.slots;
        let spare = if self.second_in_use { first } else { second };
        spare.clear();
        // There is room for both.
        let _ = spare.content.push(*content);
        let _ = spare.knots.extend_from_slice(knots);
        self.second_in_use = !self.second_in_use;
        Ok(())
    }
}

impl From<LoadError> for BlobError {
    fn from(error: LoadError) -> Self {
        Self::GainTable(error)
    }
}
