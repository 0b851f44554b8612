//! From a C setpoint to a request: it is taken if its modes make sense together and the figures that count are finite.

use quatrack::Heading;

use crate::abi::{self, Mode};
use crate::request::{Horizontal, Request, Turn, Vertical};
use crate::units::{self, RAD_PER_DEG};

/// The figure of full thrust.
const THRUST_MAX: f32 = 65_535.0;

/// Thrust below which a manual setpoint means motors off, as with the firmware's own controllers.
const THRUST_OFF: f32 = 1_000.0;

/// Largest size of the sum of a setpoint's figures: a kilometre and more, with room to carry it on by its
/// derivatives for a while.
const SUM_MAX: f32 = 1e6;

/// A setpoint taken apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Parsed {
    /// Motors off.
    Off,
    /// It makes no sense.
    Bad,
    /// To be flown.
    Fly(Request),
}

/// A heading and its rate, rad/s.
pub(super) type Headed = (Heading, f32);

/// Takes a setpoint apart.
pub(super) fn parse(setpoint: &abi::Setpoint) -> Parsed {
    let mode = &setpoint.mode;
    if *mode == abi::Modes::default() {
        return Parsed::Off;
    }
    let vertical = match mode.z {
        Mode::DISABLED => Vertical::Thrust(setpoint.thrust / THRUST_MAX),
        Mode::ABSOLUTE => Vertical::Position,
        Mode::VELOCITY => Vertical::Velocity,
        _ => return Parsed::Bad,
    };
    let (Some(turn), Some(horizontal)) = (turn(setpoint), horizontal(setpoint)) else { return Parsed::Bad };
    let counting = match &horizontal {
        Horizontal::Tilt(axis) => axis.x + axis.y,
        Horizontal::Rates([p, q]) => p + q,
        _ => 0.0,
    };
    let turning = match turn {
        Turn::Rate(rate) => rate,
        Turn::Heading => 0.0,
    };
    if !(is_sound(counting + turning + sum(setpoint)) && (turn != Turn::Heading || headed(setpoint).is_some())) {
        return Parsed::Bad;
    }
    if matches!(vertical, Vertical::Thrust(_)) && setpoint.thrust < THRUST_OFF {
        return Parsed::Off;
    }
    Parsed::Fly(Request { horizontal, vertical, turn })
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
                Some(Horizontal::Tilt(units::thrust_axis_of_angles(&setpoint.attitude)))
            }
            (Mode::VELOCITY, Mode::VELOCITY, Mode::DISABLED | Mode::ABSOLUTE) => {
                let rate = &setpoint.attitude_rate;
                Some(Horizontal::Rates([rate.roll * RAD_PER_DEG, -rate.pitch * RAD_PER_DEG]))
            }
            (Mode::DISABLED, Mode::DISABLED, Mode::ABSOLUTE) => {
                Some(Horizontal::Tilt(units::thrust_axis_of_quaternion(&setpoint.attitude_quaternion)))
            }
            _ => None,
        },
        _ => None,
    }
}

/// The request of a setpoint for the heading.
fn turn(setpoint: &abi::Setpoint) -> Option<Turn> {
    match (setpoint.mode.yaw, setpoint.mode.quat) {
        (Mode::VELOCITY, Mode::DISABLED | Mode::ABSOLUTE) => Some(Turn::Rate(setpoint.attitude_rate.yaw * RAD_PER_DEG)),
        (Mode::DISABLED, Mode::DISABLED) => Some(Turn::Rate(0.0)),
        (Mode::ABSOLUTE, Mode::DISABLED | Mode::ABSOLUTE) | (Mode::DISABLED, Mode::ABSOLUTE) => Some(Turn::Heading),
        _ => None,
    }
}

/// The heading that a setpoint asks for by its angle of yaw, else by its attitude, and its rate; nothing where they make no
/// sense.
#[inline(never)]
pub(super) fn headed(setpoint: &abi::Setpoint) -> Option<Headed> {
    let rate = units::heading_rate_rad_s(setpoint);
    if is_by_yaw(setpoint) {
        let yaw_deg = setpoint.attitude.yaw;
        return is_sound(yaw_deg + rate).then(|| (units::heading_of_yaw(yaw_deg), rate));
    }
    let heading = units::heading_of_quaternion(&setpoint.attitude_quaternion);
    let (cos, sin) = heading.cos_sin();
    is_sound(cos + sin + rate).then_some((heading, rate))
}

/// Whether a heading is asked for by an angle of yaw: the commander on board does so, scripts on the ground send an
/// attitude.
#[inline(always)]
pub(super) fn is_by_yaw(setpoint: &abi::Setpoint) -> bool {
    setpoint.mode.yaw == Mode::ABSOLUTE
}

/// Whether all figures of a setpoint are numbers that make sense, those too that it does not ask for.
#[inline(always)]
pub(super) fn has_sound_figures(setpoint: &abi::Setpoint) -> bool {
    is_sound(sum(setpoint))
}

/// Whether figures that add up to this are finite.
#[inline(always)]
fn is_sound(sum: f32) -> bool {
    sum.abs() <= SUM_MAX
}

/// Sum of all figures: finite only if all of them are.
#[inline(always)]
fn sum(setpoint: &abi::Setpoint) -> f32 {
    let vector = |v: &abi::Vector| v.x + v.y + v.z;
    let angles = |a: &abi::Attitude| a.roll + a.pitch + a.yaw;
    let q = &setpoint.attitude_quaternion;
    setpoint.thrust
        + vector(&setpoint.position)
        + vector(&setpoint.velocity)
        + vector(&setpoint.acceleration)
        + vector(&setpoint.jerk)
        + angles(&setpoint.attitude)
        + angles(&setpoint.attitude_rate)
        + (q.x + q.y + q.z + q.w)
}
