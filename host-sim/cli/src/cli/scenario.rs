//! `--scenario` and a flag for each of its keys: a file, flags over it, or flags alone in; a scenario whose every value has been
//! looked at out.

mod flags;
pub(super) mod values;

use std::path::{Path, PathBuf};

use quatrack_design::vehicle::Vehicle;
use quatrack_plan::quote::quoted;
use quatrack_simulation::scenario::file::{Estimator, ScenarioFile};
use quatrack_simulation::scenario::flight::Setpoints;
use quatrack_simulation::scenario::{CourseChoice, Law, Scenario};
use quatrack_simulation::vehicles;

use super::Failure;
use super::names::did_you_mean;
use values::{List, estimator, law, setpoints};

/// A scenario by file and flags; a flag goes before the file.
#[derive(Clone, clap::Args)]
#[command(next_help_heading = "Scenario")]
pub(crate) struct ScenarioArgs {
    /// The scenario (TOML): a craft, its air, its deviations, a course and a law.
    #[arg(long, value_name = "FILE")]
    pub(super) scenario: Option<PathBuf>,
    /// A built-in vehicle, or a TOML file.
    #[arg(long, value_name = "VEHICLE")]
    pub(super) vehicle: Option<String>,
    /// quatrack, crazyflie, actuator-aware, lqr-e, lyap-e, lqr-f, lyap-f, mellinger, lee or pid.
    #[arg(long, value_name = "NAME", value_parser = law)]
    pub(super) law: Option<Law>,
    /// eight, hover, step, mild, aggressive, or a trajectory's file.
    #[arg(long, value_name = "COURSE")]
    course: Option<String>,
    /// Highest speed on an eight, m/s.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    speed_m_s: Option<f64>,
    /// Length of a step, m.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    step_m: Option<f64>,
    /// Duration of the measured part, s.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    duration_s: Option<f64>,
    /// 100hz, to the jerk and held; or exact, at every step.
    #[arg(long, value_name = "100hz|exact", value_parser = setpoints)]
    setpoints: Option<Setpoints>,
    /// exact, the truth with noise; or kalman, the core's filter behind noisy sensors.
    #[arg(long, value_name = "exact|kalman", value_parser = estimator)]
    estimator: Option<Estimator>,
    /// Where noise and gusts begin: a whole number from 0.
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    seed: Option<u64>,
    /// vehicle, the air of the vehicle's file; or vacuum.
    #[arg(long, value_name = "vehicle|vacuum", value_parser = ["vehicle", "vacuum"])]
    air: Option<String>,
    /// Drag over mass along body x, y and z, 1/s.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    drag_per_s: Option<List<3>>,
    /// Moment of the airflow about body x and y, N m per m/s.
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    moment_n_m_per_m_s: Option<List<2>>,
    /// Steady wind, world frame, m/s.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    wind_m_s: Option<List<3>>,
    /// Root mean square of each horizontal component of Dryden's turbulence, m/s.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    gust_rms_m_s: Option<f64>,
    /// True mass over the vehicle's.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    mass_factor: Option<f64>,
    /// True inertia over the vehicle's.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    inertia_factor: Option<f64>,
    /// True lag of the motors, ms.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    lag_ms: Option<f64>,
    /// The same while thrust grows, ms; with --lag-fall-ms.
    #[arg(long, value_name = "X", allow_negative_numbers = true, conflicts_with = "lag_ms")]
    lag_rise_ms: Option<f64>,
    /// The same while it falls, ms; with --lag-rise-ms.
    #[arg(long, value_name = "X", allow_negative_numbers = true, conflicts_with = "lag_ms")]
    lag_fall_ms: Option<f64>,
    /// Delay of the commands, ms.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    delay_ms: Option<f64>,
    /// Thrust of a command over its nominal thrust.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    thrust_factor: Option<f64>,
    /// The same at the end of the flight.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    thrust_factor_end: Option<f64>,
    /// A torque that is always there, about body x and y, N m.
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    torque_bias_n_m: Option<List<2>>,
    /// Where the centre of mass is, body x and y, m.
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    centre_of_mass_m: Option<List<2>>,
    /// Bias of the gyroscope, rad/s.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    gyro_bias_rad_s: Option<List<3>>,
    /// Bias of the accelerometer, m/s^2.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    accelerometer_bias_m_s2: Option<List<3>>,
    /// Mass that the law is told, kg.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    told_mass_kg: Option<f64>,
    /// Lag that the law is told, ms.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    told_lag_ms: Option<f64>,
    /// Drag over mass that the law is told, 1/s.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    told_drag_per_s: Option<f64>,
    /// Moment of the airflow that the law is told, N m per m/s.
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    told_moment_n_m_per_m_s: Option<List<2>>,
    /// Noise of the gyroscope, deviation of a sample, rad/s.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    noise_gyro_rad_s: Option<f64>,
    /// Noise of the accelerometer, m/s^2.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    noise_accelerometer_m_s2: Option<f64>,
    /// Noise of the position, m.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    noise_position_m: Option<f64>,
    /// Noise of the velocity, m/s.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    noise_velocity_m_s: Option<f64>,
    /// Noise of the attitude, rad.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    noise_attitude_rad: Option<f64>,
    /// Predictions of the filter a second.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    filter_prediction_hz: Option<f64>,
    /// Positions that the filter is given a second.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    filter_position_hz: Option<f64>,
    /// Drag over mass that the filter reckons with, 1/s.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    filter_drag_per_s: Option<f64>,
    /// Age of a position as the filter is given it, ms.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    filter_latency_ms: Option<f64>,
    /// How much later than the flight's samples the filter predicts, 0 to 9 ms.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    filter_phase_ms: Option<f64>,
}

