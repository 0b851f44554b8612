//! A scenario whose every value has been looked at: craft, conditions and the told figures, in SI.

mod flights;

use std::fmt;

use nalgebra::{UnitQuaternion, Vector3};
use quatrack_design::vehicle::Vehicle;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;

use super::course::Flown;
use super::file::Estimator as EstimateFrom;
use super::flight::Setpoints;
use super::laws::Law;
use super::sensors::SensorNoise;
use super::told::{ToldFigures, thousandths};
use crate::plant::{self, Environment, RigidState, Truth};
pub use flights::Side;

/// How long is measured by default, s.
pub(super) const EIGHT_MEASURED_S: f64 = 12.0;
pub(super) const HOVER_MEASURED_S: f64 = 10.0;
pub(super) const STEP_MEASURED_S: f64 = 5.0;

/// The course of a scenario.
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

impl CourseChoice {
    /// The courses that are no file: an eight, a hover, a step, and the paper's trajectories.
    pub const NAMES: [&str; 5] = ["eight", "hover", "step", "mild", "aggressive"];
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
    /// How much later than the flight's samples, which are 10 ms apart, it predicts, s: a log that begins at any moment has any phase.
    pub phase_s: f64,
}

/// How a start differs from the course's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StartOffset {
    /// World frame, m.
    pub offset_m: Vector3<f64>,
    /// World frame, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Rotation vector, body frame, rad.
    pub turn_rad: Vector3<f64>,
}

/// A scenario that can be flown.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// The vehicle from which the true craft and the told figures differ.
    pub vehicle: Vehicle,
    /// The course.
    pub course: CourseChoice,
    /// How long is measured, s; a trajectory's own length where absent.
    pub duration_s: Option<f64>,
    /// The law that flies.
    pub law: Law,
    /// Form of the setpoints that a law is told.
    pub setpoints: Setpoints,
    /// Source of its estimate.
    pub estimator: EstimateFrom,
    /// Seed of noise and gusts.
    pub seed: u64,
    /// The surroundings of the craft.
    pub environment: Environment,
    /// The figures of the true craft. Its thrust's factor changes as over an eight of this duration where no course is flown.
    pub truth: Truth,
    /// The factor of its thrust at the end of the course, where it is another one there.
    pub thrust_factor_end: Option<f64>,
    /// Bias of the gyroscope, rad/s.
    pub gyro_bias_rad_s: Vector3<f64>,
    /// Bias of the accelerometer, m/s^2.
    pub accelerometer_bias_m_s2: Vector3<f64>,
    /// The figures that the law is told.
    pub told: ToldFigures,
    /// Standard deviations of a sample.
    pub noise: SensorNoise,
    /// The figures of the filter.
    pub filter: FilterFigures,
    /// Where the craft begins beside its course.
    pub start: StartOffset,
}

impl Scenario {
    /// The course, with the part that is measured. A trajectory is not planned here; see [`CourseChoice::Trajectory`].
    pub fn flown(&self, trajectory: Option<PiecewisePolynomial>) -> Flown {
        match (&self.course, trajectory) {
            (CourseChoice::Eight(speed_m_s), _) => {
                Flown::eight(*speed_m_s, self.duration_s.unwrap_or(EIGHT_MEASURED_S))
            }
            (CourseChoice::Step(step_m), _) => Flown::step(*step_m, self.duration_s.unwrap_or(STEP_MEASURED_S)),
            (CourseChoice::Trajectory(_), Some(trajectory)) => Flown::trajectory(trajectory, self.duration_s),
            (CourseChoice::Hover | CourseChoice::Trajectory(_), _) => {
                Flown::hover(self.duration_s.unwrap_or(HOVER_MEASURED_S))
            }
        }
    }
}

impl StartOffset {
    /// A start that differs by this; the same to the bit where it does not.
    fn applied(&self, start: &RigidState) -> RigidState {
        let mut start = *start;
        if *self != Self::default() {
            start.position_m += self.offset_m;
            start.velocity_m_s += self.velocity_m_s;
            start.attitude *= UnitQuaternion::from_scaled_axis(self.turn_rad);
        }
        start
    }
}

impl CourseChoice {
    /// The name or path of a trajectory that has to be had before it can be flown.
    pub fn trajectory(&self) -> Option<&str> {
        match self {
            Self::Trajectory(name) => Some(name),
            _ => None,
        }
    }
}

impl fmt::Display for CourseChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Eight(speed_m_s) => write!(f, "eight at {speed_m_s} m/s"),
            Self::Hover => f.write_str("hover"),
            Self::Step(step_m) => write!(f, "step of {step_m} m"),
            Self::Trajectory(name) => f.write_str(name),
        }
    }
}

/// The conditions of a flight, without its course, as one line.
pub struct InConditions<'a>(&'a Scenario);

impl Scenario {
    /// Its conditions for a heading: air, wind, setpoints, noise and estimate.
    pub fn conditions(&self) -> InConditions<'_> {
        InConditions(self)
    }
}

/// One line that says the course and the conditions.
impl fmt::Display for Scenario {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.vehicle.name(), self.course)?;
        if let Some(duration_s) = self.duration_s {
            write!(f, ", {duration_s} s")?;
        }
        write!(f, ", {}", self.conditions())
    }
}

impl fmt::Display for InConditions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(scenario) = self;
        let Environment { air, wind, .. } = &scenario.environment;
        if *air == plant::Air::VACUUM {
            f.write_str("in vacuum")?;
        } else {
            let ([x, y, z], [c_x, c_y]) = (air.drag_per_s, air.moment_n_m_per_m_s);
            write!(f, "drag {x:.3}, {y:.3}, {z:.3} 1/s, moment {:.2}, {:.2} mN m per m/s", 1e3 * c_x, 1e3 * c_y)?;
        }
        if wind.mean_m_s != Vector3::zeros() {
            write!(f, ", wind {} m/s", thousandths(wind.mean_m_s.norm()))?;
        }
        if let Some(turbulence) = &wind.turbulence {
            write!(f, ", gusts {} m/s", thousandths(turbulence.rms_m_s.x))?;
        }
        let setpoints = if scenario.setpoints == Setpoints::Exact { "exact setpoints" } else { "setpoints at 100 Hz" };
        let noise = if scenario.noise == SensorNoise::default() { "without noise" } else { "with noise" };
        write!(f, ", {setpoints}, {noise}")?;
        if scenario.estimator == EstimateFrom::Kalman {
            let FilterFigures { prediction_hz, drag_per_s, .. } = scenario.filter;
            write!(f, ", Kalman filter at {prediction_hz} Hz with drag {drag_per_s} 1/s")?;
        }
        Ok(())
    }
}
