//! One flight: a course, a craft and what is wrong with it in; how far it strayed out.

use nalgebra::{Quaternion, UnitQuaternion, Vector3, Vector4};
use quatrack::{Airframe, AirframeFigures, FifthOrderSample, FlatSample, MotorReference};
use serde::Serialize;

use super::course::{Course, Motion};
use super::firmware::{Firmware, STEPS_HZ, Sensors, Setpoints, Tune};
use super::recording::Recording;
use crate::plant::{Craft, Ground, RigidState};
use crate::vehicle::Vehicle;

/// Farther than this from its course a craft counts as lost, m.
const LOST_M: f64 = 5.0;

/// Steps between two samples of the error: 100 Hz.
const SAMPLE_STEPS: u32 = 10;

/// What is not as the controller thinks, and how it is spoken to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// True lag of the motors, s.
    pub lag_s: f64,
    /// True mass over the assumed one.
    pub mass_factor: f64,
    /// Sensors.
    pub sensors: Sensors,
    /// How setpoints come.
    pub setpoints: Setpoints,
}

/// How a flight went.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Flown {
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
pub fn fly(vehicle: &Vehicle, course: &Course, tune: &Tune, case: &Case) -> Flown {
    let mut firmware = Firmware::start(vehicle, tune, case.sensors);
    fly_with(&mut firmware, vehicle, course, case, None)
}

/// Flies so many steps of a course and keeps what passed between firmware and controller.
pub fn fly_recorded(vehicle: &Vehicle, course: &Course, tune: &Tune, case: &Case, steps: usize) -> Recording {
    let mut firmware = Firmware::start_recorded(vehicle, tune, case.sensors);
    fly_with(&mut firmware, vehicle, course, case, Some(steps as u32));
    firmware.recorded().unwrap_or_default()
}

fn fly_with(firmware: &mut Firmware, vehicle: &Vehicle, course: &Course, case: &Case, limit: Option<u32>) -> Flown {
    let mut craft = Craft::new(vehicle);
    craft.body = craft.body.scaled(case.mass_factor, 1.0);
    craft.motors = craft.motors.with_lag(case.lag_s, case.lag_s);
    let start = course.at(0.0).unwrap_or([Vector3::zeros(); 4]);
    let hovering = RigidState::at_rest(start[0], vehicle.hover_thrust_n());
    let mut state = on_course(&start, vehicle).unwrap_or(hovering);
    if matches!(course, Course::Hop(..)) {
        craft = craft.with_load(Ground::under(vehicle));
        state = RigidState::at_rest(start[0], 0.0);
    }

    let whole = (course.duration_s() * f64::from(STEPS_HZ)).round() as u32;
    let mut flown = Flown { iae: Some(0.0), max_error_m: 0.0, end_error_m: 0.0, max_tilt_deg: 0.0 };
    for step in 0..limit.unwrap_or(whole + 1) {
        let t_s = f64::from(step) / f64::from(STEPS_HZ);
        firmware.command(course, t_s, case.setpoints);
        let target = course.at(t_s).unwrap_or(start);
        let error_m = (state.position_m - target[0]).norm();
        if step % SAMPLE_STEPS == 0 {
            flown.iae = flown.iae.map(|iae| iae + error_m * f64::from(SAMPLE_STEPS) / f64::from(STEPS_HZ));
        }
        flown.max_error_m = flown.max_error_m.max(error_m);
        flown.end_error_m = error_m;
        flown.max_tilt_deg = flown.max_tilt_deg.max(state.thrust_axis().z.clamp(-1.0, 1.0).acos().to_degrees());
        if !state.is_finite() || error_m > LOST_M {
            return Flown { iae: None, ..flown };
        }
        let commands_n = firmware.step(&state, None);
        state = craft.hold(&state, &commands_n, t_s, 1.0 / f64::from(STEPS_HZ));
    }
    flown
}

/// The state that flies the start of a course: attitude, body rates and forces from its derivatives.
fn on_course([position, velocity, acceleration, jerk]: &Motion, vehicle: &Vehicle) -> Option<RigidState> {
    let single = |v: &Vector3<f64>| v.map(|c| c as f32);
    let sample = FifthOrderSample::of_jerk(FlatSample {
        position_m: single(position),
        velocity_m_s: single(velocity),
        acceleration_m_s2: single(acceleration),
        jerk_m_s3: single(jerk),
        heading_rad: 0.0,
        heading_rate_rad_s: 0.0,
    });
    let figures = Airframe::CRAZYFLIE_2_1.figures();
    let airframe = Airframe::new(AirframeFigures { mass_kg: vehicle.mass_kg() as f32, ..*figures }).ok()?;
    let reference = MotorReference::from_flat(&sample, &airframe).ok()?;
    let q = reference.state().attitude;
    let [w, x, y, z] = [q.w, q.x, q.y, q.z].map(f64::from);
    let attitude = Quaternion::new(w, x, y, z);
    Some(RigidState {
        position_m: *position,
        velocity_m_s: *velocity,
        attitude: UnitQuaternion::from_quaternion(attitude),
        body_rates_rad_s: reference.body_rates_rad_s().map(f64::from),
        thrusts_n: Vector4::from(reference.forces_n().map(f64::from)),
    })
}
