//! Flights of scenarios: with a law by name, with a table, or with one's own.

mod comparison;
mod laws;

use pyo3::prelude::*;
use quatrack_simulation::flight::rigid_loop::RigidSample;
use quatrack_simulation::scenario::Recording;

use crate::arrays::array;
use crate::scenario;
use crate::state::State;
pub(crate) use comparison::{Comparison, compare};
use laws::{Flies, flown};

/// Flies a scenario.
///
/// scenario: a Scenario, a path, or the keys of a file as a dictionary
/// law: the scenario's own where left out; a name, a GainTable for motor forces, or a callable that takes a LawInput and returns
///     the forces of M1 to M4 (4,), N. Its attribute rate_hz says how often it is called (500), its method reset is called before the
///     flight. An exception in it ends the flight and is raised here
///
/// Returns a Flight. A craft that is lost is no exception: Flight.lost says when and why.
#[pyfunction]
#[pyo3(signature = (scenario, law=None))]
pub(crate) fn fly(py: Python<'_>, scenario: &Bound<'_, PyAny>, law: Option<&Bound<'_, PyAny>>) -> PyResult<Flight> {
    let scenario = scenario::argument(scenario)?;
    let flies = match law.filter(|law| !law.is_none()) {
        Some(law) => Flies::argument(law)?,
        None => Flies::Named(scenario.law),
    };
    let course = scenario::trajectory(py, &scenario)?;
    flown(py, &scenario, flies, course)
}

/// A flight, whole or up to where it was lost; rows every 10 ms while it is measured.
#[pyclass(frozen, module = "quatrack")]
#[derive(Clone)]
pub(crate) struct Flight {
    law: String,
    recording: Recording,
    /// The most that is asked of a motor, N.
    full_n: f64,
}

impl Flight {
    fn rows<const W: usize>(&self, of: impl Fn(&RigidSample) -> [f64; W]) -> Vec<[f64; W]> {
        self.recording.flight.samples.iter().map(of).collect()
    }

    fn column<'py, const W: usize>(
        &self,
        py: Python<'py>,
        of: impl Fn(&RigidSample) -> [f64; W],
    ) -> PyResult<Bound<'py, PyAny>> {
        let rows = self.rows(of);
        array(py, Some(rows.len()), rows)
    }
}

#[pymethods]
impl Flight {
    /// The law that flew.
    #[getter]
    fn law(&self) -> &str {
        &self.law
    }

    /// Sum of the position error's norm over the rows, times 10 ms, m s; None for a lost flight.
    #[getter]
    fn iae(&self) -> Option<f64> {
        self.recording.flight.iae_m_s()
    }

    /// Largest position error, m.
    #[getter]
    fn max_error(&self) -> f64 {
        self.recording.flight.max_error_m()
    }

    /// When and why it was lost; None for a whole flight.
    #[getter]
    fn lost(&self) -> Option<(f64, String)> {
        self.recording.flight.lost.as_ref().map(|lost| (lost.time_s, lost.reason.clone()))
    }

    /// Control steps at which a motor was commanded to a limit.
    #[getter]
    fn saturated_steps(&self) -> u64 {
        self.recording.flight.saturated_steps
    }

    /// Time of each row, s; shape (rows,).
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, |sample| [sample.time_s])
    }

    /// Where the craft was to be, m; shape (rows, 3).
    #[getter]
    fn target<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, |sample| sample.target_m.into())
    }

    /// Commanded motor forces, N; shape (rows, 4).
    #[getter]
    fn commands<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, |sample| sample.commands_n.into())
    }

    /// Forces of the motors, N; shape (rows, 4).
    #[getter]
    fn motor_forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, |sample| sample.state.thrusts_n.into())
    }

    /// Where the craft was; arrays with a row each.
    #[getter]
    fn state(&self) -> State {
        let samples = &self.recording.flight.samples;
        State::of_rigid(Some(samples.len()), samples.iter().map(|sample| &sample.state))
    }

    /// Its law's estimate.
    #[getter]
    fn estimate(&self) -> State {
        let around = &self.recording.around;
        State::of_estimates(Some(around.len()), around.iter().map(|around| &around.estimate))
    }

    /// Velocity of the air, m/s; shape (rows, 3).
    #[getter]
    fn wind<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let rows: Vec<[f64; 3]> = self.recording.around.iter().map(|around| around.wind_m_s.into()).collect();
        array(py, Some(rows.len()), rows)
    }

    /// As the text of the CSV file that `quatrack fly --out` writes.
    fn to_csv(&self) -> String {
        self.recording.to_csv()
    }

    /// As the text of a log in cflib's columns, which identify reads: what the law knew, and its commands.
    fn to_log(&self) -> String {
        self.recording.to_log(self.full_n)
    }

    fn __len__(&self) -> usize {
        self.recording.flight.samples.len()
    }

    fn __repr__(&self) -> String {
        match (&self.recording.flight.lost, self.iae()) {
            (Some(lost), _) => format!("Flight({:?}, lost at {:.2} s: {})", self.law, lost.time_s, lost.reason),
            (None, iae) => format!("Flight({:?}, IAE {:.4} m s)", self.law, iae.unwrap_or(f64::NAN)),
        }
    }
}
