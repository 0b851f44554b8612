//! Trajectories: pieces, files, plans.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyType;
use quatrack_plan::bounded;
use quatrack_plan::plan::Plan;
use quatrack_plan::trajectory::bspline::BSpline;
use quatrack_plan::trajectory::fifth_order::{FifthOrder, FlatTrajectory};
use quatrack_plan::trajectory::file::{self, TrajectoryFile};
use quatrack_plan::trajectory::polynomial::{Piece, PiecewisePolynomial, csv};
use quatrack_plan::trajectory::refit::refit;
use quatrack_simulation::gains::OnBoardTrajectory;

use crate::arrays::{Quantity, array, matrix, shaped};
use crate::error::refused;
use crate::long_call::long_call;
use crate::pickle::{Reduced, by_restoring};
use crate::player::Player;
use crate::reference::Reference;
use crate::values::Source;

/// Polynomial pieces of position and heading over time.
///
/// durations: (pieces,), s
/// coefficients: (pieces, 4, 8) of x, y, z and heading, ascending powers, m/s^k and rad/s^k
#[pyclass(frozen, module = "quatrack")]
#[derive(Clone)]
pub(crate) struct Trajectory(pub(crate) PiecewisePolynomial);

/// Coefficients of a polynomial.
const POWERS: usize = 8;

fn of_spline(name: &str, spline: &BSpline) -> Result<PiecewisePolynomial, String> {
    PiecewisePolynomial::from_bspline(spline).map_err(|error| format!("{name}: {error}"))
}

fn of_plan(name: &str, plan: &Plan) -> Result<PiecewisePolynomial, String> {
    of_spline(name, &plan.solve().map_err(|error| format!("{name}: {error}"))?)
}

/// A plan with the paper's name, or from a file of any kind.
pub(crate) fn by_name(name: &str) -> Result<PiecewisePolynomial, String> {
    let planned = |plan: Result<Plan, _>| of_plan(name, &plan.map_err(|error| format!("{name}: {error}"))?);
    match name {
        "mild" => planned(quatrack_plan::plan::paper::mild()),
        "aggressive" => planned(quatrack_plan::plan::paper::aggressive()),
        path => match file::read(Path::new(path)).map_err(|error| error.to_string())? {
            TrajectoryFile::Pieces(pieces) => Ok(pieces),
            TrajectoryFile::Spline(spline) => of_spline(path, &spline),
            TrajectoryFile::Plan(text) => planned(Plan::from_toml(&text)),
        },
    }
}

/// A trajectory through waypoints within bounds, by second-order cone programming.
///
/// problem: path of a plan, or its keys as a dictionary
///
/// Raises QuatrackError with the bounds that are too tight and their remedy where there is none.
#[pyfunction]
pub(crate) fn plan(py: Python<'_>, problem: &Bound<'_, PyAny>) -> PyResult<Trajectory> {
    let (name, text) = match Source::read("plan", problem)? {
        Source::Text(text) => ("plan".to_owned(), text),
        Source::Path(path) => {
            let name = path.display().to_string();
            let text = bounded::read_to_string(&path)
                .map_err(|error| refused(format!("{name}: cannot be read ({error}); name an existing plan")))?;
            (name, text)
        }
    };
    let read = Plan::from_toml(&text).map_err(|error| refused(format!("{name}: {error}")))?;
    long_call(py, move |_| of_plan(&name, &read))?.map(Trajectory).map_err(refused)
}

/// Pieces as arrays.
fn pieces(durations: &Bound<'_, PyAny>, coefficients: &Bound<'_, PyAny>) -> PyResult<Vec<Piece>> {
    let durations = Quantity::<1>::read("durations", durations)?;
    let flat = coefficients.py().import("numpy")?.call_method1("reshape", (coefficients, (-1, 4 * POWERS)))?;
    let coefficients = matrix("coefficients", &flat)?;
    if coefficients.nrows() != durations.len() {
        return Err(PyValueError::new_err(format!(
            "coefficients: {} pieces, but durations has {}; give as many of both, coefficients of shape (pieces, 4, 8)",
            coefficients.nrows(),
            durations.len()
        )));
    }
    let piece = |i: usize| Piece {
        duration_s: durations.row(i)[0],
        coefficients: std::array::from_fn(|c| std::array::from_fn(|k| coefficients[(i, c * POWERS + k)])),
    };
    Ok((0..coefficients.nrows()).map(piece).collect())
}

