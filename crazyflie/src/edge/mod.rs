//! The edge: the firmware's units, signs and orders in, SI out. Nothing else converts.
//!
//! Degrees become radians, the scalar of a quaternion comes first, pitch changes its sign, the angle and in manual flight
//! the rate (the gyroscope's does not), a thrust of 65535 becomes what four motors can do. A yaw angle becomes a heading:
//! the same at hover; the firmware's own trajectories bend away from it as they tilt, Z-X-Y, by less than a degree below
//! 15 degrees.

mod sameness;

use quatrack::flatness::GRAVITY_M_S2;
use quatrack::math::{sin_cos, sqrt};
use quatrack::nalgebra::Vector3;
use quatrack::{Heading, Quaternion, State};

pub use self::sameness::{is_same, is_same_along, is_urgent};
use crate::abi::{self, Mode};
use crate::craft::Craft;
use crate::demand::{Demand, Flight, Horizontal, Motion, Turn, Vertical};
use crate::output::Output;

const RAD_PER_DEG: f32 = core::f32::consts::PI / 180.0;

/// What stands for all of the thrust.
const THRUST_MAX: f32 = 65_535.0;

/// Thrust below which a manual setpoint means motors off, as with the firmware's own controllers.
const THRUST_OFF: f32 = 1_000.0;

/// Largest rate of a heading that is followed, rad/s: as fast as a Crazyflie turns.
const HEADING_RATE_MAX_RAD_S: f32 = 5.0;

/// Largest size of what the figures of a setpoint add up to: a kilometre and more, with room to carry it on by its
/// derivatives for a while.
const SUM_MAX: f32 = 1e6;

/// Largest heading, rad: beyond it the sine loses digits.
const HEADING_MAX_RAD: f32 = 2_000.0;

/// The estimate.
pub fn state(state: &abi::State) -> State {
    State {
        position_m: vector(&state.position),
        attitude: quaternion(&state.attitude_quaternion),
        velocity_m_s: vector(&state.velocity),
    }
}

/// Body rates that the gyroscope measures, rad/s.
pub fn body_rates_rad_s(sensors: &abi::SensorData) -> Vector3<f32> {
    let [x, y, z] = sensors.gyro;
    Vector3::new(x * RAD_PER_DEG, y * RAD_PER_DEG, z * RAD_PER_DEG)
}

/// Position and its derivatives in a setpoint.
pub fn motion(setpoint: &abi::Setpoint) -> Motion {
    Motion {
        position_m: vector(&setpoint.position),
        velocity_m_s: vector(&setpoint.velocity),
        acceleration_m_s2: vector(&setpoint.acceleration),
        jerk_m_s3: vector(&setpoint.jerk),
    }
}

/// What a setpoint asks of a craft whose four motors push with `thrust_max_n` at most; nothing where its modes make no
/// sense together or a number that counts is not finite.
pub fn demand(setpoint: &abi::Setpoint, thrust_max_n: f32) -> Option<Demand> {
    let mode = &setpoint.mode;
    if *mode == abi::Modes::default() {
        return Some(Demand::Off);
    }
    let vertical = match mode.z {
        Mode::DISABLED => Vertical::Thrust(setpoint.thrust / THRUST_MAX * thrust_max_n),
        Mode::ABSOLUTE => Vertical::Position,
        Mode::VELOCITY => Vertical::Velocity,
        _ => return None,
    };
    let (turn, turn_sum) = turn(setpoint)?;
    let horizontal = horizontal(setpoint)?;
    let counting = match (&horizontal, vertical) {
        (Horizontal::Tilt(axis), _) => axis.x + axis.y,
        (Horizontal::Rates([p, q]), _) => p + q,
        _ => 0.0,
    } + motion_sum(setpoint)
        + turn_sum;
    if !is_sound(counting) {
        return None;
    }
    if matches!(vertical, Vertical::Thrust(_)) && setpoint.thrust < THRUST_OFF {
        return Some(Demand::Off);
    }
    Some(Demand::Fly(Flight { horizontal, vertical, turn }))
}

fn horizontal(setpoint: &abi::Setpoint) -> Option<Horizontal> {
    let mode = &setpoint.mode;
    match (mode.x, mode.y) {
        (Mode::ABSOLUTE, Mode::ABSOLUTE) => Some(Horizontal::Position),
        (Mode::VELOCITY, Mode::VELOCITY) => {
            Some(Horizontal::Velocity { in_heading_frame: setpoint.velocity_body != 0 })
        }
        (Mode::DISABLED, Mode::DISABLED) => match (mode.roll, mode.pitch, mode.quat) {
            // A quaternion may be left over from an earlier setpoint: the firmware, too, looks at angles and rates first.
            (Mode::ABSOLUTE, Mode::ABSOLUTE, Mode::DISABLED | Mode::ABSOLUTE) => {
                let (sin_roll, cos_roll) = sin_cos(setpoint.attitude.roll * RAD_PER_DEG);
                let (sin_pitch, cos_pitch) = sin_cos(-setpoint.attitude.pitch * RAD_PER_DEG);
                Some(Horizontal::Tilt(Vector3::new(sin_pitch * cos_roll, -sin_roll, cos_pitch * cos_roll)))
            }
            (Mode::VELOCITY, Mode::VELOCITY, Mode::DISABLED | Mode::ABSOLUTE) => {
                let rate = &setpoint.attitude_rate;
                Some(Horizontal::Rates([rate.roll * RAD_PER_DEG, -rate.pitch * RAD_PER_DEG]))
            }
            (Mode::DISABLED, Mode::DISABLED, Mode::ABSOLUTE) => {
                let q = quaternion(&setpoint.attitude_quaternion);
                let heading = Quaternion::new(q.w, 0.0, 0.0, -q.z);
                let norm_squared = q.w * q.w + q.z * q.z;
                let axis = (heading * q * Quaternion::new(0.0, 0.0, 0.0, 1.0) * q.conjugate() * heading.conjugate())
                    .vector()
                    / norm_squared;
                Some(Horizontal::Tilt(axis))
            }
            _ => None,
        },
        _ => None,
    }
}

