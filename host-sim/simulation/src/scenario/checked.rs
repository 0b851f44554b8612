//! A scenario whose every value has been looked at: a file in, craft, conditions and what a law is told out.

use std::path::Path;

use nalgebra::Vector3;

use super::course::Flown;
use super::error::ScenarioError;
use super::file::{Air, Estimator, ScenarioFile};
use super::flight::Setpoints;
use super::laws::{Law, ToldFigures};
use super::sensors::SensorNoise;
use crate::vehicles;
use quatrack_design::vehicle::Vehicle;

/// Fastest wind and gust through which linear drag was measured, m/s: the flights of arXiv 2512.14450 are that fast.
const AIR_MAX_M_S: f64 = 5.0;

/// What is flown.
#[derive(Clone, Debug, PartialEq)]
pub enum CourseChoice {
    /// An eight with its highest speed, m/s.
    Eight(f64),
    /// A hover.
    Hover,
    /// A step with its length, m.
    Step(f64),
    /// One of the paper's trajectories or a file, as it was named.
    Trajectory(String),
}

/// What the air does to the craft.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AirFigures {
    /// Linear drag over mass along body x, y, z, 1/s.
    pub drag_per_s: Vector3<f64>,
    /// Airflow moment about body x and y, N m a m/s.
    pub moment_n_m_per_m_s: [f64; 2],
    /// Steady wind, world frame, m/s.
    pub wind_m_s: Vector3<f64>,
    /// Root mean square of the gust, m/s.
    pub gust_rms_m_s: f64,
}

/// What the true craft differs in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrueFigures {
    /// Mass over the vehicle's.
    pub mass_factor: f64,
    /// Inertia over the vehicle's.
    pub inertia_factor: f64,
    /// While thrust grows, s.
    pub lag_rise_s: f64,
    /// While it falls, s.
    pub lag_fall_s: f64,
    /// How late commands act, s.
    pub delay_s: f64,
    /// Thrust over what a command should give, at the start and at the end.
    pub thrust_factor: [f64; 2],
    /// About body x and y, N m.
    pub torque_bias_n_m: [f64; 2],
    /// Body x and y, m.
    pub centre_of_mass_m: [f64; 2],
    /// Gyroscope, rad/s.
    pub gyro_bias_rad_s: Vector3<f64>,
    /// Accelerometer, m/s^2.
    pub accelerometer_bias_m_s2: Vector3<f64>,
}

/// A Kalman filter's figures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterFigures {
    /// Predictions a second.
    pub prediction_hz: f64,
    /// Positions a second.
    pub position_hz: f64,
    /// Drag over mass that it reckons with, 1/s.
    pub drag_per_s: f64,
    /// Age of a position as it comes in, s.
    pub latency_s: f64,
}

/// A scenario that can be flown.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// The vehicle that the craft and what the law is told differ from.
    pub vehicle: Vehicle,
    /// What is flown.
    pub course: CourseChoice,
    /// How long is measured, s; a trajectory's own length where absent.
    pub duration_s: Option<f64>,
    /// Whose law.
    pub law: Law,
    /// How a law is told of the course.
    pub setpoints: Setpoints,
    /// Where its estimate comes from.
    pub estimator: Estimator,
    /// Where noise and gusts begin.
    pub seed: u64,
    /// Nothing in vacuum.
    pub air: Option<AirFigures>,
    /// The true craft.
    pub truth: TrueFigures,
    /// What the law is told.
    pub told: ToldFigures,
    /// Standard deviations of a sample.
    pub noise: SensorNoise,
    /// Of the filter.
    pub filter: FilterFigures,
}

/// Checks values of one file.
struct Checks<'a> {
    origin: &'a str,
}

impl Checks<'_> {
    fn refuse(&self, key: &'static str, value: impl ToString, must: String) -> ScenarioError {
        ScenarioError::Value { origin: self.origin.to_owned(), key, value: value.to_string(), must }
    }

    /// A value within bounds, both included; the default where there is none. NaN is within no bounds.
    fn one(
        &self,
        key: &'static str,
        value: Option<f64>,
        default: f64,
        [least, most]: [f64; 2],
        what: &str,
    ) -> Result<f64, ScenarioError> {
        let value = value.unwrap_or(default);
        if (least..=most).contains(&value) {
            return Ok(value);
        }
        Err(self.refuse(key, value, format!("from {least} to {most}, {what}")))
    }

    /// Likewise every component.
    fn each<const N: usize>(
        &self,
        key: &'static str,
        values: Option<[f64; N]>,
        bounds: [f64; 2],
        what: &str,
    ) -> Result<[f64; N], ScenarioError> {
        let values = values.unwrap_or([0.0; N]);
        values.iter().try_for_each(|value| self.one(key, Some(*value), 0.0, bounds, what).map(|_| ()))?;
        Ok(values)
    }
}

