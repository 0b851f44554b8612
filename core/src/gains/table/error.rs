//! Why bytes are no table, and why a table is not flown here: one variant for each reason, with the value found.

mod place;
mod refusal;

use core::fmt;

pub use self::place::{CascadeFigure, KnotFault};
pub use self::refusal::{AcceptError, LoadError};
use super::TableKind;
use super::certificate::Figure;
use super::name::NameError;
use crate::command::LimitsError;
use crate::gain::GainError;
use crate::law::ScheduleError;

/// Why bytes are no gain table, or numbers no table to be written.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum TableError {
    /// The first four bytes are not [`super::MAGIC`].
    Magic {
        /// The bytes found.
        found: [u8; 4],
    },
    /// Cut off, or with bytes behind the end.
    Length {
        /// Bytes found.
        bytes: u32,
        /// Bytes that the frame states, or that its kind has.
        wanted: u32,
    },
    /// The bytes are not those that were written.
    Checksum {
        /// The stated checksum.
        stated: u32,
        /// The checksum of the bytes received.
        found: u32,
    },
    /// Written by a later or an earlier format.
    Version {
        /// The version found.
        found: u16,
    },
    /// A kind of table that this firmware does not fly.
    Kind {
        /// Its number.
        found: u8,
    },
    /// A table of the law before the cascade, which no board flies any more.
    ActuatorAware,
    /// The matrix has other dimensions than its kind.
    Dimensions {
        /// The kind that the table states.
        kind: TableKind,
        /// Rows found.
        rows: u8,
        /// Columns found.
        columns: u8,
    },
    /// An entry is not finite, or an error goes unused.
    Gain(GainError),
    /// An entry is out of proportion: larger than [`super::ENTRY_MAX`], or not zero and below [`super::ENTRY_MIN`].
    Entry {
        /// Row, from 0.
        row: u8,
        /// Column, from 0.
        column: u8,
        /// The value found.
        value: f32,
    },
    /// The table's own name is none.
    TableName(NameError),
    /// The vehicle's name is none.
    VehicleName(NameError),
    /// No control rate.
    Rate {
        /// The value found, Hz.
        hz: u32,
    },
    /// The vehicle's limits are none.
    Limits(LimitsError),
    /// The limits are out of proportion: hover is not within, or beyond [`super::THRUST_MAX_M_S2`].
    Thrust {
        /// Least thrust, m/s^2.
        min_m_s2: f32,
        /// Most thrust, m/s^2.
        max_m_s2: f32,
    },
    /// A body rate limit is beyond [`super::BODY_RATE_MAX_RAD_S`].
    BodyRate {
        /// The limit, rad/s.
        max_rad_s: f32,
    },
    /// The design's hash is zero: the origin of the gains is unknown.
    NoDesign,
    /// The certificate's hash is zero.
    NoCertificate,
    /// The certificate leaves no room for any error, or a figure of it is no such figure.
    Uncertified {
        /// The figure.
        figure: Figure,
        /// The value found.
        value: f32,
    },
    /// Gains over time with fewer than 2 knots or more than [`super::KNOTS_MAX`].
    Knots {
        /// Knots found.
        found: u16,
    },
    /// Gains over time whose knots are no control step apart.
    KnotSpacing,
    /// The motor lag that a table was designed for is shorter than two control periods, longer than certified, or NaN.
    MotorLag {
        /// The value found, s.
        lag_s: f32,
    },
    /// A fault of the gain at one knot of gains over time.
    Knot {
        /// The knot, from 0.
        knot: u16,
        /// The fault, within its gain.
        fault: KnotFault,
    },
    /// A figure that a table of the cascade has beside the head has no sense.
    Cascade {
        /// The figure.
        figure: CascadeFigure,
        /// The value found.
        value: f32,
    },
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("gain table: ")?;
        match self {
            Self::Magic { found } => {
                write!(f, "starts with {found:02x?}, not {:02x?}; give a binary gain table", super::MAGIC)
            }
            Self::Length { bytes, wanted } => {
                write!(f, "{bytes} bytes, not {wanted}; copy the whole file, nothing else")
            }
            Self::Checksum { stated, found } => {
                write!(f, "checksum {found:08x}, stated {stated:08x}; damaged, send it again")
            }
            Self::Version { found } => {
                let version = super::FORMAT_VERSION;
                write!(
                    f,
                    "format version {found}, not {version}; write it again with `quatrack gains design`, with the program of the \
                     firmware's release"
                )
            }
            Self::Kind { found } => write!(f, "kind {found} is not flown by this firmware; update it"),
            Self::ActuatorAware => f.write_str(
                "of the actuator-aware law, which is not flown any more; design one of the cascade: `quatrack gains design` with \
                 method = \"cascade\"",
            ),
            Self::Dimensions { kind, rows, columns } => {
                let (m, n) = kind.dimensions();
                write!(f, "{rows} by {columns}, but {kind} is {m} by {n}; generate it again")
            }
            Self::Gain(error) => write!(f, "{error}; design it again"),
            Self::Entry { row, column, value } => entry_out_of_proportion(f, *row, *column, *value),
            Self::TableName(error) => write!(f, "its own {error}"),
            Self::VehicleName(error) => write!(f, "its vehicle's {error}"),
            Self::Rate { hz } => write!(f, "control rate {hz} Hz; state the rate it was certified at"),
            Self::Limits(error) => error.fmt(f),
            Self::Thrust { min_m_s2, max_m_s2 } => write!(
                f,
                "thrust from {min_m_s2} to {max_m_s2} m/s^2; must hold hover and end at {} or below",
                super::THRUST_MAX_M_S2
            ),
            Self::BodyRate { max_rad_s } => {
                write!(f, "body rate {max_rad_s} rad/s; must be {} or below", super::BODY_RATE_MAX_RAD_S)
            }
            Self::NoDesign => f.write_str("no design hash; generate it from a design"),
            Self::NoCertificate => f.write_str("no certificate; certify the design"),
            Self::Uncertified { figure, value } => {
                write!(f, "certified {figure} is {value}, which certifies nothing; change the design")
            }
            Self::Knots { found } => {
                write!(f, "{found} knots; must be 2 to {}: change their spacing", super::KNOTS_MAX)
            }
            Self::MotorLag { lag_s } => write!(
                f,
                "designed for a motor lag of {lag_s} s; must be from two control periods to the largest that is certified"
            ),
            Self::Cascade { figure, value } => write!(f, "{figure} is {value}; design it again"),
            Self::KnotSpacing => f.write_str("knots 0 control steps apart; must be at least 1"),
            Self::Knot { knot, fault: KnotFault::Gain(error) } => write!(f, "knot {knot}: {error}; design it again"),
            Self::Knot { knot, fault: KnotFault::Entry { row, column, value } } => {
                write!(f, "knot {knot}: ")?;
                entry_out_of_proportion(f, *row, *column, *value)
            }
        }
    }
}

fn entry_out_of_proportion(f: &mut fmt::Formatter<'_>, row: u8, column: u8, value: f32) -> fmt::Result {
    let (min, max) = (super::ENTRY_MIN, super::ENTRY_MAX);
    write!(f, "entry ({row}, {column}) is {value:e}; must be 0 or of a size from {min:e} to {max:e}")
}

impl core::error::Error for TableError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Gain(error) | Self::Knot { fault: KnotFault::Gain(error), .. } => Some(error),
            Self::TableName(error) | Self::VehicleName(error) => Some(error),
            Self::Limits(error) => Some(error),
            _ => None,
        }
    }
}

impl From<ScheduleError> for TableError {
    fn from(error: ScheduleError) -> Self {
        match error {
            ScheduleError::Empty => Self::Knots { found: 0 },
            ScheduleError::NoSpacing => Self::KnotSpacing,
            ScheduleError::Knot { knot, error } => {
                Self::Knot { knot: u16::try_from(knot).unwrap_or(u16::MAX), fault: KnotFault::Gain(error) }
            }
        }
    }
}

/// A number of bytes as errors state it.
pub(super) fn count(bytes: usize) -> u32 {
    u32::try_from(bytes).unwrap_or(u32::MAX)
}
