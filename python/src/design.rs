//! Riccati, Lyapunov and Stein equations, and certificates of gains as they are flown.

use num_complex::Complex64;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quatrack_design::certify::{Controller, Plant, Timing, certify as certify_gain};
use quatrack_design::design::actuator_aware::hover_pair;
use quatrack_design::design::sampled::equilibrium_pair;
use quatrack_design::design::{self, DareSolution, DesignError, RiccatiSolution};

use crate::arrays::{from_matrix, matrix, shaped};
use crate::error::refused;
use crate::long_call::long_call;
use crate::values::from_json;
use crate::vehicle;

/// An optimal feedback and the solution of its Riccati equation.
#[pyclass(frozen, module = "quatrack")]
pub(crate) struct Feedback {
    p: nalgebra::DMatrix<f64>,
    gain: nalgebra::DMatrix<f64>,
    poles: Vec<Complex64>,
    /// Relative residual of P, evaluated in 32 digits.
    #[pyo3(get)]
    relative_residual: f64,
    /// Last Newton correction over P.
    #[pyo3(get)]
    last_correction: f64,
    /// Relative change of P for a relative change of the problem, an upper estimate; None in discrete time.
    #[pyo3(get)]
    condition: Option<f64>,
}

#[pymethods]
impl Feedback {
    /// P, symmetric; shape (n, n).
    #[getter]
    fn p<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        from_matrix(py, &self.p)
    }

    /// K for u = -K x; shape (m, n).
    #[getter]
    fn gain<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        from_matrix(py, &self.gain)
    }

    /// Poles of the closed loop with the gain as it is returned, complex, sorted by real part: 1/s, or per sample; shape (n,).
    /// All are stable: a gain that is stable with more digits alone is refused.
    #[getter]
    fn poles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        shaped(py, &[self.poles.len()], self.poles.clone())
    }

    fn __repr__(&self) -> String {
        format!(
            "Feedback(gain of {} by {}, residual {:.1e})",
            self.gain.nrows(),
            self.gain.ncols(),
            self.relative_residual
        )
    }
}

impl From<RiccatiSolution> for Feedback {
    fn from(solution: RiccatiSolution) -> Self {
        let RiccatiSolution { p, gain, poles, relative_residual, last_correction, condition } = solution;
        Self { p, gain, poles, relative_residual, last_correction, condition: Some(condition) }
    }
}

impl From<DareSolution> for Feedback {
    fn from(solution: DareSolution) -> Self {
        let DareSolution { p, gain, poles, relative_residual, last_correction } = solution;
        Self { p, gain, poles, relative_residual, last_correction, condition: None }
    }
}

type Matrix = nalgebra::DMatrix<f64>;

/// Solves one of the Riccati equations on four matrices.
fn riccati<S: Into<Feedback> + Send + 'static>(
    py: Python<'_>,
    [a, b, q, r]: [&Bound<'_, PyAny>; 4],
    solve: impl FnOnce(&Matrix, &Matrix, &Matrix, &Matrix) -> Result<S, DesignError> + Send + 'static,
) -> PyResult<Feedback> {
    let (a, b, q, r) = (matrix("a", a)?, matrix("b", b)?, matrix("q", q)?, matrix("r", r)?);
    long_call(py, move |_| solve(&a, &b, &q, &r))?.map(Into::into).map_err(refused)
}

/// The stabilising solution of `A'P + P A - P B R^-1 B' P + Q = 0`.
///
/// a: (n, n); b: (n, m); q: (n, n), symmetric; r: (m, m), symmetric
///
/// Returns a Feedback; a poor answer is a QuatrackError that names the fault of the problem.
#[pyfunction]
pub(crate) fn care(
    py: Python<'_>,
    a: &Bound<'_, PyAny>,
    b: &Bound<'_, PyAny>,
    q: &Bound<'_, PyAny>,
    r: &Bound<'_, PyAny>,
) -> PyResult<Feedback> {
    riccati(py, [a, b, q, r], design::care)
}

/// The optimal feedback for weights Q >= 0 and R > 0 in continuous time.
///
/// a: (n, n); b: (n, m); q: (n, n), symmetric; r: (m, m), symmetric
///
/// Returns a Feedback; a poor answer is a QuatrackError that names the fault of the problem.
#[pyfunction]
pub(crate) fn lqr(
    py: Python<'_>,
    a: &Bound<'_, PyAny>,
    b: &Bound<'_, PyAny>,
    q: &Bound<'_, PyAny>,
    r: &Bound<'_, PyAny>,
) -> PyResult<Feedback> {
    riccati(py, [a, b, q, r], design::lqr)
}

/// The stabilising solution of the Riccati equation in discrete time.
///
/// a: (n, n); b: (n, m); q: (n, n), symmetric; r: (m, m), symmetric
///
/// Returns a Feedback; a poor answer is a QuatrackError that names the fault of the problem.
#[pyfunction]
pub(crate) fn dare(
    py: Python<'_>,
    a: &Bound<'_, PyAny>,
    b: &Bound<'_, PyAny>,
    q: &Bound<'_, PyAny>,
    r: &Bound<'_, PyAny>,
) -> PyResult<Feedback> {
    riccati(py, [a, b, q, r], design::dare)
}