impl Scenario {
    /// From a file.
    ///
    /// # Errors
    /// [`ScenarioError`].
    pub fn from_file(path: &Path) -> Result<Self, ScenarioError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::checked(&ScenarioFile::read(path)?, &path.display().to_string(), folder)
    }

    /// From what a file says; relative paths in it begin at a folder.
    ///
    /// # Errors
    /// [`ScenarioError::Value`] and [`ScenarioError::Named`] with `origin` for the file's name.
    pub fn checked(file: &ScenarioFile, origin: &str, folder: &Path) -> Result<Self, ScenarioError> {
        let checks = Checks { origin };
        let vehicle = vehicle(&file.vehicle, origin, folder)?;
        let (course, default_s) = course(file, &checks, folder)?;
        let duration_s = match (file.duration_s, default_s) {
            (None, default) => default,
            (Some(value), _) => Some(checks.one("duration_s", Some(value), 0.0, [0.1, 600.0], "in s")?),
        };
        if file.air == Some(Air::Vehicle) {
            let reason = "air = \"vehicle\": the vehicle's file says nothing of its air; give [air] with figures";
            return Err(ScenarioError::Named { origin: origin.to_owned(), key: "air", reason: reason.to_owned() });
        }
        Ok(Self {
            course,
            duration_s,
            law: file.law.unwrap_or_default(),
            setpoints: file.setpoints.unwrap_or_default(),
            estimator: file.estimator.unwrap_or_default(),
            seed: file.seed.unwrap_or(1),
            air: match &file.air {
                Some(Air::Own(_)) => Some(air(file, &checks)?),
                _ => None,
            },
            truth: truth(file, &checks, &vehicle)?,
            told: told(file, &checks, &vehicle)?,
            noise: noise(file, &checks)?,
            filter: filter(file, &checks)?,
            vehicle,
        })
    }

    /// What is flown, with the part that is measured. A trajectory is not planned here; see [`CourseChoice::Trajectory`].
    pub fn flown(&self, trajectory: Option<quatrack_plan::trajectory::polynomial::PiecewisePolynomial>) -> Flown {
        match (&self.course, trajectory) {
            (CourseChoice::Eight(speed_m_s), _) => Flown::eight(*speed_m_s, self.duration_s.unwrap_or(EIGHT_S)),
            (CourseChoice::Step(step_m), _) => Flown::step(*step_m, self.duration_s.unwrap_or(STEP_S)),
            (CourseChoice::Trajectory(_), Some(trajectory)) => Flown::trajectory(trajectory, self.duration_s),
            (CourseChoice::Hover | CourseChoice::Trajectory(_), _) => {
                Flown::hover(self.duration_s.unwrap_or(HOVER_S))
            }
        }
    }
}

/// How long is measured by default, s.
const EIGHT_S: f64 = 12.0;
const HOVER_S: f64 = 10.0;
const STEP_S: f64 = 5.0;

fn vehicle(name: &str, origin: &str, folder: &Path) -> Result<Vehicle, ScenarioError> {
    let path = Path::new(name);
    let found = if path.extension().is_some_and(|end| end == "toml") {
        vehicles::from_file(&folder.join(path))
    } else {
        vehicles::by_name(name)
    };
    found.map_err(|error| ScenarioError::Named {
        origin: origin.to_owned(),
        key: "vehicle",
        reason: error.to_string(),
    })
}

