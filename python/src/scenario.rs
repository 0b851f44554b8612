//! Scenarios, as a path, the keys of a file, or made before.

use std::path::Path;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use quatrack_simulation::scenario::Scenario as SimScenario;
use quatrack_simulation::scenario::file::ScenarioFile;

use crate::arrays::Quantity;
use crate::error::refused;
use crate::long_call::long_call;
use crate::reference::Reference;
use crate::trajectory;
use crate::values::{self, Source};
use crate::vehicle::Vehicle;

/// A craft, its air, its deviations, a course and a law.
///
/// scenario: path of a scenario file, or its keys as a dictionary
#[pyclass(frozen, module = "quatrack")]
#[derive(Clone)]
pub(crate) struct Scenario(pub(crate) SimScenario);

/// A scenario as an argument.
pub(crate) fn argument(value: &Bound<'_, PyAny>) -> PyResult<SimScenario> {
    if let Ok(scenario) = value.cast::<Scenario>() {
        return Ok(scenario.get().0.clone());
    }
    match Source::read("scenario", value)? {
        Source::Path(path) => SimScenario::from_file(&path),
        Source::Text(text) => ScenarioFile::parse(&text, "scenario")
            .and_then(|file| SimScenario::checked(&file, "scenario", Path::new(""))),
    }
    .map_err(refused)
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
        argument(scenario).map(Self)
    }

    /// The course, with the time that is measured; a trajectory that it names is planned or read first.
    fn course(&self, py: Python<'_>) -> PyResult<Course> {
        Ok(Course { scenario: self.0.clone(), trajectory: trajectory(py, &self.0)? })
    }

    /// The vehicle that the craft differs from.
    #[getter]
    fn vehicle(&self) -> Vehicle {
        Vehicle(self.0.vehicle.clone())
    }

    /// Name of its law.
    #[getter]
    fn law(&self) -> &'static str {
        self.0.law.name()
    }

    /// Seed of noise and gusts.
    #[getter]
    fn seed(&self) -> u64 {
        self.0.seed
    }

    /// The same with noise and gusts from another seed.
    fn with_seed(&self, seed: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(SimScenario { seed: values::seed(seed)?, ..self.0.clone() }))
    }

    /// True mass, kg.
    #[getter]
    fn true_mass_kg(&self) -> f64 {
        self.0.truth.mass_kg
    }

    /// The mass that a law is told, kg.
    #[getter]
    fn told_mass_kg(&self) -> f64 {
        self.0.told.mass_kg
    }

    fn __str__(&self) -> String {
        self.0.to_string()
    }

    fn __repr__(&self) -> String {
        format!("Scenario({})", self.0)
    }
}
