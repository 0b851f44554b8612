//! One piece: a time since its beginning (s) in; the flat output (world frame, m; rad) to its jerk, or to its fifth
//! derivative, out.

use nalgebra::Vector3;

use super::polynomial::{
    Coefficients, derivatives, derivatives_to_fifth, quintic_derivatives, quintic_derivatives_to_fifth, value_and_rate,
};
use crate::motor_reference::Motion;
use crate::reference::FlatSample;

/// Largest jump of position between two pieces, m. Beyond it the pieces do not belong together; below it, it is the
/// rounding of coefficients that were written with six decimals.
pub const MAX_JUMP_M: f32 = 1e-3;

/// Largest jump of heading between two pieces, rad.
pub const MAX_HEADING_JUMP_RAD: f32 = 1e-3;

/// One piece of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Piece {
    /// Its duration, ns.
    pub duration_ns: u64,
    /// Position along world x, m.
    pub x: Coefficients,
    /// Position along world y, m.
    pub y: Coefficients,
    /// Position along world z, m.
    pub z: Coefficients,
    /// Heading, rad.
    pub heading: Coefficients,
}

/// The properties that all pieces share, which a step therefore need not compute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    /// Heading 0 throughout.
    pub(super) straight: bool,
    /// No position of a degree above 5.
    pub(super) quintic: bool,
}

impl Piece {
    /// The flat output `time_ns` after the piece began.
    #[inline(always)]
    pub(super) fn at(&self, time_ns: u64, shape: Shape) -> FlatSample {
        let t = seconds(time_ns);
        let [[x, vx, ax, jx], [y, vy, ay, jy], [z, vz, az, jz]] = if shape.quintic {
            [quintic_derivatives(&self.x, t), quintic_derivatives(&self.y, t), quintic_derivatives(&self.z, t)]
        } else {
            [derivatives(&self.x, t), derivatives(&self.y, t), derivatives(&self.z, t)]
        };
        let [heading_rad, heading_rate_rad_s] =
            if shape.straight { [0.0, 0.0] } else { value_and_rate(&self.heading, t) };
        FlatSample {
            position_m: Vector3::new(x, y, z),
            velocity_m_s: Vector3::new(vx, vy, vz),
            acceleration_m_s2: Vector3::new(ax, ay, az),
            jerk_m_s3: Vector3::new(jx, jy, jz),
            heading_rad,
            heading_rate_rad_s,
        }
    }

    /// Position, velocity and the derivatives behind them to the fifth.
    #[inline(always)]
    pub(super) fn motion(&self, t: f32, shape: Shape) -> (Vector3<f32>, Vector3<f32>, Motion) {
        let [x, y, z] = if shape.quintic {
            [&self.x, &self.y, &self.z].map(|axis| quintic_derivatives_to_fifth(axis, t))
        } else {
            [&self.x, &self.y, &self.z].map(|axis| derivatives_to_fifth(axis, t))
        };
        let [[x, vx, ax, jx, sx, cx], [y, vy, ay, jy, sy, cy], [z, vz, az, jz, sz, cz]] = [x, y, z];
        let motion = Motion {
            acceleration: Vector3::new(ax, ay, az),
            jerk: Vector3::new(jx, jy, jz),
            snap: Vector3::new(sx, sy, sz),
            crackle: Vector3::new(cx, cy, cz),
        };
        (Vector3::new(x, y, z), Vector3::new(vx, vy, vz), motion)
    }

    /// Whether it lasts longer than some time.
    #[cold]
    #[inline(never)]
    pub(super) fn lasts(&self, time_ns: u64) -> bool {
        time_ns < self.duration_ns
    }

    /// The rest at which it begins.
    pub(super) fn start(&self) -> FlatSample {
        // A polynomial begins with its first coefficient.
        let ([x, ..], [y, ..], [z, ..], [heading, ..]) = (self.x, self.y, self.z, self.heading);
        FlatSample::at_rest(Vector3::new(x, y, z), heading)
    }

    /// [`Self::at`] one axis after the other, to the same bits: smaller code, and slower.
    #[inline(never)]
    pub(super) fn at_leisure(&self, time_ns: u64) -> FlatSample {
        #[inline(never)]
        fn axis(coefficients: &Coefficients, t: f32) -> [f32; 4] {
            derivatives(coefficients, t)
        }
        let t = seconds(time_ns);
        let [x, vx, ax, jx] = axis(&self.x, t);
        let [y, vy, ay, jy] = axis(&self.y, t);
        let [z, vz, az, jz] = axis(&self.z, t);
        let [heading_rad, heading_rate_rad_s, _, _] = axis(&self.heading, t);
        FlatSample {
            position_m: Vector3::new(x, y, z),
            velocity_m_s: Vector3::new(vx, vy, vz),
            acceleration_m_s2: Vector3::new(ax, ay, az),
            jerk_m_s3: Vector3::new(jx, jy, jz),
            heading_rad,
            heading_rate_rad_s,
        }
    }

    /// Coefficients and the values at both ends are finite; in between, no polynomial of degree 7 with finite
    /// coefficients over at most an hour that is finite at its end can exceed the sum of its terms, which is checked.
    pub(super) fn is_finite(&self) -> bool {
        let t = 1.0 + seconds(self.duration_ns);
        [&self.x, &self.y, &self.z, &self.heading].iter().all(|coefficients| {
            // Bounds the derivatives to the fifth over the piece: 2520 = 7 * 6 * 5 * 4 * 3.
            (2520.0 * coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c.abs())).is_finite()
        })
    }

    /// How far this piece begins from `end`, if further than allowed.
    pub(super) fn jump_from(&self, end: &FlatSample) -> Option<f32> {
        let start = self.start();
        let jumps = [
            (start.position_m.x - end.position_m.x, MAX_JUMP_M),
            (start.position_m.y - end.position_m.y, MAX_JUMP_M),
            (start.position_m.z - end.position_m.z, MAX_JUMP_M),
            (start.heading_rad - end.heading_rad, MAX_HEADING_JUMP_RAD),
        ];
        jumps.iter().map(|(jump, max)| (jump.abs(), max)).find(|(size, max)| size > max).map(|(size, _)| size)
    }
}

/// A time within a piece in seconds, from its two halves, each of which the FPU converts in one instruction. The upper one
/// counts units of 4.3 s and is nearly always zero.
#[inline]
pub(super) fn seconds(time_ns: u64) -> f32 {
    #[cold]
    fn long(high: u32, low: u32) -> f32 {
        high as f32 * 4_294_967_296.0 + low as f32
    }
    let (high, low) = ((time_ns >> 32) as u32, time_ns as u32);
    1e-9 * if high == 0 { low as f32 } else { long(high, low) }
}
