//! The mixer: a thrust and a torque in, four motor forces within their range out, with a report of each part that was
//! given up.
//!
//! Where the motors cannot do all that is asked, roll and pitch torque come first, then thrust, then yaw torque: a
//! craft that keeps its attitude can still recover height and heading. Thrust moves no further than roll and pitch
//! need; yaw keeps the range that is then left; only roll and pitch that exceed the whole range are scaled, both by the
//! same factor.

use nalgebra::Vector3;

use crate::airframe::{Airframe, AirframeFigures};
use crate::command::Limited;
use crate::motor_lag::MotorForces;

/// Thrust and torque on the body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Wrench {
    /// Force along body z, N.
    pub thrust_n: f32,
    /// Torque about body x, y, z, N m.
    pub torque_n_m: Vector3<f32>,
}

/// The limits that a step met: motors at an end of their range, parts of the wrench that the mixer gave up, and parts
/// of the law's own command that were cut before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(from = "u16", into = "u16"))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MotorLimited {
    /// Bits 0 to 3: thrust, attitude, yaw, motors; 8 to 11: the command's `T p q r`.
    bits: u16,
}

impl MotorLimited {
    /// Nothing was cut.
    pub const NOTHING: Self = Self { bits: 0 };

    const THRUST: u16 = 1;
    const ATTITUDE: u16 = 2;
    const YAW: u16 = 4;
    const MOTORS: u16 = 8;
    const ALL: u16 = 0x0F0F;

    /// Whether anything was cut.
    pub const fn any(self) -> bool {
        self.bits != 0
    }

    /// Whether commands were cut to the range of a motor one by one: those that are now at an end of it.
    pub const fn motors(self) -> bool {
        self.bits & Self::MOTORS != 0
    }

    /// Whether the mixer moved the thrust.
    pub const fn thrust(self) -> bool {
        self.bits & Self::THRUST != 0
    }

    /// Whether the mixer scaled roll and pitch torque.
    pub const fn attitude(self) -> bool {
        self.bits & Self::ATTITUDE != 0
    }

    /// Whether the mixer cut the yaw torque.
    pub const fn yaw(self) -> bool {
        self.bits & Self::YAW != 0
    }

    /// The cuts of a command of thrust and body rates.
    pub const fn command(self) -> Limited {
        Limited::from_bits((self.bits >> 8) as u8)
    }

    /// All of it; for a log or a link.
    pub const fn bits(self) -> u16 {
        self.bits
    }

    /// From [`Self::bits`]; unknown bits are dropped.
    pub const fn from_bits(bits: u16) -> Self {
        Self { bits: bits & Self::ALL }
    }

    /// The same with thrust, attitude or yaw given up.
    #[cfg(feature = "cascade")]
    pub(crate) const fn with_thrust(self) -> Self {
        Self { bits: self.bits | Self::THRUST }
    }

    #[cfg(feature = "cascade")]
    pub(crate) const fn with_attitude(self) -> Self {
        Self { bits: self.bits | Self::ATTITUDE }
    }

    #[cfg(feature = "cascade")]
    pub(crate) const fn with_yaw(self) -> Self {
        Self { bits: self.bits | Self::YAW }
    }

    /// The cuts of a command, and nothing beside.
    #[inline]
    pub const fn of_command(limited: Limited) -> Self {
        Self::NOTHING.with_command(limited)
    }

    /// The same with the cuts of a command.
    #[inline]
    pub(crate) const fn with_command(self, limited: Limited) -> Self {
        Self { bits: self.bits | (limited.bits() as u16) << 8 }
    }
}

impl From<u16> for MotorLimited {
    fn from(bits: u16) -> Self {
        Self::from_bits(bits)
    }
}

impl From<MotorLimited> for u16 {
    fn from(limited: MotorLimited) -> Self {
        limited.bits
    }
}

/// Parts of the motor forces: M1 to M4 are sums and differences of them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Parts {
    pub(crate) thrust: f32,
    pub(crate) roll: f32,
    pub(crate) pitch: f32,
    pub(crate) yaw: f32,
}

impl Parts {
    /// `[t - r - p - y, t - r + p + y, t + r + p - y, t + r - p + y]`.
    #[inline(always)]
    pub(crate) fn forces(self) -> MotorForces {
        let (right, left) = (self.thrust - self.roll, self.thrust + self.roll);
        let (with, against) = (self.pitch + self.yaw, self.pitch - self.yaw);
        [right - with, right + with, left + against, left - against]
    }

    /// Four times the parts of forces.
    #[inline(always)]
    pub(crate) fn four_times_of(forces: [f32; 4]) -> Self {
        let [f1, f2, f3, f4] = forces;
        let (right, left, across, along) = (f1 + f2, f3 + f4, f2 - f1, f3 - f4);
        Self { thrust: left + right, roll: left - right, pitch: across + along, yaw: across - along }
    }
}

