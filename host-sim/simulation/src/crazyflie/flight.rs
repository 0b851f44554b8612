//! One flight: a course, a craft and its deviations in; its errors out.
//!
//! A course that moves at its start is flown for some seconds before, as if the craft had come there. A recording begins
//! as switched on.

use std::collections::VecDeque;

use quatrack_design::vehicle::Vehicle;
use quatrack_plan::trajectory::fifth_order::FifthOrder;
use serde::Serialize;

use super::course::Course;
use super::firmware::{Firmware, STEPS_HZ, Sensors, Tune};
use super::recording::Recording;
use super::setpoints::Setpoints;
use crate::flight::closed_loop::LOST_M;
use crate::flight::motor_loop;
use crate::flight::noise::{Noise, Source};
use crate::plant::{Craft, Ground, RigidState};

/// Steps between two samples of the error: 100 Hz.
const SAMPLE_STEPS: i32 = 10;

/// Steps for which a course that moves at its start is flown before; a whole number of setpoints.
const LEAD_IN_STEPS: i32 = 5000;

/// The deviations from the controller's model, and the form of its setpoints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// True lag of the motors, s.
    pub lag_s: f64,
    /// True mass over the assumed one.
    pub mass_factor: f64,
    /// True inertia over the assumed one.
    pub inertia_factor: f64,
    /// Steps of the firmware by which commands act late.
    pub late_steps: usize,
    /// Errors of the estimate, where there are any.
    pub noise: Option<Noise>,
    /// Sensors.
    pub sensors: Sensors,
    /// The form of the setpoints.
    pub setpoints: Setpoints,
}

impl Case {
    /// Motors of a lag, everything else as it should be.
    pub const fn of_lag(lag_s: f64) -> Self {
        Self {
            lag_s,
            mass_factor: 1.0,
            inertia_factor: 1.0,
            late_steps: 0,
            noise: None,
            sensors: Sensors { gyro_noise_rad_s: 0.0, estimate_steps: 1 },
            setpoints: Setpoints::HighLevel,
        }
    }
}

/// The errors of a flight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FlightErrors {
    /// Integral of the position error over time, m s; nothing where the craft was lost.
    pub iae: Option<f64>,
    /// Largest position error, m.
    pub max_error_m: f64,
    /// Position error at the end, m.
    pub end_error_m: f64,
    /// Largest tilt, degrees.
    pub max_tilt_deg: f64,
}

/// Flies a course from its start in the air, or from the ground where it begins there.
pub fn fly(vehicle: &Vehicle, course: &Course, tune: &Tune, case: &Case) -> FlightErrors {
    let mut firmware = Firmware::start(vehicle, tune, case.sensors);
    fly_with(&mut firmware, vehicle, course, case, None)
}

/// The same with a firmware that has been switched on.
pub fn fly_on(firmware: &mut Firmware, vehicle: &Vehicle, course: &Course, case: &Case) -> FlightErrors {
    fly_with(firmware, vehicle, course, case, None)
}

/// The part of a flight that is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Recorded {
    /// So many steps.
    pub steps: u32,
    /// Halfway another table is asked for.
    pub then: Option<u8>,
}

/// Flies a course and keeps the calls between firmware and controller.
pub fn fly_recorded(vehicle: &Vehicle, course: &Course, tune: &Tune, case: &Case, recorded: Recorded) -> Recording {
    let mut firmware = Firmware::start_recorded(vehicle, tune, case.sensors);
    fly_with(&mut firmware, vehicle, course, case, Some(recorded));
    firmware.recorded().unwrap_or_default()
}

fn fly_with(
    firmware: &mut Firmware,
    vehicle: &Vehicle,
    course: &Course,
    case: &Case,
    recorded: Option<Recorded>,
) -> FlightErrors {
    let mut craft = Craft::new(vehicle);
    craft.body = craft.body.scaled(case.mass_factor, case.inertia_factor);
    craft.motors = craft.motors.with_lag(case.lag_s, case.lag_s);
    let lead_in_steps = if recorded.is_none() && course.coming_from(0.0).is_some() { LEAD_IN_STEPS } else { 0 };
    let at_s = |step: i32| f64::from(step) / f64::from(STEPS_HZ);
    let begin_s = at_s(-lead_in_steps);
    let start = course.position_m(begin_s).unwrap_or_default();
    let hovering = RigidState::at_rest(start, vehicle.hover_thrust_n());
    let mut state = course.coming_from(begin_s).and_then(|point| on_course(&point, vehicle)).unwrap_or(hovering);
    if matches!(course, Course::Hop(..)) {
        craft = craft.with_load(Ground::under(vehicle));
        state = RigidState::at_rest(start, 0.0);
    }
    let mut source = Source::new(case.noise.map_or(0, |noise| noise.seed));
    let mut on_their_way = VecDeque::from(vec![state.thrusts_n; case.late_steps]);

    let whole = (course.duration_s() * f64::from(STEPS_HZ)).round() as i32;
    let mut flown = FlightErrors { iae: Some(0.0), max_error_m: 0.0, end_error_m: 0.0, max_tilt_deg: 0.0 };
    for step in -lead_in_steps..recorded.map_or(whole + 1, |recorded| recorded.steps as i32) {
        match recorded {
            Some(Recorded { steps, then: Some(table) }) if step == (steps / 2) as i32 => firmware.ask_for(table),
            _ => {}
        }
        let t_s = at_s(step);
        firmware.command(course, t_s, case.setpoints);
        let error_m = (state.position_m - course.position_m(t_s).unwrap_or(start)).norm();
        if !state.is_finite() || error_m > LOST_M {
            return FlightErrors { iae: None, ..flown };
        }
        if step >= 0 {
            if step % SAMPLE_STEPS == 0 {
                flown.iae = flown.iae.map(|iae| iae + error_m * at_s(SAMPLE_STEPS));
            }
            flown.max_error_m = flown.max_error_m.max(error_m);
            flown.end_error_m = error_m;
            flown.max_tilt_deg = flown.max_tilt_deg.max(state.thrust_axis().z.clamp(-1.0, 1.0).acos().to_degrees());
        }
        let measured = case.noise.map_or(state, |noise| source.measured(&state, &noise));
        on_their_way.push_back(firmware.step(&measured, None));
        let commands_n = on_their_way.pop_front().unwrap_or_default();
        state = craft.hold(&state, &commands_n, t_s, 1.0 / f64::from(STEPS_HZ));
    }
    flown
}

/// The state that flies a point of a course: attitude, body rates and forces from its derivatives.
fn on_course(point: &FifthOrder, vehicle: &Vehicle) -> Option<RigidState> {
    let airframe = motor_loop::airframe(vehicle, vehicle.motors().lag_s).ok()?;
    motor_loop::state_on(point, &airframe).ok()
}
