//! Gain tables as bytes: a file or an upload in; gains with their vehicle, rate, limits and certificate out, or the
//! reason for none.
//!
//! A table goes through two gates. [`GainTable::from_bytes`] refuses what is no sound, certified table at all;
//! [`GainTable::accept_for`] what is not for this vehicle or this control rate. Only the [`AcceptedTable`] behind the
//! second one has a law to fly.
//!
//! Gains over time along a trajectory are too many to copy: [`ScheduleTable`] borrows them from their bytes, through the
//! same two gates. [`ActuatorTable`] is for the law that commands motor forces, and has their lag beside its gain.
//! [`TableKind::of`] says which of the three reads a file.
//!
//! ```
//! use quatrack::gains::table::{GainTable, LoadError, Vehicle};
//! use quatrack::{Controller, ErrorForm, FeedForward, Rate};
//!
//! fn controller_of(file: &[u8], vehicle: &Vehicle, rate: Rate) -> Result<f32, LoadError> {
//!     let table = GainTable::from_bytes(file)?.accept_for(vehicle, rate)?;
//!     let controller = Controller::new(table.law(FeedForward::With, ErrorForm::HeadingFrame), table.limits());
//!     # let _ = controller;
//!     Ok(table.head().certificate.delay_max_s)
//! }
//! ```

mod accepted;
mod actuator;
mod certificate;
mod error;
mod name;
mod schedule;
mod wire;

pub use accepted::AcceptedTable;
pub use actuator::{ACTUATOR_TABLE_BYTES, AcceptedActuatorTable, ActuatorTable};
pub use certificate::{Certificate, Figure, Hash, Margins, Vehicle};
pub use error::{AcceptError, KnotFault, LoadError, TableError};
pub use name::{Name, NameError};
pub use schedule::{AcceptedSchedule, KNOTS_MAX, SCHEDULE_BYTES_MAX, ScheduleRows, ScheduleTable};
pub use wire::{FORMAT_VERSION, MAGIC};

use core::fmt;

use crate::clock::Rate;
use crate::command::Limits;
use crate::flatness::GRAVITY_M_S2;
use crate::law::{EquilibriumGain, FlatOutputGain, IntegralGain};

/// Largest entry of a gain, in the units of its row and column: ten times what the stiffest design so far asks.
pub const ENTRY_MAX: f32 = 1e4;

/// Smallest entry that is not zero. What is smaller is left over from a solver, and would hide that a design falls apart
/// into chains: it is to be written as zero.
pub const ENTRY_MIN: f32 = 1e-9;

/// Largest thrust limit, m/s^2: twenty times the weight.
pub const THRUST_MAX_M_S2: f32 = 200.0;

/// Largest body rate limit, rad/s: almost three times what a gyroscope of 2000 degrees a second measures.
pub const BODY_RATE_MAX_RAD_S: f32 = 100.0;

/// Bytes of the longest [`GainTable`]; gains over time have [`SCHEDULE_BYTES_MAX`], those of motor forces
/// [`ACTUATOR_TABLE_BYTES`].
pub const TABLE_BYTES_MAX: usize = wire::FRAME_BYTES + wire::HEAD_BYTES + TableKind::FlatOutput.gain_bytes();

/// Which law a table is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TableKind {
    /// [`crate::Equilibrium`], 4 by 9.
    Equilibrium,
    /// [`crate::FlatOutput`], 7 by 10.
    FlatOutput,
    /// [`crate::IntegralAction`], 4 by 12.
    Integral,
    /// [`crate::AlongTrajectory`], 4 by 9 at each knot; read by [`ScheduleTable`].
    AlongTrajectory,
    /// [`crate::ActuatorAware`], 4 by 19; read by [`ActuatorTable`].
    ActuatorAware,
}

/// The entries of a gain, by rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rows {
    /// Outputs `[T p q r]` from errors `[x y z q1 q2 q3 vx vy vz]`.
    Equilibrium([[f32; 9]; 4]),
    /// Outputs `[a(3) j(3) q3']` from errors `[r(3) v(3) a(3) q3]`.
    FlatOutput([[f32; 10]; 7]),
    /// Outputs `[T p q r]` from errors `[x y z q1 q2 q3 vx vy vz ix iy iz]`, the last three their integrals, metre
    /// seconds.
    Integral([[f32; 12]; 4]),
}

