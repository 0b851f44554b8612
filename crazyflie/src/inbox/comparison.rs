//! Setpoint comparison: whether two are of one kind, and whether they ask for the same.

use crate::abi;

/// Whether a setpoint is of another kind than the one before.
#[inline(always)]
pub(super) fn is_another_kind(before: &abi::Setpoint, setpoint: &abi::Setpoint) -> bool {
    words(before) != words(setpoint)
}

/// Whether two setpoints ask for the same.
///
/// The commander stamps every setpoint that it takes: one with the same stamp can differ only in the fields that the
/// supervisor, when it levels the craft, and collision avoidance change, and in the thrust, of which two may come within
/// a millisecond. Without a stamp all of it is looked at.
#[inline(always)]
pub(super) fn is_same(a: &abi::Setpoint, b: &abi::Setpoint) -> bool {
    if a.timestamp != b.timestamp {
        return false;
    }
    if b.timestamp == 0 {
        return is_all_the_same(a, b);
    }
    let vectors = |a: &abi::Vector, b: &abi::Vector| {
        ((a.x.to_bits() ^ b.x.to_bits()) | (a.y.to_bits() ^ b.y.to_bits()) | (a.z.to_bits() ^ b.z.to_bits())) == 0
    };
    words(a) == words(b)
        && vectors(&a.position, &b.position)
        && vectors(&a.velocity, &b.velocity)
        && a.attitude.roll.to_bits() == b.attitude.roll.to_bits()
        && a.attitude.pitch.to_bits() == b.attitude.pitch.to_bits()
        && a.attitude_rate.yaw.to_bits() == b.attitude_rate.yaw.to_bits()
        && a.thrust.to_bits() == b.thrust.to_bits()
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
#[inline(always)]
#[allow(clippy::unnecessary_cast, reason = "an enum is four bytes where enums are not short")]
fn words(setpoint: &abi::Setpoint) -> [u32; 2] {
    let abi::Modes { x, y, z, roll, pitch, yaw, quat } = &setpoint.mode;
    let word = |bytes: [u8; 4]| u32::from_ne_bytes(bytes);
    [
        word([setpoint.velocity_body, x.0 as u8, y.0 as u8, z.0 as u8]),
        word([roll.0 as u8, pitch.0 as u8, yaw.0 as u8, quat.0 as u8]),
    ]
}
