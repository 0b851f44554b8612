//! The edge: the firmware's units, signs and orders in, SI out. Nothing else converts.
//!
//! Degrees become radians, the scalar of a quaternion comes first, the angle of pitch changes its sign (rates do not), a
//! thrust of 65535 becomes what four motors can do. A yaw angle becomes a heading: the same at hover; the firmware's own
//! trajectories bend away from it as they tilt, Z-X-Y, by less than a degree below 15 degrees.

use quatrack::flatness::GRAVITY_M_S2;
use quatrack::math::{sin_cos, sqrt};
use quatrack::nalgebra::Vector3;
use quatrack::{Heading, Quaternion, State};

use crate::abi::{self, Mode};
use crate::control::Output;
use crate::craft::Craft;
use crate::demand::{Demand, Flight, Horizontal, Motion, Turn, Vertical};

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
            (Mode::ABSOLUTE, Mode::ABSOLUTE, Mode::DISABLED) => {
                let (sin_roll, cos_roll) = sin_cos(setpoint.attitude.roll * RAD_PER_DEG);
                let (sin_pitch, cos_pitch) = sin_cos(-setpoint.attitude.pitch * RAD_PER_DEG);
                Some(Horizontal::Tilt(Vector3::new(sin_pitch * cos_roll, -sin_roll, cos_pitch * cos_roll)))
            }
            (Mode::VELOCITY, Mode::VELOCITY, Mode::DISABLED) => {
                let rate = &setpoint.attitude_rate;
                Some(Horizontal::Rates([rate.roll * RAD_PER_DEG, rate.pitch * RAD_PER_DEG]))
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

/// Moves on the heading of a flight along a trajectory, as one more setpoint of it asks after one that was kept; gives the
/// rate that goes with it, rad/s. Nothing where the setpoint is of another kind, or a number that counts makes no sense.
#[inline(always)]
pub fn turn_on(heading: &mut Heading, kept: &abi::Setpoint, setpoint: &abi::Setpoint) -> Option<f32> {
    if setpoint.timestamp == 0 || is_urgent(kept, setpoint) {
        return None;
    }
    let rate = heading_rate_rad_s(setpoint);
    let is_by_yaw = kept.mode.yaw == Mode::ABSOLUTE;
    let heading_sum = if is_by_yaw && kept.attitude.yaw.to_bits() == setpoint.attitude.yaw.to_bits() {
        // Most flights do not turn.
        0.0
    } else {
        *heading = self::heading(setpoint)?;
        let (cos, sin) = heading.cos_sin();
        cos + sin
    };
    is_sound(motion_sum(setpoint) + rate + heading_sum).then_some(rate)
}

/// And the sum of the figures that it is made of, finite only if all of them are.
#[inline]
fn turn(setpoint: &abi::Setpoint) -> Option<(Turn, f32)> {
    match (setpoint.mode.quat, setpoint.mode.yaw) {
        (Mode::DISABLED, Mode::VELOCITY) => {
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

/// The heading that a setpoint asks for by its attitude or its angle of yaw.
#[inline(always)]
fn heading(setpoint: &abi::Setpoint) -> Option<Heading> {
    match (setpoint.mode.quat, setpoint.mode.yaw) {
        (Mode::ABSOLUTE, Mode::DISABLED) => {
            let q = &setpoint.attitude_quaternion;
            Some(Heading::from_half(q.w, q.z))
        }
        (Mode::DISABLED, Mode::ABSOLUTE) => {
            let heading_rad = setpoint.attitude.yaw * RAD_PER_DEG;
            (heading_rad.abs() <= HEADING_MAX_RAD).then(|| Heading::from_angle(heading_rad))
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

/// Whether a setpoint is of another kind than the one before: not to be put off.
#[inline]
pub fn is_urgent(before: &abi::Setpoint, setpoint: &abi::Setpoint) -> bool {
    words(before) != words(setpoint)
}

/// Whether two setpoints ask for the same, the first as [`keep`] has kept it.
///
/// The commander stamps every setpoint that it takes: one with the same stamp can differ only in what supervisor and
/// collision avoidance change, modes, position and velocity. Without a stamp all of it is looked at.
#[inline]
pub fn is_same(a: &abi::Setpoint, b: &abi::Setpoint) -> bool {
    if a.timestamp != b.timestamp {
        return false;
    }
    if b.timestamp == 0 {
        return is_all_the_same(a, b);
    }
    let vectors = |a: &abi::Vector, b: &abi::Vector| {
        ((a.x.to_bits() ^ b.x.to_bits()) | (a.y.to_bits() ^ b.y.to_bits()) | (a.z.to_bits() ^ b.z.to_bits())) == 0
    };
    words(a) == words(b) && vectors(&a.position, &b.position) && vectors(&a.velocity, &b.velocity)
}

/// The same while a trajectory is flown, whose last setpoint was kept by [`keep_on`] and had this motion.
#[inline(always)]
pub fn is_same_along(a: &abi::Setpoint, motion: &Motion, b: &abi::Setpoint) -> bool {
    if b.timestamp == 0 {
        return is_same(a, b);
    }
    let vectors = |a: &Vector3<f32>, b: &abi::Vector| {
        ((a.x.to_bits() ^ b.x.to_bits()) | (a.y.to_bits() ^ b.y.to_bits()) | (a.z.to_bits() ^ b.z.to_bits())) == 0
    };
    a.timestamp == b.timestamp
        && words(a) == words(b)
        && vectors(&motion.position_m, &b.position)
        && vectors(&motion.velocity_m_s, &b.velocity)
}

/// Keeps of a setpoint what [`is_same`] and [`is_urgent`] look at.
#[inline]
pub fn keep(kept: &mut abi::Setpoint, setpoint: &abi::Setpoint) {
    *kept = *setpoint;
}

/// Keeps of one more setpoint along a trajectory what is not in its motion.
#[inline(always)]
pub fn keep_on(kept: &mut abi::Setpoint, setpoint: &abi::Setpoint) {
    kept.timestamp = setpoint.timestamp;
    kept.attitude.yaw = setpoint.attitude.yaw;
}

#[inline(never)]
fn is_all_the_same(a: &abi::Setpoint, b: &abi::Setpoint) -> bool {
    let vectors = |a: &abi::Vector, b: &abi::Vector| {
        a.x.to_bits() == b.x.to_bits() && a.y.to_bits() == b.y.to_bits() && a.z.to_bits() == b.z.to_bits()
    };
    let angles = |a: &abi::Attitude, b: &abi::Attitude| {
        a.roll.to_bits() == b.roll.to_bits()
            && a.pitch.to_bits() == b.pitch.to_bits()
            && a.yaw.to_bits() == b.yaw.to_bits()
    };
    let (p, q) = (&a.attitude_quaternion, &b.attitude_quaternion);
    vectors(&a.position, &b.position)
        && vectors(&a.velocity, &b.velocity)
        && vectors(&a.acceleration, &b.acceleration)
        && vectors(&a.jerk, &b.jerk)
        && angles(&a.attitude, &b.attitude)
        && angles(&a.attitude_rate, &b.attitude_rate)
        && p.x.to_bits() == q.x.to_bits()
        && p.y.to_bits() == q.y.to_bits()
        && p.z.to_bits() == q.z.to_bits()
        && p.w.to_bits() == q.w.to_bits()
        && a.thrust.to_bits() == b.thrust.to_bits()
        && words(a) == words(b)
}

/// Modes and the frame of the velocity, as two words of the target.
#[inline]
#[allow(clippy::unnecessary_cast, reason = "an enum is four bytes where enums are not short")]
fn words(setpoint: &abi::Setpoint) -> [u32; 2] {
    let abi::Modes { x, y, z, roll, pitch, yaw, quat } = &setpoint.mode;
    let word = |bytes: [u8; 4]| u32::from_ne_bytes(bytes);
    [
        word([setpoint.velocity_body, x.0 as u8, y.0 as u8, z.0 as u8]),
        word([roll.0 as u8, pitch.0 as u8, yaw.0 as u8, quat.0 as u8]),
    ]
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
