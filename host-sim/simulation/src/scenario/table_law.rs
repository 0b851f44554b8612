//! A table of gains as the law of a scenario: the table, the vehicle and the told figures in; the law, or the reason why the table
//! is not for them, out.

use quatrack::gains::table::{AcceptError, CascadeRange, GainTable, TableKind};
use quatrack_design::vehicle::Vehicle;

use super::cascade_law::CascadeLaw;
use super::told::{ToldError, ToldFigures};
use crate::control_law::ControlLaw;
use crate::flight::motor_laws::FlightError;
use crate::flight::motor_loop::RATE;
use crate::vehicles;

/// Why a table does not fly a scenario.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TableLawError {
    /// It is of another law.
    #[error("its kind is {kind}; a scenario takes a table of the cascade, or a law by its name")]
    Kind {
        /// The table's.
        kind: TableKind,
    },
    /// It is for another vehicle.
    #[error("made for {made_for}, not for the scenario's {vehicle}")]
    Vehicle {
        /// The table's.
        made_for: String,
        /// The scenario's.
        vehicle: String,
    },
    /// It is for another rate, or not certified.
    #[error("{}", match .0 {
        AcceptError::Rate { table_hz, loop_hz } => format!("certified at {table_hz} Hz; a scenario is flown at {loop_hz}"),
        other => other.to_string(),
    })]
    NotAccepted(AcceptError),
    /// It is not certified for a figure that is told.
    #[error(transparent)]
    Told(#[from] ToldError),
    /// The core refuses a figure of the vehicle.
    #[error(transparent)]
    Core(#[from] FlightError),
}

/// The law of a table at a hover, on the vehicle that the table was made for.
///
/// The table's lag and, where none is told, its air are flown; a lag and a mass that are told have to be certified.
///
/// # Errors
/// [`TableLawError`].
pub fn start_table(
    vehicle: &Vehicle,
    told: &ToldFigures,
    table: &GainTable<'_>,
) -> Result<Box<dyn ControlLaw>, TableLawError> {
    let (kind, made_for) = (table.kind(), table.head().vehicle);
    if kind != TableKind::Cascade {
        return Err(TableLawError::Kind { kind });
    }
    if vehicles::id(vehicle) != made_for.id {
        let vehicle = vehicle.name().to_owned();
        return Err(TableLawError::Vehicle { made_for: made_for.to_string(), vehicle });
    }
    let accepted = table.accept_for(&made_for, RATE).map_err(TableLawError::NotAccepted)?;
    let cascade = accepted.cascade().ok_or(TableLawError::Kind { kind })?;
    let certified: &CascadeRange = &cascade.certified;
    told.certified_by(certified, vehicle)?;
    Ok(Box::new(CascadeLaw::of_table(vehicle, told, cascade)?))
}
