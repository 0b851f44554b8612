//! Laws on one scenario in; their flights beside each other, and the command's table of them, out.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use quatrack_simulation::scenario::Law;
use quatrack_simulation::scenario::compare::Table;

use super::Flight;
use super::laws::{Flies, flown};
use crate::error::refused;
use crate::scenario;

/// Flies laws on one scenario, each from the same start with the same noise and gusts.
///
/// scenario: as for fly
/// laws: names, GainTables, callables, or pairs of a name and a callable; all built-in ones where left out. Each has a name of its
///     own, by which its flight is found
///
/// Returns a Comparison, whose text is the command's table.
#[pyfunction]
#[pyo3(signature = (scenario, laws=None))]
pub(crate) fn compare<'py>(
    py: Python<'py>,
    scenario: &Bound<'py, PyAny>,
    laws: Option<&Bound<'py, PyAny>>,
) -> PyResult<Comparison> {
    let scenario = scenario::argument(scenario)?;
    let course = scenario::trajectory(py, &scenario)?;
    let asked = laws.filter(|laws| !laws.is_none());
    let flies: Vec<Flies> = match asked {
        Some(laws) => laws.try_iter()?.map(|law| Flies::argument(&law?)).collect::<PyResult<_>>()?,
        None => Law::ALL.map(Flies::Named).into(),
    };
    let names: Vec<&str> = flies.iter().map(Flies::name).collect();
    if let Some((_, twice)) = names.iter().enumerate().find(|(place, name)| names[..*place].contains(name)) {
        return Err(refused(format!(
            "laws: {twice} is there twice; give each law once, and a callable a name of its own as (name, law)"
        )));
    }
    let (mut flights, mut grounded) = (Vec::new(), Vec::new());
    for law in flies {
        let of = law.name().to_owned();
        match flown(py, &scenario, law, course.clone()) {
            Ok(flight) => flights.push(flight),
            // Nobody has asked for this one.
            Err(error) if asked.is_none() && error.is_instance_of::<crate::error::QuatrackError>(py) => {
                grounded.push((of, error.value(py).to_string()));
            }
            Err(error) => return Err(error),
        }
    }
    Ok(Comparison { title: scenario.to_string(), flights, grounded })
}

/// Laws beside each other.
#[pyclass(frozen, module = "quatrack")]
pub(crate) struct Comparison {
    title: String,
    flights: Vec<Flight>,
    grounded: Vec<(String, String)>,
}

#[pymethods]
impl Comparison {
    /// The flights, by their law's name, in the order in which they flew.
    #[getter]
    fn flights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let flights = PyDict::new(py);
        for flight in &self.flights {
            flights.set_item(&flight.law, flight.clone())?;
        }
        Ok(flights)
    }

    /// Laws that were not flown, and why.
    #[getter]
    fn grounded<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let grounded = PyDict::new(py);
        for (law, reason) in &self.grounded {
            grounded.set_item(law, reason)?;
        }
        Ok(grounded)
    }

    /// Rows of (law, IAE in m s or None, largest error in m).
    #[getter]
    fn rows<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyTuple>>> {
        let row = |flight: &Flight| (flight.law.clone(), flight.iae(), flight.max_error()).into_pyobject(py);
        self.flights.iter().map(row).collect()
    }

    /// The table that `quatrack compare` prints.
    fn __str__(&self) -> String {
        let flights: Vec<_> =
            self.flights.iter().map(|flight| (flight.law.clone(), flight.recording.flight.clone())).collect();
        let mut text = format!("{}\n\n{}", self.title, Table::of(&flights));
        for (_, reason) in &self.grounded {
            text.push_str(&format!("\nnot flown: {reason}"));
        }
        text
    }
}