#[pymethods]
impl Trajectory {
    #[new]
    fn new(durations: &Bound<'_, PyAny>, coefficients: &Bound<'_, PyAny>) -> PyResult<Self> {
        PiecewisePolynomial::new(pieces(durations, coefficients)?).map(Self).map_err(refused)
    }

    /// From a file: pieces as CSV, a B-spline, or a plan, which is then solved. "mild" and "aggressive" are the paper's.
    #[classmethod]
    fn load(cls: &Bound<'_, PyType>, path: PathBuf) -> PyResult<Self> {
        let name = path.display().to_string();
        long_call(cls.py(), move |_| by_name(&name))?.map(Self).map_err(refused)
    }

    /// One of the paper's trajectories, "mild" or "aggressive", as it is stored on board.
    #[classmethod]
    fn paper(_cls: &Bound<'_, PyType>, name: &str) -> PyResult<Self> {
        if !matches!(name, "mild" | "aggressive") {
            return Err(PyValueError::new_err(format!(
                "trajectory {name}: not one of the paper's; there are mild, aggressive"
            )));
        }
        OnBoardTrajectory::named(name, Path::new("")).map(|course| Self(course.trajectory().clone())).map_err(refused)
    }

    /// From the text of a CSV file: duration and coefficients of x, y, z and yaw, one piece a line.
    #[classmethod]
    fn from_csv(_cls: &Bound<'_, PyType>, text: &str) -> PyResult<Self> {
        csv::parse(text).map(Self).map_err(refused)
    }

    /// As the text of such a file.
    fn to_csv(&self) -> String {
        csv::write(&self.0)
    }

    /// A trajectory of at most so many pieces close to it: 31 go into a Crazyflie's memory.
    fn refit(&self, py: Python<'_>, pieces: usize) -> PyResult<Self> {
        let most = NonZeroUsize::new(pieces).ok_or_else(|| PyValueError::new_err("pieces: 0; at least 1"))?;
        let source = self.0.clone();
        long_call(py, move |_| refit(&source, most))?.map(Self).map_err(refused)
    }

    /// Length in time, s.
    #[getter]
    fn duration(&self) -> f64 {
        FlatTrajectory::duration_s(&self.0)
    }

    /// Length of each piece, s; shape (pieces,).
    #[getter]
    fn durations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let durations: Vec<[f64; 1]> = self.0.pieces().iter().map(|piece| [piece.duration_s]).collect();
        array(py, Some(durations.len()), durations)
    }

    /// Coefficients of x, y, z and heading, ascending powers; shape (pieces, 4, 8).
    #[getter]
    fn coefficients<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let numbers = self.0.pieces().iter().flat_map(|piece| piece.coefficients.into_iter().flatten()).collect();
        shaped(py, &[self.0.pieces().len(), 4, POWERS], numbers)
    }

    /// The flat output at a time or at many, s. Before its start and after its end, at infinity too, it is at rest there.
    fn at(&self, time: &Bound<'_, PyAny>) -> PyResult<Reference> {
        let times = Quantity::read_times(time)?;
        let points: Vec<FifthOrder> = times.rows().map(|[t_s]| FlatTrajectory::at(&self.0, t_s)).collect();
        Ok(Reference::of_points(times.crafts, &points))
    }

    /// The player that plays it on board, at a rate.
    #[pyo3(signature = (rate_hz=500))]
    fn player(&self, rate_hz: u32) -> PyResult<Player> {
        Player::new(&self.0, rate_hz)
    }

    fn __len__(&self) -> usize {
        self.0.pieces().len()
    }

    /// For pickle and copy: the pieces, and where each ends.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let boundaries_s = self.0.boundaries_s().to_vec();
        by_restoring::<Self>(py, (self.durations(py)?, self.coefficients(py)?, boundaries_s))
    }

    /// From what `__reduce__` returns.
    #[classmethod]
    fn _restored(
        _cls: &Bound<'_, PyType>,
        durations: &Bound<'_, PyAny>,
        coefficients: &Bound<'_, PyAny>,
        boundaries_s: Vec<f64>,
    ) -> PyResult<Self> {
        let pieces = pieces(durations, coefficients)?;
        PiecewisePolynomial::put_together(pieces, &boundaries_s).map(Self).map_err(refused)
    }

    fn __repr__(&self) -> String {
        format!("Trajectory of {} pieces, {} s", self.0.pieces().len(), self.duration())
    }
}