impl Airframe {
    /// Motor forces for a wrench and the parts given up to stay within their range; nothing where a number of the wrench is
    /// not finite.
    #[inline]
    pub fn mix(&self, wrench: &Wrench) -> Option<(MotorForces, MotorLimited)> {
        let ([roll, pitch, yaw], torque) = (self.mixing.per_torque, &wrench.torque_n_m);
        let parts = Parts {
            thrust: 0.25 * wrench.thrust_n,
            roll: roll * torque.x,
            pitch: pitch * torque.y,
            yaw: yaw * torque.z,
        };
        let forces = parts.forces();
        let (min, max) = (self.figures().force_min_n, self.figures().force_max_n);
        // Fails for NaN.
        if is_within(forces[0], min, max)
            && is_within(forces[1], min, max)
            && is_within(forces[2], min, max)
            && is_within(forces[3], min, max)
        {
            return Some((forces, MotorLimited::NOTHING));
        }
        by_priority(parts, min, max)
    }

    /// The wrench of motor forces.
    #[inline]
    pub fn wrench(&self, forces_n: &MotorForces) -> Wrench {
        let AirframeFigures { lever_arm_m: a, torque_per_thrust_m: c, .. } = *self.figures();
        let parts = Parts::four_times_of(*forces_n);
        Wrench { thrust_n: parts.thrust, torque_n_m: Vector3::new(a * parts.roll, a * parts.pitch, c * parts.yaw) }
    }
}

#[inline(always)]
fn is_within(value: f32, min: f32, max: f32) -> bool {
    value >= min && value <= max
}

/// A value cut to `[min, max]`, which may be empty by a rounding; not NaN.
#[inline(always)]
fn cut(value: f32, min: f32, max: f32) -> f32 {
    if value > max {
        max
    } else if value < min {
        min
    } else {
        value
    }
}

/// Roll and pitch, then thrust, then yaw.
#[cold]
#[inline(never)]
fn by_priority(asked: Parts, min: f32, max: f32) -> Option<(MotorForces, MotorLimited)> {
    // Finite only if all are; large ones that add up to infinity are as little to be flown.
    let size = asked.thrust.abs() + asked.roll.abs() + asked.pitch.abs() + asked.yaw.abs();
    if !size.is_finite() {
        return None;
    }
    let mut bits = 0;
    let Parts { thrust, mut roll, mut pitch, yaw } = asked;
    let half_range = 0.5 * (max - min);
    let mut swing = roll.abs() + pitch.abs();
    if swing > half_range {
        let scale = half_range / swing;
        (roll, pitch, swing) = (roll * scale, pitch * scale, half_range);
        bits |= MotorLimited::ATTITUDE;
    }
    let shifted = cut(thrust, min + swing, max - swing);
    if shifted != thrust {
        bits |= MotorLimited::THRUST;
    }
    // M2 and M4 gain by yaw as much as M1 and M3 lose.
    let (along, across) = ((roll + pitch).abs(), (pitch - roll).abs());
    let (above, below) = (max - shifted, shifted - min);
    let most = smaller(above - across, below - along);
    let least = -smaller(above - along, below - across);
    let kept = cut(yaw, if least > 0.0 { 0.0 } else { least }, if most < 0.0 { 0.0 } else { most });
    if kept != yaw {
        bits |= MotorLimited::YAW;
    }
    let forces = Parts { thrust: shifted, roll, pitch, yaw: kept }.forces();
    // Roundings may leave a force next to the end of its range.
    Some((forces.map(|force| cut(force, min, max)), MotorLimited { bits }))
}

fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_that_just_fit_are_not_told_as_cut() {
        // Sixteenths: no sum is rounded. Roll and pitch swing by half of the range and leave the middle to the thrust.
        let (min, max) = (0.0, 1.0);
        let at_the_ends = Parts { thrust: 0.5, roll: 0.25, pitch: -0.25, yaw: 0.0 };
        assert_eq!(by_priority(at_the_ends, min, max), Some(([0.5, 0.0, 0.5, 1.0], MotorLimited::NOTHING)));
        // Yaw moves two motors up and two down, to where the first of them is at an end.
        for yaw in [0.25, -0.25] {
            let parts = Parts { thrust: 0.5, roll: 0.25, pitch: 0.0, yaw };
            let forces = [0.25 - yaw, 0.25 + yaw, 0.75 - yaw, 0.75 + yaw];
            assert_eq!(by_priority(parts, min, max), Some((forces, MotorLimited::NOTHING)));
            let more = Parts { yaw: 1.5 * yaw, ..parts };
            assert_eq!(by_priority(more, min, max), Some((forces, MotorLimited::from_bits(4))));
        }
    }
}
