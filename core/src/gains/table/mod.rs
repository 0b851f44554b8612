//! Gain tables as bytes: a file or an upload in; gains with their vehicle, rate, limits and certificate out, or the
//! reason for none.
//!
//! A table goes through two gates, whichever law it is for. [`GainTable::from_bytes`] refuses bytes that are no sound,
//! certified table at all; [`GainTable::accept_for`] one that is not for this vehicle or this control rate. Only the
//! [`AcceptedTable`] behind the second one becomes a controller.
//!
//! Gains along a trajectory are too many to copy: a table borrows them from its bytes.
//!
//! ```
//! use quatrack::gains::table::{GainTable, Vehicle};
//! use quatrack::{Actuation, ErrorForm, FeedForward, Limits, Rate, Settings};
//!
//! fn largest_delay_s(file: &[u8], vehicle: &Vehicle, rate: Rate, board: &Actuation) -> Result<f32, Box<dyn std::error::Error>> {
//!     let table = GainTable::from_bytes(file)?;
//!     let accepted = table.accept_for(vehicle, rate)?;
//!     let actuation = accepted.actuation(board);
//!     let (feed_forward, error_form) = (FeedForward::With, ErrorForm::HeadingFrame);
//!     let settings = Settings {
//!         actuation: Some(&actuation), feed_forward, error_form, ..Settings::new(Limits::NONE, rate)
//!     };
//!     let controller = accepted.controller(&settings)?;
//!     # let _ = controller;
//!     Ok(accepted.head().certificate.delay_max_s)
//! }
//! ```

mod accepted;
#[cfg(feature = "cascade")]
mod cascade;
mod certificate;
mod error;
mod gain_table;
mod gains;
mod name;
mod wire;

pub use accepted::{AcceptedTable, margin_behind};
#[cfg(feature = "cascade")]
pub use cascade::{BuiltInCascade, CascadeRange, CascadeTable};
pub use certificate::{Certificate, Figure, Hash, Margins, Vehicle};
pub use error::{AcceptError, CascadeFigure, KnotFault, LoadError, TableError};
pub use gain_table::GainTable;
#[cfg(feature = "link")]
pub(crate) use gains::Content;
pub use name::{Name, NameError};
pub use wire::{FORMAT_VERSION, MAGIC};

use core::fmt;

use self::gains::ALONG_BYTES;
use crate::clock::Rate;
use crate::command::Limits;
use crate::flatness::GRAVITY_M_S2;

/// Largest entry of a gain, in the units of its row and column: ten times that of the stiffest design so far.
pub const ENTRY_MAX: f32 = 1e4;

/// Smallest entry that is not zero. A smaller one is left over from a solver, and would hide that a design decouples
/// into chains: it is to be written as zero.
pub const ENTRY_MIN: f32 = 1e-9;

/// Largest thrust limit, m/s^2: twenty times the weight.
pub const THRUST_MAX_M_S2: f32 = 200.0;

/// Largest body rate limit, rad/s: almost three times the range of a gyroscope of 2000 degrees a second.
pub const BODY_RATE_MAX_RAD_S: f32 = 100.0;

/// Most knots along a trajectory: with as many, a table is about as long as the longest trajectory that is uploaded.
pub const KNOTS_MAX: usize = 60;

/// Bytes of the longest table: one of gains along a trajectory.
pub const TABLE_BYTES_MAX: usize =
    wire::FRAME_BYTES + wire::HEAD_BYTES + ALONG_BYTES + KNOTS_MAX * TableKind::AlongTrajectory.gain_bytes();

/// Bytes of the longest table whose gain is the same all the time: one of the actuator-aware law, a float for the lag beside its
/// gain, which is to come whole and be refused by name.
pub const CONSTANT_TABLE_BYTES_MAX: usize =
    wire::FRAME_BYTES + wire::HEAD_BYTES + 4 + TableKind::ActuatorAware.gain_bytes();

/// Which law a table is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum TableKind {
    /// [`crate::Equilibrium`], 4 by 9.
    Equilibrium,
    /// [`crate::FlatOutput`], 7 by 10.
    FlatOutput,
    /// [`crate::IntegralAction`], 4 by 12.
    Integral,
    /// [`crate::AlongTrajectory`], 4 by 9 at each knot.
    AlongTrajectory,
    /// The law before the cascade, 4 by 19: no table of it is read ([`TableError::ActuatorAware`]).
    ActuatorAware,
    /// The cascade (feature `cascade`): 16 gains of four chains.
    Cascade,
}

/// The entries of one gain by rows, from which its table is written. One of the cascade is written from a `CascadeTable`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
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

/// The gains along a trajectory from which a table is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScheduleRows<'a> {
    /// [`crate::Trajectory::checksum`] of the trajectory that they are for.
    pub trajectory: u32,
    /// Control steps from one knot to the next, at the rate in the head.
    pub steps_per_knot: u16,
    /// The gains by rows, the first at the trajectory's start: outputs `[T p q r]` from errors
    /// `[x y z q1 q2 q3 vx vy vz]`.
    pub gains: &'a [[[f32; 9]; 4]],
}

/// The head of a table: all but its gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableHead {
    /// The table's own name.
    pub name: Name,
    /// The vehicle that it is for.
    pub vehicle: Vehicle,
    /// The control rate that it was certified at.
    pub rate: Rate,
    /// Limits of the vehicle's commands.
    pub limits: Limits,
    /// Of the design that the gains were computed from.
    pub design_hash: Hash,
    /// The computed figures of its closed loop.
    pub certificate: Certificate,
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

impl TableKind {
    /// The kind of a table in a whole frame of this version, to choose the reader; nothing else is looked at.
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
            Self::Cascade => 6,
        }
    }

    const fn numbered(number: u8) -> Option<Self> {
        match number {
            1 => Some(Self::Equilibrium),
            2 => Some(Self::FlatOutput),
            3 => Some(Self::Integral),
            4 => Some(Self::AlongTrajectory),
            5 => Some(Self::ActuatorAware),
            6 => Some(Self::Cascade),
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
            Self::Cascade => (1, 16),
        }
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
            Self::Cascade => "cascade",
        })
    }
}
