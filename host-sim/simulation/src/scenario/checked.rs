//! A scenario whose every value has been looked at: a file in, craft, conditions and the figures that a law is told out.

mod truth;

use std::path::Path;

use nalgebra::Vector3;
use quatrack_design::vehicle::Vehicle;
use quatrack_plan::quote::plain;

use super::checks::Checks;
use super::error::ScenarioError;
use super::file::{Air, ScenarioFile};
use super::sensors::SensorNoise;
use super::told::ToldFigures;
use super::whole::{
    CourseChoice, EIGHT_MEASURED_S, FilterFigures, HOVER_MEASURED_S, STEP_MEASURED_S, Scenario, StartOffset,
};
use crate::plant::{self, Dryden, Environment, RigidState, Wind};
use crate::vehicles;
use truth::truth;

impl Scenario {
    /// From a file.
    ///
    /// # Errors
    /// [`ScenarioError`].
    pub fn from_file(path: &Path) -> Result<Self, ScenarioError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::checked(&ScenarioFile::read(path)?, &path.display().to_string(), folder)
    }

    /// From the contents of a file; relative paths in it begin at a folder.
    ///
    /// # Errors
    /// [`ScenarioError::Value`] and [`ScenarioError::Named`] with `origin` for the file's name.
    pub fn checked(file: &ScenarioFile, origin: &str, folder: &Path) -> Result<Self, ScenarioError> {
        Self::on(vehicle(&file.vehicle, origin, folder)?, file, origin, folder)
    }

    /// The same on a vehicle that is at hand; the file's is not looked at.
    ///
    /// # Errors
    /// As [`Self::checked`].
    pub fn on(vehicle: Vehicle, file: &ScenarioFile, origin: &str, folder: &Path) -> Result<Self, ScenarioError> {
        let checks = Checks { origin };
        let (course, default_s) = course(file, &checks, folder)?;
        let duration_s = match (file.duration_s, default_s) {
            (None, default) => default,
            (Some(value), _) => Some(checks.one("duration_s", Some(value), 0.0, [0.1, 600.0], "in s")?),
        };
        let errors = &file.errors;
        let bias = |key, value, most: f64, unit| checks.each(key, value, [-most, most], unit).map(Vector3::from);
        let scenario = Self {
            course,
            duration_s,
            law: file.law.unwrap_or_default(),
            setpoints: file.setpoints.unwrap_or_default(),
            estimator: file.estimator.unwrap_or_default(),
            seed: file.seed.unwrap_or(1),
            environment: environment(file, &checks, &vehicle)?,
            truth: truth(file, &checks, &vehicle, duration_s)?,
            thrust_factor_end: file.errors.thrust_factor_end,
            gyro_bias_rad_s: bias("errors.gyro_bias_rad_s", errors.gyro_bias_rad_s, 1.0, "in rad/s")?,
            accelerometer_bias_m_s2: bias(
                "errors.accelerometer_bias_m_s2",
                errors.accelerometer_bias_m_s2,
                5.0,
                "in m/s^2",
            )?,
            told: ToldFigures::checked(&file.told, &checks, &vehicle)?,
            noise: noise(file, &checks)?,
            filter: filter(file, &checks)?,
            start: start(file, &checks)?,
            vehicle,
        };
        // The plant looks at its own figures.
        scenario
            .plant(&RigidState::at_rest(Vector3::zeros(), 0.0))
            .map_err(|error| ScenarioError::Plant { origin: origin.to_owned(), error })?;
        air_acts(file, &checks)?;
        Ok(scenario)
    }
}

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
        reason: plain(&error.to_string()),
    })
}

fn course(
    file: &ScenarioFile,
    checks: &Checks<'_>,
    folder: &Path,
) -> Result<(CourseChoice, Option<f64>), ScenarioError> {
    let name = file.course.as_deref().unwrap_or("eight");
    let foreign = |key, value: Option<f64>, of: &str| match value {
        Some(value) if name != of => {
            Err(checks.refuse(key, &value, format!("left out: it belongs to course = \"{of}\"")))
        }
        _ => Ok(()),
    };
    foreign("speed_m_s", file.speed_m_s, "eight")?;
    foreign("step_m", file.step_m, "step")?;
    Ok(match name {
        "eight" => {
            let speed = checks.one("speed_m_s", file.speed_m_s, 2.1, [0.01, 10.0], "the highest speed in m/s")?;
            (CourseChoice::Eight(speed), Some(EIGHT_MEASURED_S))
        }
        "hover" => (CourseChoice::Hover, Some(HOVER_MEASURED_S)),
        "step" => {
            let step = checks.one("step_m", file.step_m, 1.0, [-10.0, 10.0], "in m")?;
            (CourseChoice::Step(step), Some(STEP_MEASURED_S))
        }
        "mild" | "aggressive" => (CourseChoice::Trajectory(name.to_owned()), None),
        path => (CourseChoice::Trajectory(folder.join(path).display().to_string()), None),
    })
}