/// Refuses the name of a course that is none and no file either, as a slip of the keyboard is.
pub(super) fn existing_course(origin: &str, written: &str, path: &Path) -> Result<(), Failure> {
    if CourseChoice::NAMES.contains(&written) || path.exists() {
        return Ok(());
    }
    Err(Failure::input(format!(
        "{origin}: course = \"{}\": there is no such course and no such file; the courses are {}, others are trajectory files{}",
        quoted(written),
        CourseChoice::NAMES.join(", "),
        did_you_mean(written, CourseChoice::NAMES)
    )))
}

impl ScenarioArgs {
    /// Whether there is a file or a flag other than --vehicle.
    pub(super) fn any_but_vehicle(&self) -> bool {
        let mut file = self.alone();
        file.vehicle.clear();
        self.scenario.is_some() || self.air.is_some() || file != ScenarioFile::default()
    }

    /// What the flags say without a file.
    fn alone(&self) -> ScenarioFile {
        let mut file = ScenarioFile::default();
        self.put_over(&mut file);
        file
    }

    /// The scenario.
    ///
    /// # Errors
    /// The value of the file or of a flag that is out of range, in one line.
    pub(super) fn checked(&self) -> Result<Scenario, Failure> {
        self.checked_for(false, None)
    }

    /// The scenario; without a file or a vehicle that of a vehicle, and without a file or a word of the air in the vehicle's own air
    /// where its file knows it.
    ///
    /// # Errors
    /// As [`Self::checked`].
    pub(super) fn checked_in_own_air(&self, vehicle: &str) -> Result<Scenario, Failure> {
        let named = self.vehicle.as_deref().unwrap_or(vehicle);
        if self.scenario.is_some() {
            return self.checked();
        }
        let mut own = self.clone();
        own.vehicle = Some(named.to_owned());
        let mut scenario = own.checked()?;
        let mut file = ScenarioFile::default();
        self.put_over_air(&mut file.air);
        if file.air.is_none() && self.air.is_none() && quatrack_simulation::plant::Air::of(&scenario.vehicle).is_some()
        {
            own.air = Some("vehicle".to_owned());
            scenario = own.checked()?;
        }
        Ok(scenario)
    }

    /// The same for a table of gains where there is one: on its own vehicle where neither file nor flag names one. Any lag may be
    /// told: the table refuses those that it is not certified for.
    ///
    /// # Errors
    /// As [`Self::checked`].
    pub(super) fn checked_for(&self, table: bool, own: Option<&Vehicle>) -> Result<Scenario, Failure> {
        let (mut file, name, folder) = match (&self.scenario, &self.vehicle) {
            (Some(path), _) => {
                let file = ScenarioFile::read(path).map_err(Failure::input)?;
                (file, path.display().to_string(), path.parent().unwrap_or(Path::new("")))
            }
            (None, Some(_)) => (ScenarioFile::default(), String::new(), Path::new("")),
            (None, None) if own.is_some() => (ScenarioFile::default(), String::new(), Path::new("")),
            (None, None) => return Err(Failure::input("no craft to fly: give --scenario FILE or --vehicle VEHICLE")),
        };
        self.put_over(&mut file);
        let lag_ms = if table { file.told.lag_ms.take() } else { None };
        let told = |mut scenario: Scenario| {
            scenario.told.lag_s = scenario.told.lag_s.or(lag_ms.map(|lag_ms| 1e-3 * lag_ms));
            scenario
        };
        if file.vehicle.is_empty()
            && let Some(vehicle) = own
        {
            return Scenario::on(vehicle.clone(), &file, "flags", folder).map(told).map_err(Failure::input);
        }
        let has_flags = self.air.is_some() || self.alone() != ScenarioFile::default();
        let origin = match (name.is_empty(), has_flags) {
            (true, _) => "flags".to_owned(),
            (false, false) => name,
            (false, true) => format!("{name} with flags"),
        };
        let scenario = Scenario::checked(&file, &origin, folder).map(told).map_err(|error| {
            let is_unknown = !file.vehicle.ends_with(".toml") && vehicles::by_name(&file.vehicle).is_err();
            let alike = if is_unknown { did_you_mean(&file.vehicle, vehicles::names()) } else { String::new() };
            Failure::input(format!("{error}{alike}"))
        })?;
        let written = self.course.as_deref().or(file.course.as_deref()).unwrap_or_default();
        if let Some(path) = scenario.course.trajectory() {
            existing_course(&origin, written, Path::new(path))?;
        }
        Ok(scenario)
    }
}
