//! Why a table is refused on a board, in; the sentence that says so, and how to get one that is flown, out.

use core::fmt;

use super::TableError;
use crate::gains::table::certificate::Vehicle;

/// Why a sound table is not flown on this board.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum AcceptError {
    /// Designed for another vehicle, or for other parameters of it.
    Vehicle {
        /// The one that the table is for.
        table: Vehicle,
    },
    /// Certified at another control rate.
    Rate {
        /// The table's, Hz.
        table_hz: u32,
        /// The loop's, Hz.
        loop_hz: u32,
    },
    /// Certified for shorter motor lags than this craft's.
    MotorLag {
        /// The longest that is certified, s.
        lag_max_s: f32,
        /// The craft's, s.
        motor_lag_s: f32,
    },
    /// It has more gains along its trajectory than there is room for.
    Knots {
        /// The table's.
        knots: u16,
        /// The room.
        room: u16,
    },
}

/// Why a blob does not become a table that is flown.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum LoadError {
    /// It is no table.
    Table(TableError),
    /// It is one, but not for this board.
    Accept(AcceptError),
}

impl fmt::Display for AcceptError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Vehicle { table } => {
                write!(f, "gain table: designed for {table}, which this board does not fly; design it for this one")
            }
            Self::Rate { table_hz, loop_hz } => write!(
                f,
                "gain table: certified at {table_hz} Hz, the loop runs at {loop_hz} Hz; certify it at the loop's rate"
            ),
            Self::MotorLag { lag_max_s, motor_lag_s } => write!(
                f,
                "gain table: certified up to a motor lag of {lag_max_s} s, the craft's is {motor_lag_s} s; design it for \
                 these motors"
            ),
            Self::Knots { knots, room } => {
                write!(f, "gain table: {knots} knots, there is room for {room}; change their spacing")
            }
        }
    }
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Table(error) => error.fmt(f),
            Self::Accept(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for AcceptError {}

impl core::error::Error for LoadError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Table(error) => Some(error),
            Self::Accept(error) => Some(error),
        }
    }
}

impl From<TableError> for LoadError {
    fn from(error: TableError) -> Self {
        Self::Table(error)
    }
}

impl From<AcceptError> for LoadError {
    fn from(error: AcceptError) -> Self {
        Self::Accept(error)
    }
}
