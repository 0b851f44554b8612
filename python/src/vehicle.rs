//! Vehicles by name or from their files.

use nalgebra::DMatrix;
use pyo3::prelude::*;
use pyo3::types::{PyString, PyType};
use quatrack_design::vehicle::Vehicle as DesignVehicle;
use quatrack_simulation::scenario::{ToldError, ToldFigures};
use quatrack_simulation::vehicles;

use crate::arrays::{array, from_matrix};
use crate::error::refused;
use crate::pickle::{Reduced, by_restoring};
use crate::values::Source;

/// Mass, inertia, motors and limits of a craft.
///
/// vehicle: a built-in name (Vehicle.names()), the path of a vehicle file, or its keys as a dictionary
#[pyclass(frozen, module = "quatrack")]
#[derive(Clone)]
pub(crate) struct Vehicle(pub(crate) DesignVehicle);

/// A vehicle as an argument: one that is made, a built-in name, a path, or the keys of a file.
pub(crate) fn argument(value: &Bound<'_, PyAny>) -> PyResult<DesignVehicle> {
    if let Ok(vehicle) = value.cast::<Vehicle>() {
        return Ok(vehicle.get().0.clone());
    }
    if let Ok(name) = value.cast::<PyString>() {
        let name = name.to_str()?;
        if !name.ends_with(".toml") {
            return vehicles::by_name(name).map_err(refused);
        }
    }
    match Source::read("vehicle", value)? {
        Source::Path(path) => vehicles::from_file(&path),
        Source::Text(text) => vehicles::from_toml(&text),
    }
    .map_err(refused)
}

/// The figures of a craft that a law is told, within the ranges of a scenario's `[told]`.
pub(crate) fn told(
    vehicle: &DesignVehicle,
    mass_kg: Option<f64>,
    lag_s: Option<f64>,
    drag_per_s: Option<f64>,
    moment_n_m_per_m_s: Option<[f64; 2]>,
) -> PyResult<ToldFigures> {
    let told = ToldFigures { mass_kg: mass_kg.unwrap_or(vehicle.mass_kg()), lag_s, drag_per_s, moment_n_m_per_m_s };
    let refused_of = |ToldError { key, value, must }| {
        refused(format!("{key}: {value}; must be {must}; leave it out for the vehicle's own"))
    };
    told.taken_of(vehicle).map(|()| told).map_err(refused_of)
}

#[pymethods]
impl Vehicle {
    #[new]
    fn new(vehicle: &Bound<'_, PyAny>) -> PyResult<Self> {
        argument(vehicle).map(Self)
    }

    /// Names of the built-in vehicles.
    #[classmethod]
    fn names(_cls: &Bound<'_, PyType>) -> Vec<&'static str> {
        vehicles::names().to_vec()
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        self.0.name()
    }

    /// Mass, kg.
    #[getter]
    fn mass_kg(&self) -> f64 {
        self.0.mass_kg()
    }

    /// Inertia about the centre of mass in the body frame, kg m^2; shape (3, 3).
    #[getter]
    fn inertia_kg_m2<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let inertia = self.0.inertia_kg_m2();
        from_matrix(py, &DMatrix::from_fn(3, 3, |i, j| inertia[(i, j)]))
    }

    /// Thrust and torques `[F, tx, ty, tz]` (N, N m) from the forces of M1 to M4 (N); shape (4, 4).
    #[getter]
    fn mixing<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mixing = self.0.motors().mixing();
        from_matrix(py, &DMatrix::from_fn(4, 4, |i, j| mixing[(i, j)]))
    }

    /// Least and most force of a motor, N; shape (2,).
    #[getter]
    fn motor_force_n<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array(py, None, vec![[self.0.motors().thrust_min_n, self.0.motors().thrust_max_n]])
    }

    /// Time constant from command to thrust that tables are designed for, s.
    #[getter]
    fn motor_lag_s(&self) -> f64 {
        self.0.motors().lag_s
    }

    /// Distance from the centre to a rotor's axis, m.
    #[getter]
    fn arm_m(&self) -> f64 {
        self.0.motors().arm_m
    }

    /// Force of each motor at hover, N.
    #[getter]
    fn hover_force_n(&self) -> f64 {
        self.0.hover_thrust_n()
    }

    /// For pickle and copy: the text of a vehicle file.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        by_restoring::<Self>(py, (vehicles::to_toml(&self.0).map_err(refused)?,))
    }

    /// From what `__reduce__` returns.
    #[classmethod]
    fn _restored(_cls: &Bound<'_, PyType>, text: &str) -> PyResult<Self> {
        vehicles::from_toml(text).map(Self).map_err(refused)
    }

    fn __repr__(&self) -> String {
        format!("Vehicle({:?}, {} kg)", self.0.name(), self.0.mass_kg())
    }
}
