//! Gain tables as bytes: a file or an upload in; gains with their vehicle, rate, limits and certificate out, or the
//! reason for none.
//!
//! A table goes through two gates. [`GainTable::from_bytes`] refuses what is no sound, certified table at all;
//! [`GainTable::accept_for`] what is not for this vehicle or this control rate. Only the [`AcceptedTable`] behind the
//! second one has a law to fly.
//!
//! ```
//! use quatrack::gains::table::{GainTable, LoadError, Vehicle};
//! use quatrack::{Equilibrium, FeedForward, ErrorForm, Rate, Tracker};
//!
//! fn tracker_of(file: &[u8], vehicle: &Vehicle, rate: Rate) -> Result<f32, LoadError> {
//!     let table = GainTable::from_bytes(file)?.accept_for(vehicle, rate)?;
//!     let tracker = Tracker::new(table.law(FeedForward::With, ErrorForm::HeadingFrame), table.limits());
//!     # let _ = tracker;
//!     Ok(table.head().certificate.delay_max_s)
//! }
//! ```

mod accepted;
mod certificate;
mod error;
mod name;
mod wire;

pub use accepted::AcceptedTable;
pub use certificate::{Certificate, Figure, Hash, Margins, Vehicle};
pub use error::{AcceptError, LoadError, TableError};
pub use name::{Name, NameError};
pub use wire::{FORMAT_VERSION, MAGIC};

use core::fmt;

use crate::clock::Rate;
use crate::command::Limits;
use crate::flatness::GRAVITY_M_S2;
use crate::law::{EquilibriumGain, FlatOutputGain};

/// Largest entry of a gain, in the units of its row and column: ten times what the stiffest design so far asks.
pub const ENTRY_MAX: f32 = 1e4;

/// Smallest entry that is not zero. What is smaller is left over from a solver, and would hide that a design falls apart
/// into chains: it is to be written as zero.
pub const ENTRY_MIN: f32 = 1e-9;

/// Largest thrust limit, m/s^2: twenty times the weight.
pub const THRUST_MAX_M_S2: f32 = 200.0;

/// Largest body rate limit, rad/s: almost three times what a gyroscope of 2000 degrees a second measures.
pub const BODY_RATE_MAX_RAD_S: f32 = 100.0;

/// Bytes of the longest table.
pub const TABLE_BYTES_MAX: usize = wire::FRAME_BYTES + TableKind::FlatOutput.payload_bytes() as usize;

/// Which law a table is for. Numbers 3 (equilibrium with the integral of the position error, 4 by 12) and 4 (gains over
/// time) are taken for laws to come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TableKind {
    /// [`crate::Equilibrium`], 4 by 9.
    Equilibrium,
    /// [`crate::FlatOutput`], 7 by 10.
    FlatOutput,
}

/// The entries of a gain, by rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rows {
    /// Outputs `[T p q r]` from errors `[x y z q1 q2 q3 vx vy vz]`.
    Equilibrium([[f32; 9]; 4]),
    /// Outputs `[a(3) j(3) q3']` from errors `[r(3) v(3) a(3) q3]`.
    FlatOutput([[f32; 10]; 7]),
}

/// What a table says beside its gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableHead {
    /// The table's own name.
    pub name: Name,
    /// Whom it is for.
    pub vehicle: Vehicle,
    /// The control rate that it was certified at.
    pub rate: Rate,
    /// What the vehicle can be asked for.
    pub limits: Limits,
    /// Of the design that the gains were computed from.
    pub design_hash: Hash,
    /// What was proven.
    pub certificate: Certificate,
}

/// A sound and certified table; see [`GainTable::accept_for`] for one that is flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainTable {
    head: TableHead,
    gains: Gains,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Gains {
    Equilibrium(EquilibriumGain),
    FlatOutput(FlatOutputGain),
}

impl GainTable {
    /// Checks the parts of a table that is to be written.
    ///
    /// # Errors
    /// [`TableError`], as [`Self::from_bytes`] would find in it.
    pub fn new(head: TableHead, rows: &Rows) -> Result<Self, TableError> {
        let gains = Gains::new(rows)?;
        head.check()?;
        Ok(Self { head, gains })
    }

    /// Reads a table.
    ///
    /// # Errors
    /// [`TableError`]: the first thing that is wrong, from the frame inwards.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TableError> {
        let payload = wire::open(bytes)?;
        let cut = wire::wrong_length(bytes, wire::HEAD_BYTES);
        let (head, entries) = payload.split_first_chunk::<{ wire::HEAD_BYTES }>().ok_or(cut)?;
        let mut fields = wire::Reader::new(head, cut);
        let kind = fields.kind()?;
        if payload.len() != usize::from(kind.payload_bytes()) {
            return Err(wire::wrong_length(bytes, usize::from(kind.payload_bytes())));
        }
        let gains = Gains::read(kind, entries)?;
        let head = fields.head()?;
        head.check()?;
        Ok(Self { head, gains })
    }

    /// Writes the table over the start of `buffer` and returns that part; nothing if it is too short. The same table
    /// gives the same bytes; [`TABLE_BYTES_MAX`] are enough for any.
    pub fn to_bytes<'b>(&self, buffer: &'b mut [u8]) -> Option<&'b [u8]> {
        match &self.gains {
            Gains::Equilibrium(gain) => wire::write(buffer, self.kind(), &self.head, gain.gain().rows().as_flattened()),
            Gains::FlatOutput(gain) => wire::write(buffer, self.kind(), &self.head, gain.gain().rows().as_flattened()),
        }
    }

    /// The table as one that this board flies: it was designed for `vehicle` and certified at `rate`, that of the
    /// control steps.
    ///
    /// # Errors
    /// [`AcceptError`].
    pub fn accept_for(self, vehicle: &Vehicle, rate: Rate) -> Result<AcceptedTable, AcceptError> {
        self.head.accept_for(vehicle, rate)?;
        Ok(AcceptedTable::of(self))
    }

    /// Which law it is for.
    pub const fn kind(&self) -> TableKind {
        match &self.gains {
            Gains::Equilibrium(_) => TableKind::Equilibrium,
            Gains::FlatOutput(_) => TableKind::FlatOutput,
        }
    }

    /// What it says beside the gains.
    pub const fn head(&self) -> &TableHead {
        &self.head
    }

    /// The gains, to be looked at.
    pub const fn rows(&self) -> Rows {
        match &self.gains {
            Gains::Equilibrium(gain) => Rows::Equilibrium(*gain.gain().rows()),
            Gains::FlatOutput(gain) => Rows::FlatOutput(*gain.gain().rows()),
        }
    }
}

