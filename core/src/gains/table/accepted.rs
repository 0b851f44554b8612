//! A table that this board flies: an accepted one in, a law out.

use super::{GainTable, Gains, LoadError, TableHead, TableKind, Vehicle};
use crate::clock::Rate;
use crate::command::Limits;
use crate::law::{AnyLaw, Equilibrium, ErrorForm, FeedForward, FlatOutput, FlightLaw, IntegralAction};

/// A table for this board's vehicle and rate; made by [`GainTable::accept_for`] alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AcceptedTable {
    table: GainTable,
}

impl AcceptedTable {
    pub(super) const fn of(table: GainTable) -> Self {
        Self { table }
    }

    /// Reads a table and accepts it, in one.
    ///
    /// # Errors
    /// [`LoadError`].
    pub fn from_bytes(bytes: &[u8], vehicle: &Vehicle, rate: Rate) -> Result<Self, LoadError> {
        Ok(GainTable::from_bytes(bytes)?.accept_for(vehicle, rate)?)
    }

    /// The law. Only the equilibrium law asks for the form of the error; the others have one.
    #[inline]
    pub fn law(&self, feed_forward: FeedForward, error_form: ErrorForm) -> FlightLaw<'_> {
        let fixed = match &self.table.gains {
            Gains::Equilibrium(gain) => AnyLaw::Equilibrium(Equilibrium { gain, error_form, feed_forward }),
            Gains::FlatOutput(gain) => AnyLaw::FlatOutput(FlatOutput { gain, feed_forward }),
            Gains::Integral(gain) => return IntegralAction::new(gain, self.table.head.rate, feed_forward).into(),
        };
        FlightLaw::Fixed(fixed)
    }

    /// Which law it is for.
    pub const fn kind(&self) -> TableKind {
        self.table.kind()
    }

    /// What the vehicle can be asked for.
    pub const fn limits(&self) -> Limits {
        self.table.head.limits
    }

    /// What it says beside the gains.
    pub const fn head(&self) -> &TableHead {
        &self.table.head
    }

    /// The table, to be looked at or written.
    pub const fn table(&self) -> &GainTable {
        &self.table
    }
}
