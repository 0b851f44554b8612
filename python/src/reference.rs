//! References, for one craft or for many.

mod rows;

use pyo3::prelude::*;
use pyo3::types::PyType;
use quatrack::Progress;

use crate::arrays::{Quantity, Together, array};
use crate::pickle::{Reduced, by_restoring};
use crate::state::State;

/// The flat output and its derivatives at one time; of N crafts with a leading axis N.
///
/// A quantity given as one row serves all crafts; one that is left out is 0. Where snap and crackle are both left out, the laws that
/// take them fit them to the jerks of the last steps.
///
/// position, velocity, acceleration, jerk, snap, crackle: (3,) or (N, 3), world frame, m, m/s, ... m/s^5; acceleration 0 at rest
/// heading, heading_rate, heading_acceleration, heading_jerk: () or (N,), rad, ... rad/s^3
#[pyclass(frozen, module = "quatrack")]
#[derive(Clone)]
pub(crate) struct Reference {
    pub(crate) crafts: Option<usize>,
    /// Position to jerk.
    pub(crate) position: [Quantity<3>; 4],
    /// Snap and crackle, where they are known.
    pub(crate) beyond: Option<[Quantity<3>; 2]>,
    /// To the third derivative.
    pub(crate) heading: [Quantity<1>; 4],
    /// Where on which trajectory that is; of a player, which is of one craft.
    pub(crate) progress: Option<Progress>,
}

#[pymethods]
impl Reference {
    #[new]
    #[pyo3(signature = (position, velocity=None, acceleration=None, jerk=None, snap=None, crackle=None, *, heading=None,
        heading_rate=None, heading_acceleration=None, heading_jerk=None))]
    #[expect(clippy::too_many_arguments, reason = "each is a keyword")]
    fn new(
        position: &Bound<'_, PyAny>,
        velocity: Option<&Bound<'_, PyAny>>,
        acceleration: Option<&Bound<'_, PyAny>>,
        jerk: Option<&Bound<'_, PyAny>>,
        snap: Option<&Bound<'_, PyAny>>,
        crackle: Option<&Bound<'_, PyAny>>,
        heading: Option<&Bound<'_, PyAny>>,
        heading_rate: Option<&Bound<'_, PyAny>>,
        heading_acceleration: Option<&Bound<'_, PyAny>>,
        heading_jerk: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let mut together = Together::default();
        let mut vector = |name, value: Option<&Bound<'_, PyAny>>| -> PyResult<Option<Quantity<3>>> {
            let rows = Quantity::<3>::read_or_none(name, value)?;
            together.note(name, rows.as_ref())?;
            Ok(rows)
        };
        let position = vector("position", Some(position))?;
        let velocity = vector("velocity", velocity)?;
        let acceleration = vector("acceleration", acceleration)?;
        let jerk = vector("jerk", jerk)?;
        let snap = vector("snap", snap)?;
        let crackle = vector("crackle", crackle)?;
        let mut number = |name, value: Option<&Bound<'_, PyAny>>| -> PyResult<Quantity<1>> {
            let rows = Quantity::<1>::read_or_none(name, value)?;
            together.note(name, rows.as_ref())?;
            Ok(rows.unwrap_or(Quantity::of([0.0])))
        };
        let heading = [
            number("heading", heading)?,
            number("heading_rate", heading_rate)?,
            number("heading_acceleration", heading_acceleration)?,
            number("heading_jerk", heading_jerk)?,
        ];
        let known = |rows: Option<Quantity<3>>| rows.unwrap_or(Quantity::of([0.0; 3]));
        Ok(Self {
            crafts: together.crafts(),
            beyond: (snap.is_some() || crackle.is_some()).then(|| [snap, crackle].map(known)),
            position: [position, velocity, acceleration, jerk].map(known),
            heading,
            progress: None,
        })
    }

    /// How long the leading axis is; None for one craft.
    #[getter]
    fn crafts(&self) -> Option<usize> {
        self.crafts
    }

    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.position[0].array(py, self.crafts)
    }

    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.position[1].array(py, self.crafts)
    }

    #[getter]
    fn acceleration<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.position[2].array(py, self.crafts)
    }

    #[getter]
    fn jerk<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.position[3].array(py, self.crafts)
    }

    #[getter]
    fn snap<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.beyond.as_ref().map(|[snap, _]| snap.array(py, self.crafts)).transpose()
    }

    #[getter]
    fn crackle<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.beyond.as_ref().map(|[_, crackle]| crackle.array(py, self.crafts)).transpose()
    }

    #[getter]
    fn heading<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.heading[0].array(py, self.crafts)
    }

    #[getter]
    fn heading_rate<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.heading[1].array(py, self.crafts)
    }

    /// The state that flies it, by the core's flat map.
    #[getter]
    fn state(&self) -> PyResult<State> {
        let mapped = self.mapped()?;
        let attitude = |reference: &quatrack::Reference| {
            let q = reference.state().attitude;
            [q.w, q.x, q.y, q.z].map(f64::from)
        };
        Ok(State {
            crafts: self.crafts,
            position: self.position[0].clone(),
            velocity: self.position[1].clone(),
            attitude: Quantity::of_rows(self.crafts, mapped.iter().map(attitude)),
            body_rates: Some(Quantity::of_rows(
                self.crafts,
                mapped.iter().map(|reference| reference.input().body_rates_rad_s.map(f64::from).into()),
            )),
            specific_force: None,
        })
    }

    /// Thrust over mass that flies it, m/s^2.
    #[getter]
    fn thrust<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let thrust: Vec<[f64; 1]> = self.mapped()?.iter().map(|r| [f64::from(r.input().thrust_m_s2)]).collect();
        array(py, self.crafts, thrust)
    }

    /// For pickle and copy: the quantities as they are, and a player's place on its trajectory.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let position = self.position.iter().map(|rows| rows.held(py)).collect::<PyResult<Vec<_>>>()?;
        let beyond = |rows: &[Quantity<3>; 2]| rows.iter().map(|rows| rows.held(py)).collect::<PyResult<Vec<_>>>();
        let heading = self.heading.iter().map(|rows| rows.held(py)).collect::<PyResult<Vec<_>>>()?;
        let progress = self.progress.map(|Progress { trajectory, tick }| (trajectory, tick));
        by_restoring::<Self>(py, (position, self.beyond.as_ref().map(beyond).transpose()?, heading, progress))
    }

    /// From what `__reduce__` returns.
    #[classmethod]
    fn _restored(
        _cls: &Bound<'_, PyType>,
        position: [Bound<'_, PyAny>; 4],
        beyond: Option<[Bound<'_, PyAny>; 2]>,
        heading: [Bound<'_, PyAny>; 4],
        progress: Option<(u32, u32)>,
    ) -> PyResult<Self> {
        let [at, velocity, acceleration, jerk] = &position;
        let [snap, crackle] = beyond.as_ref().map_or([None; 2], |beyond| beyond.each_ref().map(Some));
        let [a, b, c, d] = heading.each_ref().map(Some);
        let rows = Self::new(at, Some(velocity), Some(acceleration), Some(jerk), snap, crackle, a, b, c, d)?;
        Ok(Self { progress: progress.map(|(trajectory, tick)| Progress { trajectory, tick }), ..rows })
    }

    fn __repr__(&self) -> String {
        match self.crafts {
            None => {
                format!("Reference(position={:?}, velocity={:?})", self.position[0].row(0), self.position[1].row(0))
            }
            Some(crafts) => format!("Reference of {crafts} rows"),
        }
    }
}
