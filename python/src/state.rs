//! The state of one craft or of many.

use nalgebra::UnitQuaternion;
use pyo3::prelude::*;
use quatrack::nalgebra::Vector3;
use quatrack_simulation::control_law::Estimate;
use quatrack_simulation::plant::RigidState;

use crate::arrays::{Quantity, Together};
use crate::error::refused_of;
use crate::pickle::{Reduced, by_constructor};

/// State of a craft and readings of its inertial sensors; of N crafts with a leading axis N.
///
/// World frame z up; body x forwards, y left, z up; quaternion scalar first, body to world, either sign. A quantity given as one
/// row serves all crafts.
///
/// position: (3,) or (N, 3), m
/// attitude: (4,) or (N, 4), w x y z; level with heading 0 where left out
/// velocity: (3,) or (N, 3), world frame, m/s; at rest where left out
/// body_rates: (3,) or (N, 3), gyroscope, rad/s; laws of motor forces take it
/// specific_force: (3,) or (N, 3), accelerometer, body frame, m/s^2, +9.81 along z at hover; the cascade learns the air from it
#[pyclass(frozen, module = "quatrack")]
#[derive(Clone)]
pub(crate) struct State {
    pub(crate) crafts: Option<usize>,
    pub(crate) position: Quantity<3>,
    pub(crate) attitude: Quantity<4>,
    pub(crate) velocity: Quantity<3>,
    pub(crate) body_rates: Option<Quantity<3>>,
    pub(crate) specific_force: Option<Quantity<3>>,
}

/// As the core takes it.
pub(crate) fn single<const W: usize>(row: [f64; W]) -> [f32; W] {
    row.map(|value| value as f32)
}

impl State {
    /// One craft's, as the core takes it.
    #[inline]
    pub(crate) fn core(&self, craft: usize) -> quatrack::State {
        let [w, x, y, z] = single(self.attitude.row(craft));
        quatrack::State {
            position_m: Vector3::from(single(self.position.row(craft))),
            attitude: quatrack::Quaternion::new(w, x, y, z),
            velocity_m_s: Vector3::from(single(self.velocity.row(craft))),
        }
    }

    /// The number of rows.
    pub(crate) fn len(&self) -> usize {
        self.crafts.unwrap_or(1)
    }

    /// Of one craft.
    pub(crate) fn of_one(position: [f64; 3], attitude: [f64; 4], velocity: [f64; 3]) -> Self {
        Self {
            crafts: None,
            position: Quantity::of(position),
            attitude: Quantity::of(attitude),
            velocity: Quantity::of(velocity),
            body_rates: None,
            specific_force: None,
        }
    }

    /// Of states of the simulation.
    pub(crate) fn of_rigid<'a>(crafts: Option<usize>, states: impl Iterator<Item = &'a RigidState> + Clone) -> Self {
        let each = |of: fn(&RigidState) -> [f64; 3]| Quantity::of_rows(crafts, states.clone().map(of));
        Self {
            crafts,
            position: each(|state| state.position_m.into()),
            attitude: Quantity::of_rows(crafts, states.clone().map(|state| wxyz(&state.attitude))),
            velocity: each(|state| state.velocity_m_s.into()),
            body_rates: Some(each(|state| state.body_rates_rad_s.into())),
            specific_force: None,
        }
    }

    /// Of the estimates that laws were told.
    pub(crate) fn of_estimates<'a>(
        crafts: Option<usize>,
        estimates: impl Iterator<Item = &'a Estimate> + Clone,
    ) -> Self {
        let each = |of: fn(&Estimate) -> [f64; 3]| Quantity::of_rows(crafts, estimates.clone().map(of));
        Self {
            crafts,
            position: each(|estimate| estimate.position_m.into()),
            attitude: Quantity::of_rows(crafts, estimates.clone().map(|estimate| wxyz(&estimate.attitude))),
            velocity: each(|estimate| estimate.velocity_m_s.into()),
            body_rates: Some(each(|estimate| estimate.body_rates_rad_s.into())),
            specific_force: Some(each(|estimate| estimate.specific_force_m_s2.into())),
        }
    }
}

/// Scalar first.
fn wxyz(attitude: &UnitQuaternion<f64>) -> [f64; 4] {
    let q = attitude.quaternion();
    [q.w, q.i, q.j, q.k]
}

#[pymethods]
impl State {
    #[new]
    #[pyo3(signature = (position, attitude=None, velocity=None, body_rates=None, specific_force=None))]
    fn new(
        position: &Bound<'_, PyAny>,
        attitude: Option<&Bound<'_, PyAny>>,
        velocity: Option<&Bound<'_, PyAny>>,
        body_rates: Option<&Bound<'_, PyAny>>,
        specific_force: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let position = Quantity::<3>::read("position", position)?;
        let attitude = Quantity::<4>::read_or_none("attitude", attitude)?.unwrap_or(Quantity::of([1.0, 0.0, 0.0, 0.0]));
        let velocity = Quantity::<3>::read_or_none("velocity", velocity)?.unwrap_or(Quantity::of([0.0; 3]));
        let body_rates = Quantity::<3>::read_or_none("body_rates", body_rates)?;
        let specific_force = Quantity::<3>::read_or_none("specific_force", specific_force)?;
        let mut together = Together::default();
        together.note("position", Some(&position))?;
        together.note("attitude", Some(&attitude))?;
        together.note("velocity", Some(&velocity))?;
        together.note("body_rates", body_rates.as_ref())?;
        together.note("specific_force", specific_force.as_ref())?;
        Ok(Self { crafts: together.crafts(), position, attitude, velocity, body_rates, specific_force })
    }

    /// The same with quaternions of norm 1, after the core has looked at every number.
    fn validated(&self) -> PyResult<Self> {
        for craft in 0..self.len() {
            let of = self.crafts.map(|_| craft);
            self.core(craft).validated().map_err(|error| refused_of(of, error))?;
        }
        let normalised = |q: [f64; 4]| {
            let norm = q.iter().map(|part| part * part).sum::<f64>().sqrt();
            q.map(|part| part / norm)
        };
        let attitude = Quantity::of_rows(self.attitude.crafts, self.attitude.rows().map(normalised));
        Ok(Self { attitude, ..self.clone() })
    }

    /// How long the leading axis is; None for one craft.
    #[getter]
    fn crafts(&self) -> Option<usize> {
        self.crafts
    }

    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.position.array(py, self.crafts)
    }

    #[getter]
    fn attitude<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.attitude.array(py, self.crafts)
    }

    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.velocity.array(py, self.crafts)
    }

    #[getter]
    fn body_rates<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.body_rates.as_ref().map(|rows| rows.array(py, self.crafts)).transpose()
    }

    #[getter]
    fn specific_force<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.specific_force.as_ref().map(|rows| rows.array(py, self.crafts)).transpose()
    }

    /// For pickle and copy: the quantities as they are.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let optional = |rows: &Option<Quantity<3>>| rows.as_ref().map(|rows| rows.held(py)).transpose();
        let (position, attitude, velocity) =
            (self.position.held(py)?, self.attitude.held(py)?, self.velocity.held(py)?);
        let (body_rates, specific_force) = (optional(&self.body_rates)?, optional(&self.specific_force)?);
        by_constructor::<Self>(py, (position, attitude, velocity, body_rates, specific_force))
    }

    fn __repr__(&self) -> String {
        match self.crafts {
            None => format!("State(position={:?}, velocity={:?})", self.position.row(0), self.velocity.row(0)),
            Some(crafts) => format!("State of {crafts} crafts"),
        }
    }
}