fn course(
    file: &ScenarioFile,
    checks: &Checks<'_>,
    folder: &Path,
) -> Result<(CourseChoice, Option<f64>), ScenarioError> {
    let name = file.course.as_deref().unwrap_or("eight");
    let foreign = |key, value: Option<f64>, of: &str| match value {
        Some(value) if name != of => Err(checks.refuse(key, value, format!("left out: it belongs to course = \"{of}\""))),
        _ => Ok(()),
    };
    foreign("speed_m_s", file.speed_m_s, "eight")?;
    foreign("step_m", file.step_m, "step")?;
    Ok(match name {
        "eight" => {
            let speed = checks.one("speed_m_s", file.speed_m_s, 2.1, [0.01, 10.0], "the highest speed in m/s")?;
            (CourseChoice::Eight(speed), Some(EIGHT_S))
        }
        "hover" => (CourseChoice::Hover, Some(HOVER_S)),
        "step" => {
            let step = checks.one("step_m", file.step_m, 1.0, [-10.0, 10.0], "in m")?;
            (CourseChoice::Step(step), Some(STEP_S))
        }
        "mild" | "aggressive" => (CourseChoice::Trajectory(name.to_owned()), None),
        path => (CourseChoice::Trajectory(folder.join(path).display().to_string()), None),
    })
}

fn air(file: &ScenarioFile, checks: &Checks<'_>) -> Result<AirFigures, ScenarioError> {
    let Some(Air::Own(own)) = &file.air else { return Ok(AirFigures::default()) };
    let limit = format!("in m/s; drag is linear only in air that moves no faster past the craft than {AIR_MAX_M_S} m/s");
    let wind_m_s = own.wind_m_s.unwrap_or([0.0; 3]);
    let speed = Vector3::from(wind_m_s).norm();
    // Written so that NaN fails it.
    if !(speed <= AIR_MAX_M_S) {
        let must = format!("of a size from 0 to {AIR_MAX_M_S}, {limit}");
        let [x, y, z] = wind_m_s;
        return Err(checks.refuse("air.wind_m_s", format!("[{x}, {y}, {z}]"), must));
    }
    Ok(AirFigures {
        drag_per_s: checks.each("air.drag_per_s", own.drag_per_s, [0.0, 3.0], "drag over mass in 1/s")?.into(),
        moment_n_m_per_m_s: checks.each(
            "air.moment_n_m_per_m_s",
            own.moment_n_m_per_m_s,
            [0.0, 0.01],
            "in N m a m/s; a Crazyflie has 4e-4 to 9e-4",
        )?,
        wind_m_s: wind_m_s.into(),
        gust_rms_m_s: checks.one("air.gust_rms_m_s", own.gust_rms_m_s, 0.0, [0.0, 0.5 * AIR_MAX_M_S], &limit)?,
    })
}

/// Bounds of a motor's lag, ms.
const LAG_MS: [f64; 2] = [1.0, 1000.0];

fn truth(file: &ScenarioFile, checks: &Checks<'_>, vehicle: &Vehicle) -> Result<TrueFigures, ScenarioError> {
    let errors = &file.errors;
    let own_ms = 1e3 * vehicle.motors().lag_s;
    let (rise, fall) = match (errors.lag_ms, errors.lag_rise_ms, errors.lag_fall_ms) {
        (lag, None, None) => (lag.unwrap_or(own_ms), lag.unwrap_or(own_ms)),
        (None, Some(rise), Some(fall)) => (rise, fall),
        (Some(lag), _, _) => {
            let must = "left out beside lag_rise_ms and lag_fall_ms, or these two left out".to_owned();
            return Err(checks.refuse("errors.lag_ms", lag, must));
        }
        (None, rise, fall) => {
            let (key, value) = if rise.is_some() { ("errors.lag_rise_ms", rise) } else { ("errors.lag_fall_ms", fall) };
            let must = "given with lag_rise_ms and lag_fall_ms both; lag_ms is for one that is the same".to_owned();
            return Err(checks.refuse(key, value.unwrap_or_default(), must));
        }
    };
    let split = errors.lag_rise_ms.is_some();
    let [rise_key, fall_key] =
        if split { ["errors.lag_rise_ms", "errors.lag_fall_ms"] } else { ["errors.lag_ms", "errors.lag_ms"] };
    let factor = |key, value, default, bounds| checks.one(key, value, default, bounds, "true over the vehicle's");
    let thrust_factor = factor("errors.thrust_factor", errors.thrust_factor, 1.0, [0.5, 1.5])?;
    Ok(TrueFigures {
        mass_factor: factor("errors.mass_factor", errors.mass_factor, 1.0, [0.5, 2.0])?,
        inertia_factor: factor("errors.inertia_factor", errors.inertia_factor, 1.0, [0.2, 5.0])?,
        lag_rise_s: 1e-3 * checks.one(rise_key, Some(rise), 0.0, LAG_MS, "in ms")?,
        lag_fall_s: 1e-3 * checks.one(fall_key, Some(fall), 0.0, LAG_MS, "in ms")?,
        delay_s: 1e-3 * checks.one("errors.delay_ms", errors.delay_ms, 0.0, [0.0, 100.0], "in ms")?,
        thrust_factor: [
            thrust_factor,
            factor("errors.thrust_factor_end", errors.thrust_factor_end, thrust_factor, [0.5, 1.5])?,
        ],
        torque_bias_n_m: checks.each("errors.torque_bias_n_m", errors.torque_bias_n_m, [-0.01, 0.01], "in N m")?,
        centre_of_mass_m: checks.each("errors.centre_of_mass_m", errors.centre_of_mass_m, [-0.02, 0.02], "in m")?,
        gyro_bias_rad_s: checks.each("errors.gyro_bias_rad_s", errors.gyro_bias_rad_s, [-1.0, 1.0], "in rad/s")?.into(),
        accelerometer_bias_m_s2: checks
            .each("errors.accelerometer_bias_m_s2", errors.accelerometer_bias_m_s2, [-5.0, 5.0], "in m/s^2")?
            .into(),
    })
}

