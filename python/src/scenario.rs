//! Scenarios, as a path, the keys of a file, or made before.

use std::io::Error;
use std::path::{Path, PathBuf};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyType;
use quatrack_plan::bounded;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use quatrack_simulation::scenario::file::ScenarioFile;
use quatrack_simulation::scenario::{Scenario as SimScenario, ScenarioError};
use quatrack_simulation::vehicles;

use crate::arrays::Quantity;
use crate::error::refused;
use crate::long_call::long_call;
use crate::pickle::{Reduced, by_restoring};
use crate::reference::Reference;
use crate::trajectory;
use crate::values::{self, Source};
use crate::vehicle::Vehicle;

/// A craft, its air, its deviations, a course and a law.
///
/// scenario: path of a scenario file, or its keys as a dictionary
///
/// Pickled and copied it has its vehicle with it; a course that is a file stays a path.
#[pyclass(frozen, module = "quatrack")]
#[derive(Clone)]
pub(crate) struct Scenario {
    scenario: SimScenario,
    written: Written,
}

/// A scenario as it was written, of which it can be made again.
#[derive(Clone)]
struct Written {
    text: String,
    /// The name that messages give it.
    origin: String,
    /// Where relative paths in it begin.
    folder: PathBuf,
}

impl Written {
    fn read(value: &Bound<'_, PyAny>) -> PyResult<Self> {
        match Source::read("scenario", value)? {
            Source::Path(path) => {
                let unreadable =
                    |error: Error| ScenarioError::Unreadable { path: path.clone(), reason: error.to_string() };
                let text = bounded::read_to_string(&path).map_err(unreadable).map_err(refused)?;
                let folder = path.parent().unwrap_or(Path::new("")).to_owned();
                Ok(Self { text, origin: path.display().to_string(), folder })
            }
            Source::Text(text) => Ok(Self { text, origin: "scenario".to_owned(), folder: PathBuf::new() }),
        }
    }

    fn scenario(&self) -> PyResult<SimScenario> {
        let file = ScenarioFile::parse(&self.text, &self.origin).map_err(refused)?;
        SimScenario::checked(&file, &self.origin, &self.folder).map_err(refused)
    }
}

/// A scenario as an argument.
pub(crate) fn argument(value: &Bound<'_, PyAny>) -> PyResult<SimScenario> {
    match value.cast::<Scenario>() {
        Ok(scenario) => Ok(scenario.get().scenario.clone()),
        Err(_) => Written::read(value)?.scenario(),
    }
}

/// The course that a scenario names, where it has to be had first.
pub(crate) fn trajectory(py: Python<'_>, scenario: &SimScenario) -> PyResult<Option<PiecewisePolynomial>> {
    let Some(name) = scenario.course.trajectory().map(str::to_owned) else { return Ok(None) };
    long_call(py, move |_| trajectory::by_name(&name))?.map(Some).map_err(refused)
}

/// The course of a scenario over time, from the hover before it.
#[pyclass(frozen, module = "quatrack")]
pub(crate) struct Course {
    scenario: SimScenario,
    trajectory: Option<PiecewisePolynomial>,
}

#[pymethods]
impl Course {
    /// The reference at a time or at many, s since the start of the flight. Finite: an eight goes on after the end of its measurement.
    fn at(&self, time: &Bound<'_, PyAny>) -> PyResult<Reference> {
        let times = Quantity::read_times(time)?;
        if let Some([t_s]) = times.rows().find(|[t_s]| t_s.is_infinite()) {
            return Err(PyValueError::new_err(format!("time: {t_s}; must be finite, s")));
        }
        let flown = self.scenario.flown(self.trajectory.clone());
        let points: Vec<_> = times.rows().map(|[t_s]| flown.course.at(t_s)).collect();
        Ok(Reference::of_points(times.crafts, &points))
    }

    /// Its end, s.
    #[getter]
    fn duration(&self) -> f64 {
        self.scenario.flown(self.trajectory.clone()).course.duration_s()
    }

    /// From when on it is measured, s.
    #[getter]
    fn measured_from(&self) -> f64 {
        self.scenario.flown(self.trajectory.clone()).measured_from_s
    }
}

#[pymethods]
impl Scenario {
    #[new]
    fn new(scenario: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(scenario) = scenario.cast::<Self>() {
            return Ok(scenario.get().clone());
        }
        let written = Written::read(scenario)?;
        Ok(Self { scenario: written.scenario()?, written })
    }

    /// The course, with the time that is measured; a trajectory that it names is planned or read first.
    fn course(&self, py: Python<'_>) -> PyResult<Course> {
        Ok(Course { scenario: self.scenario.clone(), trajectory: trajectory(py, &self.scenario)? })
    }

    /// The vehicle that the craft differs from.
    #[getter]
    fn vehicle(&self) -> Vehicle {
        Vehicle(self.scenario.vehicle.clone())
    }

    /// Name of its law.
    #[getter]
    fn law(&self) -> &'static str {
        self.scenario.law.name()
    }

    /// Seed of noise and gusts.
    #[getter]
    fn seed(&self) -> u64 {
        self.scenario.seed
    }

    /// The same with noise and gusts from another seed.
    fn with_seed(&self, seed: &Bound<'_, PyAny>) -> PyResult<Self> {
        let scenario = SimScenario { seed: values::seed(seed)?, ..self.scenario.clone() };
        Ok(Self { scenario, written: self.written.clone() })
    }

    /// True mass, kg.
    #[getter]
    fn true_mass_kg(&self) -> f64 {
        self.scenario.truth.mass_kg
    }

    /// The mass that a law is told, kg.
    #[getter]
    fn told_mass_kg(&self) -> f64 {
        self.scenario.told.mass_kg
    }

    /// For pickle and copy: the text, the vehicle and the seed. A course that is a file stays a path.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let Written { text, origin, folder } = &self.written;
        let vehicle = vehicles::to_toml(&self.scenario.vehicle).map_err(refused)?;
        by_restoring::<Self>(py, (text, origin, folder, vehicle, self.scenario.seed))
    }

    /// From what `__reduce__` returns.
    #[classmethod]
    fn _restored(
        _cls: &Bound<'_, PyType>,
        text: String,
        origin: String,
        folder: PathBuf,
        vehicle: &str,
        seed: u64,
    ) -> PyResult<Self> {
        let vehicle = vehicles::from_toml(vehicle).map_err(refused)?;
        let file = ScenarioFile::parse(&text, &origin).map_err(refused)?;
        let scenario = SimScenario::on(vehicle, &file, &origin, &folder).map_err(refused)?;
        Ok(Self { scenario: SimScenario { seed, ..scenario }, written: Written { text, origin, folder } })
    }

    fn __str__(&self) -> String {
        self.scenario.to_string()
    }

    fn __repr__(&self) -> String {
        format!("Scenario({})", self.scenario)
    }
}