impl TableHead {
    fn check(&self) -> Result<(), TableError> {
        let (min_m_s2, max_m_s2) = (self.limits.thrust_min_m_s2(), self.limits.thrust_max_m_s2());
        if !(min_m_s2 < GRAVITY_M_S2 && max_m_s2 > GRAVITY_M_S2 && max_m_s2 <= THRUST_MAX_M_S2) || min_m_s2 < 0.0 {
            return Err(TableError::Thrust { min_m_s2, max_m_s2 });
        }
        if let Some(&max_rad_s) = self.limits.body_rates_max_rad_s().iter().find(|max| **max > BODY_RATE_MAX_RAD_S) {
            return Err(TableError::BodyRate { max_rad_s });
        }
        if self.design_hash == Hash::NONE {
            return Err(TableError::NoDesign);
        }
        if self.certificate.hash == Hash::NONE {
            return Err(TableError::NoCertificate);
        }
        self.certificate.check()
    }

    pub(crate) fn accept_for(&self, vehicle: &Vehicle, rate: Rate) -> Result<(), AcceptError> {
        if self.vehicle != *vehicle {
            return Err(AcceptError::Vehicle { table: self.vehicle });
        }
        if self.rate != rate {
            return Err(AcceptError::Rate { table_hz: self.rate.hz(), loop_hz: rate.hz() });
        }
        Ok(())
    }
}

impl Gains {
    fn new(rows: &Rows) -> Result<Self, TableError> {
        match rows {
            Rows::Equilibrium(rows) => Self::equilibrium(rows),
            Rows::FlatOutput(rows) => Self::flat_output(rows),
        }
    }

    /// From the bytes behind the head.
    fn read(kind: TableKind, entries: &[u8]) -> Result<Self, TableError> {
        match kind {
            TableKind::Equilibrium => {
                let mut rows = [[0.0; 9]; 4];
                wire::read_entries(entries, rows.as_flattened_mut());
                Self::equilibrium(&rows)
            }
            TableKind::FlatOutput => {
                let mut rows = [[0.0; 10]; 7];
                wire::read_entries(entries, rows.as_flattened_mut());
                Self::flat_output(&rows)
            }
        }
    }

    fn equilibrium(rows: &[[f32; 9]; 4]) -> Result<Self, TableError> {
        let gain = EquilibriumGain::new(*rows).map_err(TableError::Gain)?;
        in_proportion(rows.as_flattened(), 9)?;
        Ok(Self::Equilibrium(gain))
    }

    fn flat_output(rows: &[[f32; 10]; 7]) -> Result<Self, TableError> {
        let gain = FlatOutputGain::new(*rows).map_err(TableError::Gain)?;
        in_proportion(rows.as_flattened(), 10)?;
        Ok(Self::FlatOutput(gain))
    }
}

/// Whether every entry is 0 or of a size from [`ENTRY_MIN`] to [`ENTRY_MAX`].
#[inline(never)]
fn in_proportion(entries: &[f32], columns: u8) -> Result<(), TableError> {
    let (mut row, mut column) = (0, 0);
    for value in entries.iter().copied() {
        if value != 0.0 && !(ENTRY_MIN..=ENTRY_MAX).contains(&value.abs()) {
            return Err(TableError::Entry { row, column, value });
        }
        column += 1;
        if column == columns {
            (row, column) = (row + 1, 0);
        }
    }
    Ok(())
}

impl TableKind {
    /// Its number in the bytes.
    const fn number(self) -> u8 {
        match self {
            Self::Equilibrium => 1,
            Self::FlatOutput => 2,
        }
    }

    const fn numbered(number: u8) -> Option<Self> {
        match number {
            1 => Some(Self::Equilibrium),
            2 => Some(Self::FlatOutput),
            _ => None,
        }
    }

    /// Rows and columns.
    pub const fn dimensions(self) -> (u8, u8) {
        match self {
            Self::Equilibrium => (4, 9),
            Self::FlatOutput => (7, 10),
        }
    }

    const fn payload_bytes(self) -> u16 {
        let (rows, columns) = self.dimensions();
        wire::HEAD_BYTES as u16 + 4 * rows as u16 * columns as u16
    }
}

impl fmt::Display for TableKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Equilibrium => "equilibrium",
            Self::FlatOutput => "flat output",
        })
    }
}