/// The optimal feedback in discrete time, with a cross weight where one is given.
///
/// a: (n, n); b: (n, m); q: (n, n), symmetric; r: (m, m), symmetric
///
/// Returns a Feedback; a poor answer is a QuatrackError that names the fault of the problem.
///
/// s: (n, m), the cross weight
#[pyfunction]
#[pyo3(signature = (a, b, q, r, s=None))]
pub(crate) fn dlqr(
    py: Python<'_>,
    a: &Bound<'_, PyAny>,
    b: &Bound<'_, PyAny>,
    q: &Bound<'_, PyAny>,
    r: &Bound<'_, PyAny>,
    s: Option<&Bound<'_, PyAny>>,
) -> PyResult<Feedback> {
    let cross = s.filter(|s| !s.is_none()).map(|s| matrix("s", s)).transpose()?;
    riccati(py, [a, b, q, r], move |a, b, q, r| match cross {
        Some(s) => design::dlqr_with_cross(a, b, q, r, &s),
        None => design::dlqr(a, b, q, r),
    })
}

/// X of `A'X + X A + Q = 0`.
///
/// a, q: (n, n), q symmetric; A need not be stable
///
/// Returns X, (n, n), symmetric.
#[pyfunction]
pub(crate) fn lyapunov<'py>(
    py: Python<'py>,
    a: &Bound<'py, PyAny>,
    q: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let (a, q) = (matrix("a", a)?, matrix("q", q)?);
    let solution = long_call(py, move |_| design::lyapunov(&a, &q))?.map_err(refused)?;
    from_matrix(py, &solution.x)
}

/// X of `A'X A - X + Q = 0`.
///
/// a, q: (n, n), q symmetric; A need not be stable
///
/// Returns X, (n, n), symmetric.
#[pyfunction]
pub(crate) fn stein<'py>(py: Python<'py>, a: &Bound<'py, PyAny>, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let (a, q) = (matrix("a", a)?, matrix("q", q)?);
    let solution = long_call(py, move |_| design::stein(&a, &q))?.map_err(refused)?;
    from_matrix(py, &solution.x)
}

/// The linear model at hover, (A, B).
///
/// vehicle: without one, the paper's: errors x y z q1 q2 q3 vx vy vz, inputs T p q r (m/s^2, rad/s); A (9, 9), B (9, 4). With one,
///     down to its motors, in parts of their forces: A (16, 16), B (16, 4)
/// lag_s: of the motors; the vehicle's own where left out
#[pyfunction]
#[pyo3(signature = (vehicle=None, lag_s=None))]
pub(crate) fn hover_model<'py>(
    py: Python<'py>,
    vehicle: Option<&Bound<'py, PyAny>>,
    lag_s: Option<f64>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let (a, b) = match vehicle.filter(|vehicle| !vehicle.is_none()) {
        None => equilibrium_pair(),
        Some(vehicle) => {
            let vehicle = vehicle::argument(vehicle)?;
            let plant = hover_pair(&vehicle, lag_s.unwrap_or(vehicle.motors().lag_s), 1.0, 1.0);
            (plant.0, plant.1)
        }
    };
    Ok((from_matrix(py, &a)?, from_matrix(py, &b)?))
}

/// The certificate of a feedback as it is flown, rounded to single precision and held over a period.
///
/// a: (n, n); b: (n, m); gain: (m, n) of u = -K x; rate_hz: control rate
/// delay_samples: whole samples by which commands are known to act late
/// rate_loop_gain: gain of a body-rate loop, 1/s, for lag limits behind it
///
/// Returns the certificate as a dictionary: poles, margins, largest delay and lag, decrease of a Lyapunov function. An unstable loop is
/// a QuatrackError.
#[pyfunction]
#[pyo3(signature = (a, b, gain, rate_hz, *, delay_samples=0, rate_loop_gain=None))]
pub(crate) fn certify<'py>(
    py: Python<'py>,
    a: &Bound<'py, PyAny>,
    b: &Bound<'py, PyAny>,
    gain: &Bound<'py, PyAny>,
    rate_hz: f64,
    delay_samples: usize,
    rate_loop_gain: Option<f64>,
) -> PyResult<Bound<'py, PyAny>> {
    let (a, b, gain) = (matrix("a", a)?, matrix("b", b)?, matrix("gain", gain)?);
    if !(rate_hz > 0.0 && rate_hz.is_finite()) {
        return Err(PyValueError::new_err(format!("rate_hz: {rate_hz}; must be positive and finite")));
    }
    let timing = Timing { period_s: 1.0 / rate_hz, delay_samples };
    let certificate = long_call(py, move |_| {
        let plant = Plant::new(a, b)?;
        certify_gain(&plant, &Controller::memoryless(gain), &timing, rate_loop_gain)
    })?
    .map_err(refused)?;
    let report = serde_json::to_value(&certificate).map_err(refused)?;
    from_json(py, &report)
}