impl Rows {
    /// The entries one row after the other.
    pub const fn entries(&self) -> &[f32] {
        match self {
            Self::Equilibrium(rows) => rows.as_flattened(),
            Self::FlatOutput(rows) => rows.as_flattened(),
            Self::Integral(rows) => rows.as_flattened(),
        }
    }
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
    Integral(IntegralGain),
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
        // Other readers' kinds have fields of their own.
        if !kind.is_read_elsewhere() && entries.len() != kind.gain_bytes() {
            return Err(wire::wrong_length(bytes, wire::HEAD_BYTES + kind.gain_bytes()));
        }
        let gains = Gains::read(kind, entries)?;
        Ok(Self { head: TableHead::read(fields)?, gains })
    }

    /// Writes the table over the start of `buffer` and returns that part; nothing if it is too short. The same table
    /// gives the same bytes; [`TABLE_BYTES_MAX`] are enough for any.
    pub fn to_bytes<'b>(&self, buffer: &'b mut [u8]) -> Option<&'b [u8]> {
        wire::write(buffer, self.kind(), &self.head, &[], self.rows().entries())
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
            Gains::Integral(_) => TableKind::Integral,
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
            Gains::Integral(gain) => Rows::Integral(gain.rows()),
        }
    }
}

impl TableHead {
    /// From the fields behind the kind. One function for all kinds of tables: it is long.
    #[inline(never)]
    fn read(mut fields: wire::Reader<'_>) -> Result<Self, TableError> {
        let head = fields.head()?;
        head.check()?;
        Ok(head)
    }

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
        match self.certificate.says_nothing() {
            Some((figure, value)) => Err(TableError::Uncertified { figure, value }),
            None => Ok(()),
        }
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
            Rows::Integral(rows) => Self::integral(rows),
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
            TableKind::Integral => {
                let mut rows = [[0.0; 12]; 4];
                wire::read_entries(entries, rows.as_flattened_mut());
                Self::integral(&rows)
            }
            TableKind::AlongTrajectory | TableKind::ActuatorAware => Err(TableError::OtherKind { kind }),
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

    fn integral(rows: &[[f32; 12]; 4]) -> Result<Self, TableError> {
        let gain = IntegralGain::new(*rows).map_err(TableError::Gain)?;
        in_proportion(rows.as_flattened(), 12)?;
        Ok(Self::Integral(gain))
    }
}

fn in_proportion(entries: &[f32], columns: u8) -> Result<(), TableError> {
    match out_of_proportion(entries, columns) {
        None => Ok(()),
        Some((row, column, value)) => Err(TableError::Entry { row, column, value }),
    }
}

/// The row, column and value of the first entry that is neither 0 nor of a size from [`ENTRY_MIN`] to [`ENTRY_MAX`].
#[inline(never)]
fn out_of_proportion(entries: &[f32], columns: u8) -> Option<(u8, u8, f32)> {
    let (mut row, mut column) = (0, 0);
    for value in entries.iter().copied() {
        if value != 0.0 && !(ENTRY_MIN..=ENTRY_MAX).contains(&value.abs()) {
            return Some((row, column, value));
        }
        column += 1;
        if column == columns {
            (row, column) = (row + 1, 0);
        }
    }
    None
}

impl TableKind {
    /// The kind of a table in a whole frame of this version, to choose who reads it; nothing else is looked at.
    ///
    /// # Errors
    /// [`TableError`] about the frame, the kind and its dimensions.
    pub fn of(bytes: &[u8]) -> Result<Self, TableError> {
        let payload = wire::open(bytes)?;
        wire::Reader::new(payload, wire::wrong_length(bytes, wire::HEAD_BYTES)).kind()
    }

    /// Its number in the bytes.
    pub const fn number(self) -> u8 {
        match self {
            Self::Equilibrium => 1,
            Self::FlatOutput => 2,
            Self::Integral => 3,
            Self::AlongTrajectory => 4,
            Self::ActuatorAware => 5,
        }
    }

    const fn numbered(number: u8) -> Option<Self> {
        match number {
            1 => Some(Self::Equilibrium),
            2 => Some(Self::FlatOutput),
            3 => Some(Self::Integral),
            4 => Some(Self::AlongTrajectory),
            5 => Some(Self::ActuatorAware),
            _ => None,
        }
    }

    /// Rows and columns of a gain.
    pub const fn dimensions(self) -> (u8, u8) {
        match self {
            Self::Equilibrium => (4, 9),
            Self::FlatOutput => (7, 10),
            Self::Integral => (4, 12),
            Self::AlongTrajectory => (4, 9),
            Self::ActuatorAware => (4, 19),
        }
    }

    /// Whether it is none of [`GainTable`]'s.
    const fn is_read_elsewhere(self) -> bool {
        matches!(self, Self::AlongTrajectory | Self::ActuatorAware)
    }

    /// Bytes of one gain.
    const fn gain_bytes(self) -> usize {
        let (rows, columns) = self.dimensions();
        4 * rows as usize * columns as usize
    }
}

impl fmt::Display for TableKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Equilibrium => "equilibrium",
            Self::FlatOutput => "flat output",
            Self::Integral => "equilibrium with integral action",
            Self::AlongTrajectory => "equilibrium along a trajectory",
            Self::ActuatorAware => "actuator-aware",
        })
    }
}
