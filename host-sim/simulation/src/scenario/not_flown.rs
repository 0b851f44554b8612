//! Why a law does not fly a vehicle, before the law and the vehicle are named.

use super::told::ToldError;
use crate::crazyflie::StandardError;
use crate::flight::motor_laws::FlightError;

/// Why a law does not fly a vehicle.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NotFlown {
    /// There is no design, or the core refuses a figure.
    #[error(transparent)]
    Core(#[from] FlightError),
    /// There is no certified table for the vehicle.
    #[error(transparent)]
    Standard(#[from] StandardError),
    /// A figure that is told is not one that the law takes.
    #[error(transparent)]
    Told(#[from] ToldError),
    /// In the words of the Crazyflie's object.
    #[error("{0}")]
    Object(String),
}
