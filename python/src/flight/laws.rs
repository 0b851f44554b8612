//! The law that flies, as somebody gives it, and a scenario in; the flight, or the fault of the law, out.

use std::str::FromStr;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyString;
use quatrack::gains::table::GainTable as CoreTable;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use quatrack_simulation::control_law::ControlLaw;
use quatrack_simulation::scenario::{Law, Recording, Scenario, start_table};

use super::Flight;
use crate::crazyflie;
use crate::error::refused;
use crate::gains::GainTable;
use crate::long_call::{Cancelled, long_call};
use crate::own_law::{Interruptible, OwnLaw};

/// The law that flies.
pub(super) enum Flies {
    Named(Law),
    Table { bytes: Vec<u8>, name: String },
    Own(OwnLaw, String),
}

impl Flies {
    pub(super) fn argument(value: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(name) = value.cast::<PyString>() {
            return Law::from_str(name.to_str()?).map(Self::Named).map_err(refused);
        }
        if let Ok(table) = value.cast::<GainTable>() {
            let name = table.get().core()?.head().name.as_str().to_owned();
            return Ok(Self::Table { bytes: table.get().bytes.clone(), name });
        }
        // A name of one's own beside the law.
        if let Ok((name, law)) = value.extract::<(String, Bound<'_, PyAny>)>() {
            return match Self::argument(&law)? {
                Self::Own(own, _) => Ok(Self::Own(own, name)),
                _ => Err(PyTypeError::new_err(format!("law {name}: only a callable can be renamed"))),
            };
        }
        if !value.is_callable() {
            let kind = value.get_type().name()?;
            return Err(PyTypeError::new_err(format!("law: {kind}; give a name, a GainTable or a callable")));
        }
        let name = match value.getattr_opt("__name__")? {
            Some(name) => name.extract()?,
            None => value.get_type().name()?.extract()?,
        };
        Ok(Self::Own(OwnLaw::new(value)?, name))
    }

    pub(super) fn name(&self) -> &str {
        match self {
            Self::Named(law) => law.name(),
            Self::Table { name, .. } | Self::Own(_, name) => name,
        }
    }
}

/// Flies a law that is ours, until it is cancelled.
fn record(
    scenario: &Scenario,
    law: &mut dyn ControlLaw,
    course: Option<PiecewisePolynomial>,
    cancelled: &Cancelled,
) -> Result<Recording, String> {
    let flown = scenario.flown(course);
    scenario.record(&mut Interruptible { law, cancelled }, &flown).map_err(|error| error.to_string())
}

/// Flies a table of the cascade on the vehicle that it was made for.
fn record_table(
    scenario: &Scenario,
    bytes: &[u8],
    course: Option<PiecewisePolynomial>,
    cancelled: &Cancelled,
) -> Result<Recording, String> {
    let table = CoreTable::from_bytes(bytes).map_err(|error| error.to_string())?;
    let started = start_table(&scenario.vehicle, &scenario.told, &table);
    let mut law = started.map_err(|error| format!("{}: {error}", table.head().name))?;
    record(scenario, law.as_mut(), course, cancelled)
}

pub(super) fn flown(
    py: Python<'_>,
    scenario: &Scenario,
    flies: Flies,
    course: Option<PiecewisePolynomial>,
) -> PyResult<Flight> {
    let name = flies.name().to_owned();
    let recording = match flies {
        Flies::Named(law) => {
            if law == Law::Crazyflie {
                crazyflie::end_the_one_before();
            }
            let scenario = scenario.clone();
            long_call(py, move |cancelled| {
                let mut law = law.start(&scenario.vehicle, &scenario.told).map_err(|error| error.to_string())?;
                record(&scenario, law.as_mut(), course, cancelled)
            })?
        }
        Flies::Table { bytes, .. } => {
            let scenario = scenario.clone();
            long_call(py, move |cancelled| record_table(&scenario, &bytes, course, cancelled))?
        }
        Flies::Own(mut own, _) => {
            let recorded = py.detach(|| {
                let flown = scenario.flown(course);
                scenario.record(&mut own, &flown).map_err(|error| error.to_string())
            });
            if let Some(raised) = own.raised {
                return Err(raised);
            }
            recorded
        }
    };
    let full_n = scenario.vehicle.motors().thrust_max_n;
    Ok(Flight { law: name, recording: recording.map_err(refused)?, full_n })
}