/// Whether a setpoint continues a flight along a trajectory whose last one was kept: of the same kind, with a motion that
/// makes sense.
#[inline(always)]
pub fn goes_on(kept: &abi::Setpoint, setpoint: &abi::Setpoint) -> bool {
    setpoint.timestamp != 0 && !is_urgent(kept, setpoint) && is_sound(motion_sum(setpoint))
}

/// Moves on the heading of a flight along a trajectory, as a setpoint that continues it asks; gives the rate that goes with
/// it, rad/s. Nothing where it makes no sense.
#[inline(always)]
pub fn turn_on(heading: &mut Heading, kept: &abi::Setpoint, setpoint: &abi::Setpoint) -> Option<f32> {
    let rate = heading_rate_rad_s(setpoint);
    if is_by_yaw(kept) && kept.attitude.yaw.to_bits() == setpoint.attitude.yaw.to_bits() {
        // Most flights do not turn.
        return is_sound(rate).then_some(rate);
    }
    *heading = self::heading(setpoint)?;
    let (cos, sin) = heading.cos_sin();
    is_sound(cos + sin + rate).then_some(rate)
}

/// Whether a heading is asked for by an angle of yaw: the commander on board does so, scripts on the ground send an
/// attitude.
#[inline(always)]
pub fn is_by_yaw(setpoint: &abi::Setpoint) -> bool {
    setpoint.mode.yaw == Mode::ABSOLUTE
}

/// How a setpoint asks to turn, and the sum of the figures that this is made of, finite only if all of them are.
#[inline]
fn turn(setpoint: &abi::Setpoint) -> Option<(Turn, f32)> {
    match (setpoint.mode.yaw, setpoint.mode.quat) {
        (Mode::VELOCITY, Mode::DISABLED | Mode::ABSOLUTE) => {
            let rate = setpoint.attitude_rate.yaw * RAD_PER_DEG;
            Some((Turn::Rate(rate), rate))
        }
        (Mode::DISABLED, Mode::DISABLED) => Some((Turn::Rate(0.0), 0.0)),
        _ => {
            let heading = heading(setpoint)?;
            let (cos, sin) = heading.cos_sin();
            let rate_rad_s = heading_rate_rad_s(setpoint);
            Some((Turn::Heading { heading, rate_rad_s }, cos + sin + rate_rad_s))
        }
    }
}

/// The heading that a setpoint asks for by its angle of yaw, else by its attitude.
#[inline(always)]
fn heading(setpoint: &abi::Setpoint) -> Option<Heading> {
    match (setpoint.mode.yaw, setpoint.mode.quat) {
        (Mode::ABSOLUTE, Mode::DISABLED | Mode::ABSOLUTE) => {
            let heading_rad = setpoint.attitude.yaw * RAD_PER_DEG;
            (heading_rad.abs() <= HEADING_MAX_RAD).then(|| Heading::from_angle(heading_rad))
        }
        (Mode::DISABLED, Mode::ABSOLUTE) => {
            let q = &setpoint.attitude_quaternion;
            Some(Heading::from_half(q.w, q.z))
        }
        _ => None,
    }
}

/// Rate of the heading that goes with an angle, rad/s. Setpoints have the body rate, the heading's rate times the vertical
/// part of the thrust's direction.
#[inline(always)]
fn heading_rate_rad_s(setpoint: &abi::Setpoint) -> f32 {
    let body_rate = setpoint.attitude_rate.yaw * RAD_PER_DEG;
    if body_rate == 0.0 {
        return 0.0;
    }
    let a = &setpoint.acceleration;
    let h = a.z + GRAVITY_M_S2;
    let axis_z = h / sqrt(a.x * a.x + a.y * a.y + h * h);
    // Beyond 60 degrees of tilt the two have little to do with each other.
    let rate = if axis_z > 0.5 { body_rate / axis_z } else { body_rate };
    if rate.abs() <= HEADING_RATE_MAX_RAD_S { rate } else { HEADING_RATE_MAX_RAD_S.copysign(rate) }
}

/// Whether figures that add up to this are finite.
#[inline(always)]
fn is_sound(sum: f32) -> bool {
    sum.abs() <= SUM_MAX
}

/// Sum of the figures of a motion and of the thrust: finite only if all of them are.
#[inline]
fn motion_sum(setpoint: &abi::Setpoint) -> f32 {
    setpoint.thrust
        + sum(&setpoint.position)
        + sum(&setpoint.velocity)
        + sum(&setpoint.acceleration)
        + sum(&setpoint.jerk)
}

/// The heading of an attitude `q_tilt q_z(psi)`, rad, within a turn.
pub fn heading_rad(q: &Quaternion) -> f32 {
    2.0 * libm::atan2f(q.z, q.w)
}

fn vector(v: &abi::Vector) -> Vector3<f32> {
    Vector3::new(v.x, v.y, v.z)
}

fn quaternion(q: &abi::Quaternion) -> Quaternion {
    Quaternion::new(q.w, q.x, q.y, q.z)
}

fn sum(v: &abi::Vector) -> f32 {
    v.x + v.y + v.z
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
