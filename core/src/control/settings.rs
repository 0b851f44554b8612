//! How a gain of any kind is flown: the board's settings beside the table.

use core::fmt;

use crate::actuation::Actuation;
#[cfg(feature = "cascade")]
use crate::cascade::Cascade;
use crate::clock::Rate;
use crate::command::Limits;
use crate::law::{ErrorForm, FeedForward};

/// A board's settings of a controller that it makes of a gain table.
#[derive(Clone, Copy, Debug)]
pub struct Settings<'a> {
    /// Limits of the craft; the table's own hold beside.
    pub limits: Limits,
    /// The actuation that carries commands to the motors, as [`crate::gains::table::AcceptedTable::actuation`] gives it.
    pub actuation: Option<&'a Actuation>,
    /// The law that was made of a table of the cascade, for that table.
    #[cfg(feature = "cascade")]
    pub cascade: Option<&'a Cascade>,
    /// Whether the reference's input is added.
    pub feed_forward: FeedForward,
    /// How the equilibrium law forms its error; the others have one form only.
    pub error_form: ErrorForm,
    /// Ticks a second of the player whose progress a table along a trajectory is given.
    pub player_rate: Rate,
}

impl Settings<'_> {
    /// Limits and the rate of the player alone: no motors, no feed-forward, errors in the heading frame.
    pub const fn new(limits: Limits, player_rate: Rate) -> Self {
        let (feed_forward, error_form) = (FeedForward::Without, ErrorForm::HeadingFrame);
        Self {
            limits,
            actuation: None,
            #[cfg(feature = "cascade")]
            cascade: None,
            feed_forward,
            error_form,
            player_rate,
        }
    }
}

/// Why a table becomes no controller.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ControllerError {
    /// It is a table of the cascade, and the law that was made of it is not given.
    NoCascade,
    /// The actuation reckons with another motor lag than the table.
    MotorLag {
        /// The table's, s.
        table_s: f32,
        /// The actuation's, s.
        actuation_s: f32,
    },
}

impl fmt::Display for ControllerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoCascade => {
                f.write_str("controller: the table is of the cascade; give the law that it makes of the craft")
            }
            Self::MotorLag { table_s, actuation_s } => write!(
                f,
                "controller: the table reckons with a motor lag of {table_s} s, the actuation with {actuation_s} s; take \
                 the table's"
            ),
        }
    }
}

impl core::error::Error for ControllerError {}
