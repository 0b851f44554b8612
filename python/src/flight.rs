//! Flights of scenarios: with a law by name, with a table, or with one's own.

use std::str::FromStr;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyTuple};
use quatrack::gains::table::GainTable as CoreTable;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use quatrack_simulation::control_law::ControlLaw;
use quatrack_simulation::flight::rigid_loop::RigidSample;
use quatrack_simulation::scenario::compare::Table;
use quatrack_simulation::scenario::{Law, Recording, Scenario, start_table};

use crate::arrays::array;
use crate::crazyflie;
use crate::error::refused;
use crate::gains::GainTable;
use crate::long_call::{Cancelled, long_call};
use crate::own_law::{Interruptible, OwnLaw};
use crate::scenario;
use crate::state::State;

/// The law that flies.
enum Flies {
    Named(Law),
    Table { bytes: Vec<u8>, name: String },
    Own(OwnLaw, String),
}

impl Flies {
    fn argument(value: &Bound<'_, PyAny>) -> PyResult<Self> {
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

    fn name(&self) -> &str {
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

fn flown(py: Python<'_>, scenario: &Scenario, flies: Flies, course: Option<PiecewisePolynomial>) -> PyResult<Flight> {
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

/// Flies laws on one scenario, each from the same start with the same noise and gusts.
///
/// scenario: as for fly
/// laws: names, GainTables, callables, or pairs of a name and a callable; all built-in ones where left out
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