/// Height whose turbulence a scenario has, m.
const TURBULENCE_HEIGHT_M: f64 = 1.0;
/// Of the vertical component over the horizontal ones there: MIL-F-8785C, 3.7.3.4, at its lowest height of 10 ft,
/// `(0.177 + 0.000823 h)^0.4`.
const VERTICAL_SHARE: f64 = 0.51;

fn environment(file: &ScenarioFile, checks: &Checks<'_>, vehicle: &Vehicle) -> Result<Environment, ScenarioError> {
    let (own, of_vehicle) = match &file.air {
        None => return Ok(Environment::VACUUM),
        Some(Air::Own(own)) => (own, plant::Air::VACUUM),
        Some(Air::Vehicle(own)) => {
            let air = plant::Air::of(vehicle).ok_or_else(|| ScenarioError::Named {
                origin: checks.origin.to_owned(),
                key: "air",
                reason: "\"vehicle\": the vehicle's file says nothing of its air; give [air] with figures".to_owned(),
            })?;
            (own, air)
        }
    };
    let mean_m_s = Vector3::from(own.wind_m_s.unwrap_or([0.0; 3]));
    let turbulence = own.gust_rms_m_s.filter(|rms| *rms != 0.0).map(|rms| {
        let rms_m_s = Vector3::new(rms, rms, VERTICAL_SHARE * rms);
        Dryden::at_low_altitude(rms_m_s, TURBULENCE_HEIGHT_M, mean_m_s.norm())
    });
    let air = plant::Air {
        drag_per_s: own.drag_per_s.unwrap_or(of_vehicle.drag_per_s),
        moment_n_m_per_m_s: own.moment_n_m_per_m_s.unwrap_or(of_vehicle.moment_n_m_per_m_s),
        ..of_vehicle
    };
    Ok(Environment { air, wind: Wind { mean_m_s, gust: None, turbulence }, ..Environment::VACUUM })
}

/// Wind without drag and moment moves no craft: whoever flies it reads figures of vacuum.
fn air_acts(file: &ScenarioFile, checks: &Checks<'_>) -> Result<(), ScenarioError> {
    let Some(Air::Own(own)) = &file.air else { return Ok(()) };
    if own.drag_per_s.is_some() || own.moment_n_m_per_m_s.is_some() {
        return Ok(());
    }
    let must = "0 where the air has no drag and no moment, through which it acts on the craft: give air.drag_per_s or \
                air.moment_n_m_per_m_s, or of = \"vehicle\" (--air vehicle) for the vehicle's own";
    let wind_m_s = own.wind_m_s.unwrap_or_default();
    if wind_m_s != [0.0; 3] {
        return Err(checks.refuse("air.wind_m_s", &format!("{wind_m_s:?}"), must.to_owned()));
    }
    match own.gust_rms_m_s {
        Some(rms_m_s) if rms_m_s != 0.0 => Err(checks.refuse("air.gust_rms_m_s", &rms_m_s, must.to_owned())),
        _ => Ok(()),
    }
}

fn start(file: &ScenarioFile, checks: &Checks<'_>) -> Result<StartOffset, ScenarioError> {
    let start = &file.start;
    let each = |key, value, most: f64, unit| checks.each(key, value, [-most, most], unit).map(Vector3::from);
    Ok(StartOffset {
        offset_m: each("start.offset_m", start.offset_m, 4.0, "in m")?,
        velocity_m_s: each("start.velocity_m_s", start.velocity_m_s, 10.0, "in m/s")?,
        turn_rad: each("start.turn_rad", start.turn_rad, std::f64::consts::PI, "in rad")?,
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
        if (1000.0 / hz).fract() == 0.0 {
            Ok(hz)
        } else {
            Err(checks.refuse(key, &hz, "a divisor of 1000 Hz".to_owned()))
        }
    };
    Ok(FilterFigures {
        prediction_hz: rate("filter.prediction_hz", filter.prediction_hz)?,
        position_hz: rate("filter.position_hz", filter.position_hz)?,
        drag_per_s: checks.one("filter.drag_per_s", filter.drag_per_s, 0.0, [0.0, 3.0], "drag over mass in 1/s")?,
        latency_s: 1e-3 * checks.one("filter.latency_ms", filter.latency_ms, 0.0, [0.0, 200.0], "in ms")?,
        phase_s: 1e-3 * checks.one("filter.phase_ms", filter.phase_ms, 0.0, [0.0, 9.0], "in ms")?,
    })
}
