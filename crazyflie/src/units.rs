//! The firmware's units, signs and orders in, SI out, and back. Nothing else converts.
//!
//! Degrees become radians, the scalar of a quaternion comes first, pitch changes its sign, the angle and in manual flight
//! the rate (the gyroscope's does not), g become m/s^2. A yaw angle becomes a heading: the same at hover; the firmware's own
//! trajectories bend away from it as they tilt, Z-X-Y, by less than a degree below 15 degrees.

use quatrack::flatness::GRAVITY_M_S2;
use quatrack::math::{sin_cos, sqrt};
use quatrack::nalgebra::Vector3;
use quatrack::{Heading, Quaternion, State};

use crate::abi;
use crate::craft::Craft;
use crate::motion::Motion;
use crate::output::Output;

pub(crate) const RAD_PER_DEG: f32 = core::f32::consts::PI / 180.0;

/// Largest rate of a heading that is followed, rad/s: as fast as a Crazyflie turns.
pub(crate) const HEADING_RATE_MAX_RAD_S: f32 = 5.0;

/// The estimate.
#[inline(always)]
pub fn state(state: &abi::State) -> State {
    State {
        position_m: vector(&state.position),
        attitude: quaternion(&state.attitude_quaternion),
        velocity_m_s: vector(&state.velocity),
    }
}

/// Body rates that the gyroscope measures, rad/s.
#[inline(always)]
pub fn body_rates_rad_s(sensors: &abi::SensorData) -> Vector3<f32> {
    let [x, y, z] = sensors.gyro;
    Vector3::new(x * RAD_PER_DEG, y * RAD_PER_DEG, z * RAD_PER_DEG)
}

/// Specific force that the accelerometer measures, m/s^2; nothing where it has measured nothing yet: on a craft that flies or
/// stands it is never zero.
#[inline(always)]
pub fn specific_force_m_s2(sensors: &abi::SensorData) -> Option<Vector3<f32>> {
    let [x, y, z] = sensors.acc;
    (x != 0.0 || y != 0.0 || z != 0.0).then(|| Vector3::new(x * GRAVITY_M_S2, y * GRAVITY_M_S2, z * GRAVITY_M_S2))
}

/// Position and its derivatives in a setpoint.
#[inline(always)]
pub fn motion(setpoint: &abi::Setpoint) -> Motion {
    Motion {
        position_m: vector(&setpoint.position),
        velocity_m_s: vector(&setpoint.velocity),
        acceleration_m_s2: vector(&setpoint.acceleration),
        jerk_m_s3: vector(&setpoint.jerk),
    }
}

/// The direction of the thrust, in the heading frame, at the angles of a setpoint.
pub fn thrust_axis_of_angles(attitude: &abi::Attitude) -> Vector3<f32> {
    let (sin_roll, cos_roll) = sin_cos(attitude.roll * RAD_PER_DEG);
    let (sin_pitch, cos_pitch) = sin_cos(-attitude.pitch * RAD_PER_DEG);
    Vector3::new(sin_pitch * cos_roll, -sin_roll, cos_pitch * cos_roll)
}

/// The same of an attitude.
pub fn thrust_axis_of_quaternion(attitude: &abi::Quaternion) -> Vector3<f32> {
    let q = quaternion(attitude);
    let heading = Quaternion::new(q.w, 0.0, 0.0, -q.z);
    let norm_squared = q.w * q.w + q.z * q.z;
    (heading * q * Quaternion::new(0.0, 0.0, 0.0, 1.0) * q.conjugate() * heading.conjugate()).vector() / norm_squared
}

/// The heading of an angle of yaw, degrees, that may have turned often.
#[inline(always)]
pub fn heading_of_yaw(yaw_deg: f32) -> Heading {
    // Whole turns of 360 degrees are exact, and so is the remainder. Two of them give the same quaternion.
    let turns = (yaw_deg * (1.0 / 720.0)) as i32;
    Heading::from_angle((yaw_deg - turns as f32 * 720.0) * RAD_PER_DEG)
}

/// The heading of an attitude.
#[inline(always)]
pub fn heading_of_quaternion(q: &abi::Quaternion) -> Heading {
    Heading::from_half(q.w, q.z)
}

/// Rate of the heading that goes with an angle, rad/s. Setpoints have the body rate, the heading's rate times the vertical
/// part of the thrust's direction.
#[inline(always)]
pub fn heading_rate_rad_s(setpoint: &abi::Setpoint) -> f32 {
    let body_rate = setpoint.attitude_rate.yaw * RAD_PER_DEG;
    if body_rate == 0.0 {
        return 0.0;
    }
    let a = &setpoint.acceleration;
    let h = a.z + GRAVITY_M_S2;
    let axis_z = h / sqrt(a.x * a.x + a.y * a.y + h * h);
    // Beyond 60 degrees of tilt the two have little to do with each other.
    let rate = if axis_z > 0.5 { body_rate / axis_z } else { body_rate };
    // A NaN stays one.
    if rate.abs() > HEADING_RATE_MAX_RAD_S { HEADING_RATE_MAX_RAD_S.copysign(rate) } else { rate }
}

/// The heading of an attitude `q_tilt q_z(psi)`, rad, within a turn.
pub fn heading_rad(q: &Quaternion) -> f32 {
    2.0 * libm::atan2f(q.z, q.w)
}

#[inline(always)]
fn vector(v: &abi::Vector) -> Vector3<f32> {
    Vector3::new(v.x, v.y, v.z)
}

#[inline(always)]
fn quaternion(q: &abi::Quaternion) -> Quaternion {
    Quaternion::new(q.w, q.x, q.y, q.z)
}

/// An output as the firmware takes it: forces over the largest of a motor.
#[inline]
pub fn put(output: &Output, craft: &Craft, control: &mut abi::Control) {
    match output {
        Output::Wrench(wrench) => {
            let torque = &wrench.torque_n_m;
            control.payload = [wrench.thrust_n, torque.x, torque.y, torque.z];
            control.control_mode = abi::Control::FORCE_TORQUE;
        }
        Output::Forces([f1, f2, f3, f4]) => {
            let scale = craft.per_force_max_1_n;
            control.payload = [f1 * scale, f2 * scale, f3 * scale, f4 * scale];
            control.control_mode = abi::Control::FORCE;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_yaw_goes_on_for_hundreds_of_turns() {
        for turns in [0_i16, 1, -1, 299, 300, -300, 1000] {
            let (cos, sin) = heading_of_yaw(f32::from(turns) * 360.0 + 60.0).cos_sin();
            // Some roundings of a cosine; 360,060 degrees are rounded to 1/32.
            assert!((cos - 0.5).abs() < 1e-6 && (sin - 0.866_025_4).abs() < 1e-6, "{turns}: {cos} {sin}");
        }
    }

    #[test]
    fn a_rate_of_yaw_that_is_no_number_stays_so() {
        let mut setpoint = abi::Setpoint::OFF;
        setpoint.attitude_rate.yaw = f32::NAN;
        assert!(heading_rate_rad_s(&setpoint).is_nan());
        setpoint.attitude_rate.yaw = 1e6;
        assert_eq!(heading_rate_rad_s(&setpoint), HEADING_RATE_MAX_RAD_S);
    }

    #[test]
    fn an_accelerometer_that_has_measured_nothing_gives_nothing() {
        let mut sensors = abi::SensorData::default();
        assert_eq!(specific_force_m_s2(&sensors), None);
        sensors.acc = [0.0, 0.0, 1.0];
        assert_eq!(specific_force_m_s2(&sensors), Some(Vector3::new(0.0, 0.0, GRAVITY_M_S2)));
    }
}
