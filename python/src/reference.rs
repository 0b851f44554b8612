//! References, for one craft or for many.

use pyo3::prelude::*;
use quatrack::nalgebra::Vector3;
use quatrack::{FifthOrderSample, FlatSample, Progress};
use quatrack_plan::trajectory::fifth_order::FifthOrder;

use crate::arrays::{Quantity, Together, array};
use crate::error::refused_of;
use crate::state::{State, single};

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

impl Reference {
    /// The number of rows.
    pub(crate) fn len(&self) -> usize {
        self.crafts.unwrap_or(1)
    }

    /// Heading and its derivatives of a row.
    #[inline]
    fn turn(&self, craft: usize) -> [[f32; 1]; 4] {
        self.heading.each_ref().map(|rows| single(rows.row(craft)))
    }

    /// One row, to the jerk, as the core takes it.
    #[inline]
    pub(crate) fn flat(&self, craft: usize) -> FlatSample {
        let [position, velocity, acceleration, jerk] = &self.position;
        let of = |rows: &Quantity<3>| Vector3::from(single(rows.row(craft)));
        let [[heading_rad], [heading_rate_rad_s], ..] = self.turn(craft);
        FlatSample {
            position_m: of(position),
            velocity_m_s: of(velocity),
            acceleration_m_s2: of(acceleration),
            jerk_m_s3: of(jerk),
            heading_rad,
            heading_rate_rad_s,
        }
    }

    /// One row with all that is known of it.
    #[inline]
    pub(crate) fn sample(&self, craft: usize) -> FifthOrderSample {
        let [.., [heading_acceleration_rad_s2], [heading_jerk_rad_s3]] = self.turn(craft);
        let [snap, crackle] = match &self.beyond {
            Some(beyond) => beyond.each_ref().map(|rows| single(rows.row(craft))),
            None => [[0.0; 3]; 2],
        };
        FifthOrderSample {
            flat: self.flat(craft),
            snap_m_s4: Vector3::from(snap),
            crackle_m_s5: Vector3::from(crackle),
            heading_acceleration_rad_s2,
            heading_jerk_rad_s3,
        }
    }

    /// Of points of a course.
    pub(crate) fn of_points(crafts: Option<usize>, points: &[FifthOrder]) -> Self {
        let order = |k: usize| Quantity::of_rows(crafts, points.iter().map(|point| point.position[k].into()));
        let turn = |k: usize| Quantity::of_rows(crafts, points.iter().map(|point| [point.heading[k]]));
        Self {
            crafts,
            position: [0, 1, 2, 3].map(order),
            beyond: Some([4, 5].map(order)),
            heading: [0, 1, 2, 3].map(turn),
            progress: None,
        }
    }

    /// The core's references.
    fn mapped(&self) -> PyResult<Vec<quatrack::Reference>> {
        let of = |craft| self.crafts.map(|_| craft);
        (0..self.len())
            .map(|craft| {
                quatrack::Reference::from_flat(&self.flat(craft)).map_err(|error| refused_of(of(craft), error))
            })
            .collect()
    }
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

    fn __repr__(&self) -> String {
        match self.crafts {
            None => {
                format!("Reference(position={:?}, velocity={:?})", self.position[0].row(0), self.position[1].row(0))
            }
            Some(crafts) => format!("Reference of {crafts} rows"),
        }
    }
}
