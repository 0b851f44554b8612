//! The core's error-state Kalman filter with its estimate.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use quatrack::Quaternion;
use quatrack::estimator::{
    Estimate, Estimator as CoreEstimator, EstimatorConfig, Force, Gate, Imu, Innovation, Integration,
};
use quatrack::nalgebra::Vector3;

use crate::arrays::{Quantity, array, shaped};
use crate::error::refused;
use crate::state::{State, single};

/// The core's error-state Kalman filter with its estimate, of one craft.
///
/// state: State to begin with
/// force: "thrust-axis" or "all-axes", the part of the accelerometer that the prediction takes
/// integration: "second-order", or "crazyflie" as that firmware does it
/// drag_per_s: (2,), linear drag over mass along body x and y, 1/s, for "thrust-axis"
/// acceleration_noise, gyro_noise: (3,), densities, m/s^2 and rad/s per root hertz
/// deviation_at_start: (4,), standard deviations of position, velocity, tilt and heading at the start, m, m/s, rad, rad
/// deviation_min, deviation_max: bounds of any deviation, SI
/// gate: "open", "99%", "99.9%" or "99.99%", which measurements are taken for outliers
///
/// Arguments left out are as in the Crazyflie's firmware.
#[pyclass(module = "quatrack")]
pub(crate) struct Estimator {
    filter: CoreEstimator,
    estimate: Estimate,
}

/// One row of an argument.
fn row<const W: usize>(name: &str, value: &Bound<'_, PyAny>) -> PyResult<[f32; W]> {
    let given = Quantity::<W>::read(name, value)?;
    match given.crafts {
        None => Ok(single(given.row(0))),
        Some(_) => Err(PyValueError::new_err(format!("{name}: many rows; an estimator is of one craft"))),
    }
}

fn vector(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vector3<f32>> {
    row(name, value).map(Vector3::from)
}

fn three(name: &str, value: Option<&Bound<'_, PyAny>>, default: [f32; 3]) -> PyResult<[f32; 3]> {
    value.filter(|value| !value.is_none()).map_or(Ok(default), |value| row(name, value))
}

fn said<'py, const N: usize>(py: Python<'py>, innovation: &Innovation<N>) -> PyResult<Bound<'py, PyDict>> {
    let dictionary = PyDict::new(py);
    dictionary.set_item("difference", array(py, None, vec![innovation.difference])?)?;
    dictionary.set_item("variance", array(py, None, vec![innovation.variance])?)?;
    dictionary.set_item("normalised_squared", innovation.normalised_squared)?;
    dictionary.set_item("is_taken", innovation.is_taken)?;
    Ok(dictionary)
}

