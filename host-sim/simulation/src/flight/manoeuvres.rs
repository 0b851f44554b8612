//! Flights that leave the linear range: take-off, landing, a step, a shove, a start upside down.
//!
//! In flow a vehicle, a lag and a table; out flow named flights of the rigid plant under the f32 core at 500 Hz.

use std::cell::Cell;

use nalgebra::{UnitQuaternion, Vector3};
use quatrack_design::model::GRAVITY_M_S2;
use quatrack_design::vehicle::Vehicle;
use quatrack_plan::trajectory::fifth_order::{Braking, FifthOrder, FlatTrajectory, Jump, Rest, RestToRest};

use super::motor_laws::{AwareTable, FlightError, fly};
use super::motor_loop::{PERIOD_S, STEPS_A_SAMPLE};
use super::rigid_loop::{Conditions, RigidFlight, fly_rigid};
use crate::plant::{Craft, Ground, RigidState, Shove};

/// Height at which manoeuvres in the air begin, m.
const HEIGHT_M: f64 = 1.0;
/// The same for the start upside down, m.
const RECOVERY_HEIGHT_M: f64 = 15.0;
/// Acceleration downwards of the reference until the craft is upright, m/s^2: thrust enough to turn by.
const FALLING_M_S2: f64 = 6.0;
/// Cosine of the tilt below which a craft counts as upright.
const UPRIGHT: f64 = 0.95;
/// Body rates below which it does, rad/s.
const STILL_RAD_S: f64 = 3.0;
/// How long it then brakes, s.
const BRAKING_S: f64 = 3.0;

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
    /// From rest upside down at 15 m: upright first, then to rest in 3 s.
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

    /// Flies it with a table, on a vehicle whose motors have the lag `lag_s`.
    ///
    /// # Errors
    /// [`FlightError`] where the core refuses the table's lag.
    pub fn fly(self, vehicle: &Vehicle, lag_s: f64, table: &AwareTable) -> Result<RigidFlight, FlightError> {
        let mut craft = Craft::new(vehicle).with_load(Ground::under(vehicle));
        craft.motors = craft.motors.with_lag(lag_s, lag_s);
        let standing_m = Vector3::new(0.0, 0.0, Ground::standing_height_m());
        let aloft_m = Vector3::new(0.0, 0.0, HEIGHT_M);
        let hovering = RigidState::at_rest(aloft_m, vehicle.hover_thrust_n());
        let rest = |position_m, duration_s| Rest { position_m, heading_rad: 0.0, duration_s };
        let (start, course): (RigidState, Box<dyn FlatTrajectory>) = match self {
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
                (aside, Box::new(rest(aloft_m, 5.0)))
            }
            Self::Gust => {
                let force_n = vehicle.mass_kg() * GRAVITY_M_S2 * Vector3::y();
                craft = craft.with_load(Shove { from_s: 0.5, to_s: 0.7, force_n });
                (hovering, Box::new(rest(aloft_m, 5.0)))
            }
            Self::UpsideDown => return recover(vehicle, &craft, table),
        };
        let conditions =
            Conditions { duration_s: course.duration_s(), steps_a_sample: STEPS_A_SAMPLE, delay_s: 0.0, noise: None };
        Ok(fly(&table.craft_law()?, &craft, &start, course.as_ref(), &conditions))
    }
}

/// From rest upside down: attitude first, then speed.
///
/// Until the craft is upright its reference is wherever it is, with little thrust, so that only attitude and body rates are
/// fed back; then it brakes from the speed that it has to rest.
fn recover(vehicle: &Vehicle, craft: &Craft, table: &AwareTable) -> Result<RigidFlight, FlightError> {
    let mut start = RigidState::at_rest(Vector3::new(0.0, 0.0, RECOVERY_HEIGHT_M), vehicle.motors().thrust_min_n);
    start.attitude = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    let law = table.craft_law()?;
    let mut control = law.started(&start.thrusts_n);
    let target_m = Cell::new(start.position_m);
    let mut braking: Option<(u32, Braking)> = None;
    let conditions = Conditions { duration_s: 6.0, steps_a_sample: STEPS_A_SAMPLE, delay_s: 0.0, noise: None };
    Ok(fly_rigid(
        craft,
        &start,
        &conditions,
        |_| target_m.get(),
        |tick, measured| {
            let upright = measured.thrust_axis().z > UPRIGHT && measured.body_rates_rad_s.norm() < STILL_RAD_S;
            if braking.is_none() && upright {
                braking = Some((tick, Braking::new(measured.position_m, measured.velocity_m_s, BRAKING_S)));
            }
            let point = match &braking {
                Some((since, course)) => course.at(f64::from(tick - since) * PERIOD_S),
                None => {
                    let mut point = FifthOrder::at_rest(measured.position_m, 0.0);
                    point.position[1] = measured.velocity_m_s;
                    point.position[2] = Vector3::new(0.0, 0.0, -FALLING_M_S2);
                    point
                }
            };
            target_m.set(point.position[0]);
            control.as_mut().ok_or("the motors' thrusts are not finite")?.step(measured, &point)
        },
    ))
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
