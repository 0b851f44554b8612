//! Where in a table a fault is: a figure of the cascade, with its name in words, or an entry of the gain at a knot.

use core::fmt;

use crate::gain::GainError;

/// The fields of a table of the cascade beside the head.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum CascadeFigure {
    /// A gain: its size must be within 1e-7 to 1e4, and its sign must close the loop.
    Gain {
        /// Its place among the 16, from 0.
        index: u8,
    },
    /// An end of the certified range of motor lags, s: the range holds the lag of the design and ends within the largest that the
    /// certificate states.
    MotorLag,
    /// Certified share of mass, 0 to 0.9.
    Mass,
    /// Certified share of inertia, 0 to 0.9.
    Inertia,
    /// An end of the certified range of force over command, which holds 1.
    ForceShare,
    /// Certified delay, s, 0 to the largest that the certificate states.
    Delay,
    /// Certified drag, 1/s, from 0.
    Drag,
    /// Certified moment of the air, N s, from 0.
    Moment,
    /// Drag that is told, 1/s, 0 to 1.
    ToldDrag,
    /// Told drag along the thrust over that across it, 0 to 2.
    ToldDragAlong,
    /// Moment that is told, N s, 0 to 2e-3.
    ToldMoment,
    /// Share of the wind's moment that is fed forward, 0 to 1.
    ToldGust,
    /// Whether the air is learned: 0 or 1.
    Learn,
}

/// A fault of a gain at a knot; rows and columns are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum KnotFault {
    /// An entry is not finite, or an error goes unused.
    Gain(GainError),
    /// An entry is out of proportion, as in [`super::TableError::Entry`].
    Entry {
        /// Row.
        row: u8,
        /// Column.
        column: u8,
        /// The value found.
        value: f32,
    },
}

impl fmt::Display for CascadeFigure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Gain { index } => return write!(f, "gain {index} of the cascade"),
            Self::MotorLag => "an end of the certified motor lags (s)",
            Self::Mass => "certified share of mass",
            Self::Inertia => "certified share of inertia",
            Self::ForceShare => "certified force over command",
            Self::Delay => "certified delay (s)",
            Self::Drag => "certified drag (1/s)",
            Self::Moment => "certified moment of the air (N s)",
            Self::ToldDrag => "told drag (1/s)",
            Self::ToldDragAlong => "told drag along the thrust",
            Self::ToldMoment => "told moment of the air (N s)",
            Self::ToldGust => "share of the wind fed forward",
            Self::Learn => "the mark of learned air",
        })
    }
}
