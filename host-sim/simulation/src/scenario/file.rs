//! A scenario as it is written in TOML: every key, before its value is looked at.
//!
//! ```toml
//! vehicle = "crazyflie-2.1-brushless"            # or the path of a vehicle file, ending in .toml
//! course = "eight"                               # eight, hover, step, mild, aggressive, or a trajectory's path
//! speed_m_s = 2.1                                # highest on an eight
//! [air]                                          # absent: vacuum; air = "vehicle" takes the vehicle's own
//! drag_per_s = [0.447, 0.435, 0.45]
//! ```

mod air;

use std::path::Path;

use quatrack_plan::bounded;
use quatrack_plan::quote::{line_at, one_line, quoted};
use serde::Deserialize;

use super::error::ScenarioError;
use super::flight::Setpoints;
use super::laws::Law;
use super::non_finite::non_finite;
pub use air::{Air, AirOf, OwnAir};

/// The whole file. A key that is absent has its default.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct ScenarioFile {
    /// Name or path of the true craft's vehicle.
    pub vehicle: String,
    /// eight, hover, step, mild, aggressive, or a path.
    pub course: Option<String>,
    /// Highest speed on an eight, m/s.
    pub speed_m_s: Option<f64>,
    /// Length of a step, m.
    pub step_m: Option<f64>,
    /// Duration of the measured part, s.
    pub duration_s: Option<f64>,
    /// The law that flies.
    pub law: Option<Law>,
    /// The laws, where a campaign flies several.
    pub laws: Option<Vec<Law>>,
    /// 100hz or exact.
    pub setpoints: Option<Setpoints>,
    /// exact or kalman.
    pub estimator: Option<Estimator>,
    /// Seed of noise and gusts.
    pub seed: Option<u64>,
    /// The air; vacuum where absent.
    pub air: Option<Air>,
    /// Deviations of the true craft from its vehicle.
    #[serde(default)]
    pub errors: Errors,
    /// Figures that the law is told, where they are not its vehicle's.
    #[serde(default)]
    pub told: Told,
    /// Noise of sensors and, where the estimator is exact, of its estimate.
    #[serde(default)]
    pub noise: Noise,
    /// The estimator's, where it is a filter.
    #[serde(default)]
    pub filter: Filter,
    /// The start of the craft.
    #[serde(default)]
    pub start: Start,
    /// The motors' supply.
    #[serde(default)]
    pub battery: Battery,
    /// Distributions over figures above, for a campaign; one flight leaves them alone.
    pub vary: Option<toml::Table>,
}

/// Where a law's estimate comes from.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Estimator {
    /// The truth with noise.
    #[default]
    Exact,
    /// The error-state Kalman filter on noisy sensors.
    Kalman,
}

/// Deviations of the true craft from its vehicle.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Errors {
    /// True mass over the vehicle's.
    pub mass_factor: Option<f64>,
    /// True inertia over the vehicle's.
    pub inertia_factor: Option<f64>,
    /// True lag of the motors, ms.
    pub lag_ms: Option<f64>,
    /// While thrust grows, ms.
    pub lag_rise_ms: Option<f64>,
    /// While it falls, ms.
    pub lag_fall_ms: Option<f64>,
    /// Delay of the commands, ms.
    pub delay_ms: Option<f64>,
    /// Thrust of a command over its nominal thrust.
    pub thrust_factor: Option<f64>,
    /// The same at the end of the flight.
    pub thrust_factor_end: Option<f64>,
    /// A torque that is always there, about body x and y, N m.
    pub torque_bias_n_m: Option<[f64; 2]>,
    /// Where the centre of mass is, body x and y, m.
    pub centre_of_mass_m: Option<[f64; 2]>,
    /// Thrust of each motor over that of a sound one; 0 is a dead one.
    pub motor_strength: Option<[f64; 4]>,
    /// Gyroscope, rad/s.
    pub gyro_bias_rad_s: Option<[f64; 3]>,
    /// Accelerometer, m/s^2.
    pub accelerometer_bias_m_s2: Option<[f64; 3]>,
}

/// Figures that the law is told; the vehicle's own where absent.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Told {
    /// Mass, kg.
    pub mass_kg: Option<f64>,
    /// Lag of the motors, ms.
    pub lag_ms: Option<f64>,
    /// Linear drag over mass, 1/s.
    pub drag_per_s: Option<f64>,
    /// Airflow moment, N m per m/s.
    pub moment_n_m_per_m_s: Option<[f64; 2]>,
}

/// Standard deviations of a sample.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Noise {
    /// Gyroscope, rad/s.
    pub gyro_rad_s: Option<f64>,
    /// Accelerometer, m/s^2.
    pub accelerometer_m_s2: Option<f64>,
    /// Position, m.
    pub position_m: Option<f64>,
    /// Velocity, m/s.
    pub velocity_m_s: Option<f64>,
    /// Attitude, rad.
    pub attitude_rad: Option<f64>,
}

/// The filter of `estimator = "kalman"`.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Filter {
    /// Predictions a second.
    pub prediction_hz: Option<f64>,
    /// Positions a second.
    pub position_hz: Option<f64>,
    /// Linear drag over mass that it reckons with, 1/s.
    pub drag_per_s: Option<f64>,
    /// Age of a position as it comes in, ms.
    pub latency_ms: Option<f64>,
    /// How much later than the flight's samples, which are 10 ms apart, it predicts, ms.
    pub phase_ms: Option<f64>,
}

/// How the start differs from the course's.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// Beside it, world frame, m.
    pub offset_m: Option<[f64; 3]>,
    /// Faster than it, world frame, m/s.
    pub velocity_m_s: Option<[f64; 3]>,
    /// Turned from its attitude, as a rotation vector in the body frame, rad.
    pub turn_rad: Option<[f64; 3]>,
}

/// The battery of a vehicle whose file has one.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Battery {
    /// Charge at the start, from 0 to 1. Absent: forces are the commanded ones, at any battery.
    pub charge: Option<f64>,
}

impl ScenarioFile {
    /// Nothing but a vehicle: an eight at 2.1 m/s in vacuum.
    pub fn of_vehicle(vehicle: &str) -> Self {
        Self { vehicle: vehicle.to_owned(), ..Self::default() }
    }

    /// From the text of a file.
    ///
    /// # Errors
    /// [`ScenarioError::Syntax`].
    pub fn parse(text: &str, origin: &str) -> Result<Self, ScenarioError> {
        let at = |start: usize, reason: String| {
            let line = line_at(text.as_bytes(), start);
            let written = text.lines().nth(line - 1).unwrap_or("").trim();
            let text = quoted(written.split(" #").next().unwrap_or("").trim());
            ScenarioError::Syntax { origin: origin.to_owned(), line, text, reason }
        };
        if let Some(start) = non_finite(text) {
            return Err(at(start, "must be a finite number".to_owned()));
        }
        toml::from_str(text).map_err(|error| at(error.span().map_or(0, |span| span.start), one_line(error.message())))
    }

    /// From a file.
    ///
    /// # Errors
    /// As [`Self::parse`], and [`ScenarioError::Unreadable`].
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let text = bounded::read_to_string(path)
            .map_err(|error| ScenarioError::Unreadable { path: path.to_owned(), reason: error.to_string() })?;
        Self::parse(&text, &path.display().to_string())
    }
}