#[pymethods]
impl Estimator {
    #[new]
    #[pyo3(signature = (state, *, force="thrust-axis", integration="second-order", drag_per_s=None, acceleration_noise=None,
        gyro_noise=None, deviation_at_start=None, deviation_min=None, deviation_max=None, gate="open"))]
    #[expect(clippy::too_many_arguments, reason = "each is a keyword")]
    fn new(
        state: &State,
        force: &str,
        integration: &str,
        drag_per_s: Option<[f32; 2]>,
        acceleration_noise: Option<&Bound<'_, PyAny>>,
        gyro_noise: Option<&Bound<'_, PyAny>>,
        deviation_at_start: Option<[f32; 4]>,
        deviation_min: Option<f32>,
        deviation_max: Option<f32>,
        gate: &str,
    ) -> PyResult<Self> {
        let shipped = EstimatorConfig::CRAZYFLIE;
        let of =
            |key: &str, value: &str, known: &str| PyValueError::new_err(format!("{key}: {value}; there are {known}"));
        let mut at_start = shipped.at_start;
        if let Some([position, velocity, tilt, heading]) = deviation_at_start {
            (at_start.position_m, at_start.velocity_m_s) = (position, velocity);
            (at_start.tilt_rad, at_start.heading_rad) = (tilt, heading);
        }
        let config = EstimatorConfig {
            force: match force {
                "thrust-axis" => Force::ThrustAxis,
                "all-axes" => Force::AllAxes,
                other => return Err(of("force", other, "thrust-axis, all-axes")),
            },
            integration: match integration {
                "second-order" => Integration::SecondOrder,
                "crazyflie" => Integration::Crazyflie,
                other => return Err(of("integration", other, "second-order, crazyflie")),
            },
            drag_per_s: drag_per_s.unwrap_or(shipped.drag_per_s),
            acceleration_noise: three("acceleration_noise", acceleration_noise, shipped.acceleration_noise)?,
            gyro_noise: three("gyro_noise", gyro_noise, shipped.gyro_noise)?,
            at_start,
            deviation_min: deviation_min.unwrap_or(shipped.deviation_min),
            deviation_max: deviation_max.unwrap_or(shipped.deviation_max),
            gate: match gate {
                "open" => Gate::Open,
                "99%" => Gate::Percent99,
                "99.9%" => Gate::PerMille999,
                "99.99%" => Gate::PerMyriad9999,
                other => return Err(of("gate", other, "open, 99%, 99.9%, 99.99%")),
            },
        };
        if state.crafts.is_some() {
            return Err(PyValueError::new_err("state: many crafts; an estimator is of one"));
        }
        let filter = CoreEstimator::new(config).map_err(refused)?;
        let estimate = filter.start(&state.core(0)).map_err(refused)?;
        Ok(Self { filter, estimate })
    }

    /// Carries the estimate on over a period, s, by the mean of gyroscope (rad/s) and accelerometer (m/s^2) in it.
    fn predict(&mut self, gyro: &Bound<'_, PyAny>, accelerometer: &Bound<'_, PyAny>, period: f32) -> PyResult<()> {
        let imu = Imu {
            body_rates_rad_s: vector("gyro", gyro)?,
            specific_force_m_s2: vector("accelerometer", accelerometer)?,
        };
        self.filter.predict(&mut self.estimate, &imu, period).map_err(refused)
    }

    /// Takes a measured position, m, of a standard deviation, m.
    fn update_position<'py>(
        &mut self,
        py: Python<'py>,
        position: &Bound<'_, PyAny>,
        deviation: f32,
    ) -> PyResult<Bound<'py, PyDict>> {
        let position = vector("position", position)?;
        said(py, &self.filter.update_position(&mut self.estimate, &position, deviation).map_err(refused)?)
    }

    /// Takes a measured velocity, m/s, of a standard deviation, m/s.
    fn update_velocity<'py>(
        &mut self,
        py: Python<'py>,
        velocity: &Bound<'_, PyAny>,
        deviation: f32,
    ) -> PyResult<Bound<'py, PyDict>> {
        let velocity = vector("velocity", velocity)?;
        said(py, &self.filter.update_velocity(&mut self.estimate, &velocity, deviation).map_err(refused)?)
    }

    /// Takes a measured attitude, scalar first, of a standard deviation about each body axis, rad.
    fn update_attitude<'py>(
        &mut self,
        py: Python<'py>,
        attitude: &Bound<'_, PyAny>,
        deviation: f32,
    ) -> PyResult<Bound<'py, PyDict>> {
        let [w, x, y, z] = row("attitude", attitude)?;
        let attitude = Quaternion::new(w, x, y, z);
        said(py, &self.filter.update_attitude(&mut self.estimate, attitude, deviation).map_err(refused)?)
    }

    /// Takes a measured height, m.
    fn update_height<'py>(&mut self, py: Python<'py>, height: f32, deviation: f32) -> PyResult<Bound<'py, PyDict>> {
        said(py, &self.filter.update_height(&mut self.estimate, height, deviation).map_err(refused)?)
    }

    /// Takes a measured distance from a known point, m.
    fn update_distance<'py>(
        &mut self,
        py: Python<'py>,
        point: &Bound<'_, PyAny>,
        distance: f32,
        deviation: f32,
    ) -> PyResult<Bound<'py, PyDict>> {
        let point = vector("point", point)?;
        said(py, &self.filter.update_distance(&mut self.estimate, &point, distance, deviation).map_err(refused)?)
    }

    /// The estimate: position, attitude and velocity.
    #[getter]
    fn state(&self) -> State {
        let state = self.estimate.state();
        let q = state.attitude;
        let attitude = [q.w, q.x, q.y, q.z].map(f64::from);
        State::of_one(state.position_m.map(f64::from).into(), attitude, state.velocity_m_s.map(f64::from).into())
    }

    /// Covariance of the errors of position (m), velocity (m/s) and rotation in the body frame (rad); shape (9, 9).
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        shaped(py, &[9, 9], self.estimate.covariance().to_rows().as_flattened().to_vec())
    }
}