fn told(file: &ScenarioFile, checks: &Checks<'_>, vehicle: &Vehicle) -> Result<ToldFigures, ScenarioError> {
    let (told, own_kg) = (&file.told, vehicle.mass_kg());
    let bounds = [0.5 * own_kg, 2.0 * own_kg];
    let mass_kg = checks.one("told.mass_kg", told.mass_kg, own_kg, bounds, "in kg, half to twice the vehicle's")?;
    let lag_s = |ms: f64| checks.one("told.lag_ms", Some(ms), 0.0, LAG_MS, "in ms").map(|ms| 1e-3 * ms);
    let drag = |value| checks.one("told.drag_per_s", Some(value), 0.0, [0.0, 3.0], "drag over mass in 1/s");
    let moment = |value| checks.each("told.moment_n_m_per_m_s", Some(value), [0.0, 0.01], "in N m a m/s");
    Ok(ToldFigures {
        mass_kg,
        lag_s: told.lag_ms.map(lag_s).transpose()?,
        drag_per_s: told.drag_per_s.map(drag).transpose()?,
        moment_n_m_per_m_s: told.moment_n_m_per_m_s.map(moment).transpose()?,
    })
}

fn noise(file: &ScenarioFile, checks: &Checks<'_>) -> Result<SensorNoise, ScenarioError> {
    let noise = &file.noise;
    let deviation = |key, value, most| checks.one(key, value, 0.0, [0.0, most], "the deviation of a sample");
    Ok(SensorNoise {
        gyro_rad_s: deviation("noise.gyro_rad_s", noise.gyro_rad_s, 5.0)?,
        accelerometer_m_s2: deviation("noise.accelerometer_m_s2", noise.accelerometer_m_s2, 50.0)?,
        position_m: deviation("noise.position_m", noise.position_m, 1.0)?,
        velocity_m_s: deviation("noise.velocity_m_s", noise.velocity_m_s, 5.0)?,
        attitude_rad: deviation("noise.attitude_rad", noise.attitude_rad, 0.5)?,
    })
}

fn filter(file: &ScenarioFile, checks: &Checks<'_>) -> Result<FilterFigures, ScenarioError> {
    let filter = &file.filter;
    let rate = |key, value: Option<f64>| {
        let hz = checks.one(key, value, 100.0, [1.0, 1000.0], "times a second")?;
        // The flight has 1000 steps a second; a rate must be a whole number of them.
        if (1000.0 / hz).fract() == 0.0 { Ok(hz) } else { Err(checks.refuse(key, hz, "a divisor of 1000 Hz".to_owned())) }
    };
    Ok(FilterFigures {
        prediction_hz: rate("filter.prediction_hz", filter.prediction_hz)?,
        position_hz: rate("filter.position_hz", filter.position_hz)?,
        drag_per_s: checks.one("filter.drag_per_s", filter.drag_per_s, 0.0, [0.0, 3.0], "drag over mass in 1/s")?,
        latency_s: 1e-3 * checks.one("filter.latency_ms", filter.latency_ms, 0.0, [0.0, 200.0], "in ms")?,
    })
}
