//! Flights that leave the linear range: take-off, landing, a step, a shove, a gust, a start upside down.
//!
//! In go the conditions of a scenario (craft, air, deviations, told figures) and a law; out comes the flight.

use nalgebra::{UnitQuaternion, Vector3};
use quatrack_design::model::GRAVITY_M_S2;
use quatrack_plan::trajectory::fifth_order::{FlatTrajectory, Jump, Rest, RestToRest};

use super::course::Flown;
use super::error::StartError;
use super::flight::Bench;
use super::whole::Scenario;
use crate::control_law::ControlLaw;
use crate::flight::rigid_loop::RigidFlight;
use crate::plant::{Ground, RigidState, Shove};

/// Height at which manoeuvres in the air begin, m.
const HEIGHT_M: f64 = 1.0;
/// The same for the start upside down, m.
const RECOVERY_HEIGHT_M: f64 = 15.0;

/// The manoeuvre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Manoeuvre {
    /// From the ground, motors off, to 1 m in 2 s.
    TakeOff,
    /// From 1 m to the ground in 2.5 s.
    Landing,
    /// The reference jumps by 1 m to the front.
    Step,
    /// Shoved half a metre to the side and let go.
    Shove,
    /// A force as large as the weight from the side, for 0.2 s.
    Gust,
    /// From rest upside down at 15 m, motors at their least, to where it began.
    UpsideDown,
}

impl Manoeuvre {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::TakeOff, Self::Landing, Self::Step, Self::Shove, Self::Gust, Self::UpsideDown];

    /// For tables and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::TakeOff => "take-off",
            Self::Landing => "landing",
            Self::Step => "step",
            Self::Shove => "shove",
            Self::Gust => "gust",
            Self::UpsideDown => "upside-down",
        }
    }

    /// Its name, for the title of a figure.
    pub fn title(self) -> &'static str {
        match self {
            Self::TakeOff => "take-off from the ground to 1 m in 2 s",
            Self::Landing => "landing from 1 m in 2.5 s",
            Self::Step => "a step of the reference by 1 m",
            Self::Shove => "shoved half a metre to the side",
            Self::Gust => "its weight from the side for 0.2 s",
            Self::UpsideDown => "start upside down",
        }
    }

    /// Flies it with a law under the conditions of a scenario, whose course and start are not looked at, over a floor.
    ///
    /// # Errors
    /// [`StartError`] for figures of the scenario that were changed since they were looked at and have no sense.
    pub fn fly(self, scenario: &Scenario, law: &mut dyn ControlLaw) -> Result<RigidFlight, StartError> {
        let mut scenario = scenario.clone();
        scenario.environment.floor = true;
        let weight_n = scenario.truth.mass_kg * GRAVITY_M_S2;
        let (start, course) = self.start_and_course(0.25 * weight_n, scenario.vehicle.motors().thrust_min_n);
        let (mut plant, estimation) = scenario.started_at(&start)?;
        if self == Self::Gust {
            plant = plant.with_load(Shove { from_s: 0.5, to_s: 0.7, force_n: weight_n * Vector3::y() });
        }
        let flown = Flown { course, measured_from_s: 0.0 };
        Ok(Bench { flown: &flown, setpoints: scenario.setpoints, estimation }.fly(&mut plant, law))
    }

    /// `hover_n` and `least_n` are forces of one motor.
    fn start_and_course(self, hover_n: f64, least_n: f64) -> (RigidState, Box<dyn FlatTrajectory>) {
        let standing_m = Vector3::new(0.0, 0.0, Ground::standing_height_m());
        let aloft_m = Vector3::new(0.0, 0.0, HEIGHT_M);
        let hovering = RigidState::at_rest(aloft_m, hover_n);
        let rest = |position_m, duration_s| Box::new(Rest { position_m, heading_rad: 0.0, duration_s });
        match self {
            Self::TakeOff => {
                (RigidState::at_rest(standing_m, 0.0), Box::new(RestToRest::new(standing_m, aloft_m, 2.0, 4.0)))
            }
            Self::Landing => (hovering, Box::new(RestToRest::new(aloft_m, standing_m, 2.5, 3.5))),
            Self::Step => {
                let to_m = aloft_m + Vector3::x();
                (hovering, Box::new(Jump { from_m: aloft_m, to_m, at_s: 0.5, duration_s: 5.5 }))
            }
            Self::Shove => {
                let aside = RigidState { position_m: aloft_m + 0.5 * Vector3::y(), ..hovering };
                (aside, rest(aloft_m, 5.0))
            }
            Self::Gust => (hovering, rest(aloft_m, 5.0)),
            Self::UpsideDown => {
                let high_m = Vector3::new(0.0, 0.0, RECOVERY_HEIGHT_M);
                let attitude = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
                (RigidState { attitude, ..RigidState::at_rest(high_m, least_n) }, rest(high_m, 8.0))
            }
        }
    }
}

/// The result of a flight.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Outcome {
    /// Largest position error, m.
    pub max_error_m: f64,
    /// Position error at the end, m.
    pub end_error_m: f64,
    /// After when the position error stays below 5 cm, s; absent if it never does.
    pub settled_s: Option<f64>,
    /// Lowest height of the centre of mass, m.
    pub min_z_m: f64,
    /// Largest tilt of the thrust axis, degrees.
    pub max_tilt_deg: f64,
    /// Control steps in which a motor was cut to its limits.
    pub saturated_steps: u64,
    /// Whether it was flown to its end.
    pub whole: bool,
}

/// Position error that counts as settled, m.
const SETTLED_M: f64 = 0.05;

impl Outcome {
    /// Of a flight; all zero for one without a sample.
    pub fn of(flight: &RigidFlight) -> Self {
        let samples = &flight.samples;
        let error_m = |index: usize| samples[index].position_error_m().norm();
        let last_off = (0..samples.len()).rev().find(|index| error_m(*index) > SETTLED_M);
        let settled_s = match last_off {
            None => samples.first(),
            Some(index) => samples.get(index + 1),
        };
        let tilt_deg = |axis: Vector3<f64>| axis.z.clamp(-1.0, 1.0).acos().to_degrees();
        Self {
            max_error_m: flight.max_error_m(),
            end_error_m: samples.len().checked_sub(1).map_or(0.0, error_m),
            settled_s: settled_s.map(|sample| sample.time_s),
            min_z_m: samples.iter().map(|sample| sample.state.position_m.z).reduce(f64::min).unwrap_or(0.0),
            max_tilt_deg: samples.iter().map(|sample| tilt_deg(sample.state.thrust_axis())).fold(0.0, f64::max),
            saturated_steps: flight.saturated_steps,
            whole: flight.lost.is_none(),
        }
    }
}
