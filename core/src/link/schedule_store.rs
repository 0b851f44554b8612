//! Uploaded gains over time: a blob in, the table that is flown out, and the one before kept to go back to.
//!
//! Beside [`super::GainStore`], because these tables are of another size: a slot takes 9 kB, so the store belongs in a
//! static, and a blob is copied into the slot that is not in use. [`crate::gains::table::TableKind::of`] says which of the
//! two stores a blob is for.

use heapless::Vec;

use crate::clock::Rate;
use crate::gains::table::{AcceptedSchedule, LoadError, SCHEDULE_BYTES_MAX, TableError, TableHead, Vehicle};
use crate::law::{AlongTrajectory, FeedForward};

/// Room for one table. An empty one is all zero bytes: a static one takes no flash.
#[derive(Clone, Debug)]
pub struct ScheduleSlot {
    /// Of the table in `bytes`, which has been accepted.
    head: Option<TableHead>,
    bytes: Vec<u8, SCHEDULE_BYTES_MAX>,
}

impl ScheduleSlot {
    /// Empty.
    pub const fn new() -> Self {
        Self { head: None, bytes: Vec::new() }
    }

    /// What the table says beside its gains, if there is one.
    pub const fn head(&self) -> Option<&TableHead> {
        self.head.as_ref()
    }

    /// The law, for a trajectory that is played at `player_rate`. The table is not checked again: this is for every step.
    pub fn law(&self, player_rate: Rate, feed_forward: FeedForward) -> Option<AlongTrajectory<'_>> {
        let schedule = AcceptedSchedule::gains_of_checked(&self.bytes)?;
        Some(AlongTrajectory::new(schedule, self.head.as_ref()?.rate, player_rate, feed_forward))
    }

    fn load(&mut self, blob: &[u8], vehicle: &Vehicle, rate: Rate) -> Result<(), LoadError> {
        let head = *AcceptedSchedule::from_bytes(blob, vehicle, rate)?.table().head();
        self.head = None;
        self.bytes.clear();
        // A table that has been read is never longer than the longest.
        let longest = TableError::Length { bytes: blob.len() as u32, wanted: SCHEDULE_BYTES_MAX as u32 };
        self.bytes.extend_from_slice(blob).map_err(|_| longest)?;
        self.head = Some(head);
        Ok(())
    }
}

impl Default for ScheduleSlot {
    fn default() -> Self {
        Self::new()
    }
}

/// Two slots: the table in use, and the one before it, which makes room for the next.
#[derive(Clone, Debug)]
pub struct ScheduleStore {
    vehicle: Vehicle,
    rate: Rate,
    slots: [ScheduleSlot; 2],
    second_in_use: bool,
}

impl ScheduleStore {
    /// Both slots empty, for tables of this vehicle at this rate of control steps.
    pub const fn new(vehicle: Vehicle, rate: Rate) -> Self {
        Self { vehicle, rate, slots: [const { ScheduleSlot::new() }; 2], second_in_use: false }
    }

    /// Reads and checks a blob, and only then puts it to use.
    ///
    /// # Errors
    /// [`LoadError`]; what was in use stays in use, and what was before it stays too.
    pub fn commit(&mut self, blob: &[u8]) -> Result<(), LoadError> {
        let [first, second] = &mut self.slots;
        let spare = if self.second_in_use { first } else { second };
        spare.load(blob, &self.vehicle, self.rate)?;
        self.second_in_use = !self.second_in_use;
        Ok(())
    }

    /// Goes back to the table before the one in use; says whether there was one. Twice leads back again.
    pub fn revert(&mut self) -> bool {
        let possible = self.previous().head.is_some();
        self.second_in_use ^= possible;
        possible
    }

    /// The slot in use.
    pub const fn active(&self) -> &ScheduleSlot {
        let [first, second] = &self.slots;
        if self.second_in_use { second } else { first }
    }

    /// The slot of the table that was in use before.
    pub const fn previous(&self) -> &ScheduleSlot {
        let [first, second] = &self.slots;
        if self.second_in_use { first } else { second }
    }
}
