//! Stored trajectories: polynomial pieces and a tick in, the flat output to jerk out, or to its fifth derivative.
//!
//! A [`Trajectory`] is pieces that have been checked; a [`Player`] walks along them at a fixed rate. Time is the tick:
//! the time within a piece is found by integers, in nanoseconds, and only then becomes an `f32`.

use core::fmt;

use nalgebra::Vector3;

use crate::airframe::Airframe;
use crate::checksum::Crc32c;
use crate::clock::{Rate, Tick, TickClock};
use crate::error::ReferenceError;
use crate::motor_reference::{FifthOrderSample, Motion, MotorReference, Turn};
use crate::reference::{FlatSample, Reference};

/// Coefficients of a polynomial of degree at most 7, ascending powers of the seconds since the piece began.
pub type Coefficients = [f32; 8];

/// One piece of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Piece {
    /// How long it lasts, ns.
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

/// Longest trajectory, ns: one hour.
pub const MAX_DURATION_NS: u64 = 3_600_000_000_000;

/// Largest jump of position between two pieces, m. Beyond it the pieces do not belong together; below it, it is the
/// rounding of coefficients that were written with six decimals.
pub const MAX_JUMP_M: f32 = 1e-3;

/// Largest jump of heading between two pieces, rad.
pub const MAX_HEADING_JUMP_RAD: f32 = 1e-3;

/// Pieces that have been checked: at least one, positive durations, finite coefficients, no jumps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trajectory<'a> {
    first: &'a Piece,
    following: &'a [Piece],
    summary: Summary,
}

/// What the check of pieces found. Kept beside pieces that do not change, it spares another check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Summary {
    duration_ns: u64,
    end: FlatSample,
    shape: Shape,
}

/// What all pieces have in common, and a step therefore need not compute.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shape {
    /// Heading 0 throughout.
    straight: bool,
    /// No position of a degree above 5.
    quintic: bool,
}

/// Why pieces are no trajectory; pieces are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TrajectoryError {
    /// There are none.
    Empty,
    /// A piece of no duration.
    NoDuration {
        /// Which piece.
        piece: usize,
    },
    /// Longer than [`MAX_DURATION_NS`] in all.
    TooLong {
        /// The piece with which the limit is passed.
        piece: usize,
    },
    /// A coefficient is infinite or not a number, or the polynomial leaves the range of f32.
    NonFinite {
        /// Which piece.
        piece: usize,
    },
    /// Position or heading jumps where a piece begins.
    Jump {
        /// The piece that begins there.
        piece: usize,
        /// How far it is from the end of the one before, m or rad.
        size: f32,
    },
}

impl fmt::Display for TrajectoryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("trajectory: no pieces"),
            Self::NoDuration { piece } => write!(f, "trajectory: piece {piece} has no duration"),
            Self::TooLong { piece } => write!(f, "trajectory: longer than an hour with piece {piece}; split it"),
            Self::NonFinite { piece } => write!(f, "trajectory: piece {piece} holds a value that is not finite"),
            Self::Jump { piece, size } => {
                write!(f, "trajectory: piece {piece} begins {size} m or rad from the end of the one before")
            }
        }
    }
}

impl core::error::Error for TrajectoryError {}

impl Summary {
    /// Of no pieces; all zero bytes.
    #[cfg_attr(not(feature = "link"), expect(dead_code, reason = "for trajectories that come over the link"))]
    pub(crate) const EMPTY: Self = Self {
        duration_ns: 0,
        end: FlatSample::at_rest(Vector3::new(0.0, 0.0, 0.0), 0.0),
        shape: Shape { straight: false, quintic: false },
    };
}

impl<'a> Trajectory<'a> {
    /// Checks pieces.
    ///
    /// # Errors
    /// [`TrajectoryError`] names the piece.
    pub fn new(pieces: &'a [Piece]) -> Result<Self, TrajectoryError> {
        let (first, following) = pieces.split_first().ok_or(TrajectoryError::Empty)?;
        let mut duration_ns = 0_u64;
        let mut end = first.start();
        for (index, piece) in pieces.iter().enumerate() {
            if piece.duration_ns == 0 {
                return Err(TrajectoryError::NoDuration { piece: index });
            }
            duration_ns = duration_ns.saturating_add(piece.duration_ns);
            if duration_ns > MAX_DURATION_NS {
                return Err(TrajectoryError::TooLong { piece: index });
            }
            if !piece.is_finite() {
                return Err(TrajectoryError::NonFinite { piece: index });
            }
            if let Some(size) = piece.jump_from(&end) {
                return Err(TrajectoryError::Jump { piece: index, size });
            }
            end = piece.at_leisure(piece.duration_ns);
        }
        let shape = Shape {
            straight: pieces.iter().all(|piece| piece.heading.iter().all(|c| *c == 0.0)),
            quintic: pieces
                .iter()
                .flat_map(|piece| [&piece.x, &piece.y, &piece.z])
                .all(|[.., c6, c7]| *c6 == 0.0 && *c7 == 0.0),
        };
        let end = FlatSample::at_rest(end.position_m, end.heading_rad);
        Ok(Self { first, following, summary: Summary { duration_ns, end, shape } })
    }

    /// Length in time, ns.
    pub fn duration_ns(&self) -> u64 {
        self.summary.duration_ns
    }

    /// CRC-32C of the pieces, one after the other: duration in ns (`u64`), then the coefficients of x, y, z and heading
    /// (`f32`, ascending powers), lowest byte first. It tells one trajectory from another: gains over time name theirs by
    /// it. Goes over every byte: once a flight, not once a step.
    #[cold]
    pub fn checksum(&self) -> u32 {
        let mut crc = Crc32c::new();
        for piece in core::iter::once(self.first).chain(self.following) {
            piece.duration_ns.to_le_bytes().into_iter().for_each(|byte| crc.update(byte));
            let coefficients = [&piece.x, &piece.y, &piece.z, &piece.heading].into_iter().flatten();
            coefficients.flat_map(|c| c.to_le_bytes()).for_each(|byte| crc.update(byte));
        }
        crc.value()
    }

    /// What the check found.
    #[cfg_attr(not(feature = "link"), expect(dead_code, reason = "for trajectories that come over the link"))]
    pub(crate) fn summary(&self) -> Summary {
        self.summary
    }

    /// The same pieces again, with what their check found.
    #[cfg_attr(not(feature = "link"), expect(dead_code, reason = "for trajectories that come over the link"))]
    pub(crate) fn of_checked(pieces: &'a [Piece], summary: Summary) -> Option<Self> {
        let (first, following) = pieces.split_first()?;
        Some(Self { first, following, summary })
    }
}

impl Piece {
    /// The flat output `time_ns` after the piece began.
    #[inline(always)]
    fn at(&self, time_ns: u64, shape: Shape) -> FlatSample {
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
    fn motion(&self, t: f32, shape: Shape) -> (Vector3<f32>, Vector3<f32>, Motion) {
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
    fn lasts(&self, time_ns: u64) -> bool {
        time_ns < self.duration_ns
    }

    /// The rest at which it begins.
    fn start(&self) -> FlatSample {
        // A polynomial begins with its first coefficient.
        let ([x, ..], [y, ..], [z, ..], [heading, ..]) = (self.x, self.y, self.z, self.heading);
        FlatSample::at_rest(Vector3::new(x, y, z), heading)
    }

    /// [`Self::at`] one axis after the other, to the same bits: small, for who is in no hurry.
    #[inline(never)]
    fn at_leisure(&self, time_ns: u64) -> FlatSample {
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
    fn is_finite(&self) -> bool {
        let t = 1.0 + seconds(self.duration_ns);
        [&self.x, &self.y, &self.z, &self.heading].iter().all(|coefficients| {
            // Bounds the derivatives to the fifth over the piece: 2520 = 7 * 6 * 5 * 4 * 3.
            (2520.0 * coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c.abs())).is_finite()
        })
    }

    /// How far this piece begins from `end`, if further than allowed.
    fn jump_from(&self, end: &FlatSample) -> Option<f32> {
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

/// A polynomial and its first three derivatives at `t`, all by one pass of Horner's scheme. Written out: what is still
/// zero in its first steps costs nothing.
#[inline]
fn derivatives(coefficients: &Coefficients, t: f32) -> [f32; 4] {
    let [c0, c1, c2, c3, c4, c5, c6, c7] = *coefficients;
    let (d1, p) = (c7, c7 * t + c6);
    let (d2, d1, p) = (d1, d1 * t + p, p * t + c5);
    let (d3, d2, d1, p) = (d2, d2 * t + d1, d1 * t + p, p * t + c4);
    let (d3, d2, d1, p) = (d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c3);
    let (d3, d2, d1, p) = (d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c2);
    let (d3, d2, d1, p) = (d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c1);
    let (d3, d2, d1, p) = (d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c0);
    [p, d1, 2.0 * d2, 6.0 * d3]
}

/// The same for a polynomial of degree 5, the paper's, to the same bits: two thirds of the products.
#[inline]
fn quintic_derivatives(coefficients: &Coefficients, t: f32) -> [f32; 4] {
    let [c0, c1, c2, c3, c4, c5, ..] = *coefficients;
    let (d1, p) = (c5, c5 * t + c4);
    let (d2, d1, p) = (d1, d1 * t + p, p * t + c3);
    let (d3, d2, d1, p) = (d2, d2 * t + d1, d1 * t + p, p * t + c2);
    let (d3, d2, d1, p) = (d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c1);
    let (d3, d2, d1, p) = (d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c0);
    [p, d1, 2.0 * d2, 6.0 * d3]
}

/// A polynomial and its first five derivatives at `t`; the first four to the same bits as by [`derivatives`].
#[inline]
fn derivatives_to_fifth(coefficients: &Coefficients, t: f32) -> [f32; 6] {
    let [c0, c1, c2, c3, c4, c5, c6, c7] = *coefficients;
    let (d1, p) = (c7, c7 * t + c6);
    let (d2, d1, p) = (d1, d1 * t + p, p * t + c5);
    let (d3, d2, d1, p) = (d2, d2 * t + d1, d1 * t + p, p * t + c4);
    let (d4, d3, d2, d1, p) = (d3, d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c3);
    let (d5, d4, d3, d2, d1, p) = (d4, d4 * t + d3, d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c2);
    let (d5, d4, d3, d2, d1, p) = (d5 * t + d4, d4 * t + d3, d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c1);
    let (d5, d4, d3, d2, d1, p) = (d5 * t + d4, d4 * t + d3, d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c0);
    [p, d1, 2.0 * d2, 6.0 * d3, 24.0 * d4, 120.0 * d5]
}

/// The same for a polynomial of degree 5, to the same bits.
#[inline]
fn quintic_derivatives_to_fifth(coefficients: &Coefficients, t: f32) -> [f32; 6] {
    let [c0, c1, c2, c3, c4, c5, ..] = *coefficients;
    let (d1, p) = (c5, c5 * t + c4);
    let (d2, d1, p) = (d1, d1 * t + p, p * t + c3);
    let (d3, d2, d1, p) = (d2, d2 * t + d1, d1 * t + p, p * t + c2);
    let (d4, d3, d2, d1, p) = (d3, d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c1);
    let (d5, d4, d3, d2, d1, p) = (d4, d4 * t + d3, d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c0);
    [p, d1, 2.0 * d2, 6.0 * d3, 24.0 * d4, 120.0 * d5]
}

/// A polynomial and its first derivative at `t`.
#[inline]
fn value_and_rate(coefficients: &Coefficients, t: f32) -> [f32; 2] {
    let [c0, c1, c2, c3, c4, c5, c6, c7] = *coefficients;
    let (d1, p) = (c7, c7 * t + c6);
    let (d1, p) = (d1 * t + p, p * t + c5);
    let (d1, p) = (d1 * t + p, p * t + c4);
    let (d1, p) = (d1 * t + p, p * t + c3);
    let (d1, p) = (d1 * t + p, p * t + c2);
    let (d1, p) = (d1 * t + p, p * t + c1);
    let (d1, p) = (d1 * t + p, p * t + c0);
    [p, d1]
}

/// A time within a piece in seconds, from its two halves, each of which the FPU converts in one instruction. The upper one
/// counts units of 4.3 s and is nearly always zero.
#[inline]
fn seconds(time_ns: u64) -> f32 {
    #[cold]
    fn long(high: u32, low: u32) -> f32 {
        high as f32 * 4_294_967_296.0 + low as f32
    }
    let (high, low) = ((time_ns >> 32) as u32, time_ns as u32);
    1e-9 * if high == 0 { low as f32 } else { long(high, low) }
}

/// Walks along a trajectory, one tick at a time.
///
/// Ticks may be skipped or run backwards; a step forward within a piece or to the next one is the cheap case. After the
/// end the trajectory rests at its last position and heading.
#[derive(Clone, Copy, Debug)]
pub struct Player<'a> {
    trajectory: Trajectory<'a>,
    clock: TickClock,
    end_tick: Tick,
    /// The piece of the last tick and when it ends.
    piece: &'a Piece,
    following: &'a [Piece],
    end_ns: u64,
}

/// Where on which trajectory a step is, for laws whose gains belong to one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Progress {
    /// [`Trajectory::checksum`].
    pub trajectory: u32,
    /// Ticks of the player since its start.
    pub tick: Tick,
}

/// Where a player is, without its trajectory: for who cannot keep a trajectory borrowed between two steps.
#[derive(Clone, Copy, Debug)]
pub struct Bookmark {
    clock: TickClock,
    end_tick: Tick,
    duration_ns: u64,
    /// Pieces before the current one, and when that ends.
    passed: usize,
    end_ns: u64,
}

impl<'a> Player<'a> {
    /// A player at the start of `trajectory`, ticking at `rate`.
    pub fn new(trajectory: Trajectory<'a>, rate: Rate) -> Self {
        let clock = TickClock::new(rate);
        let end_tick = clock.first_tick_at(trajectory.summary.duration_ns);
        let (piece, following) = (trajectory.first, trajectory.following);
        Self { trajectory, clock, end_tick, piece, following, end_ns: piece.duration_ns }
    }

    /// Where it is.
    pub fn bookmark(&self) -> Bookmark {
        let Self { trajectory, clock, end_tick, end_ns, .. } = *self;
        // The piece of the last tick is none of those that follow.
        let passed = trajectory.following.len() - self.following.len();
        Bookmark { clock, end_tick, duration_ns: trajectory.summary.duration_ns, passed, end_ns }
    }

    /// A player that goes on where another one of the same trajectory was; nothing for another trajectory.
    pub fn resume(trajectory: Trajectory<'a>, bookmark: Bookmark) -> Option<Self> {
        let Bookmark { clock, end_tick, duration_ns, passed, end_ns } = bookmark;
        if trajectory.summary.duration_ns != duration_ns {
            return None;
        }
        let following = trajectory.following.get(passed..)?;
        let piece = match passed.checked_sub(1) {
            None => trajectory.first,
            Some(last) => trajectory.following.get(last)?,
        };
        Some(Self { trajectory, clock, end_tick, piece, following, end_ns })
    }

    /// The first tick at or after the trajectory's end.
    pub fn end_tick(&self) -> Tick {
        self.end_tick
    }

    /// The reference `tick` ticks after the start: [`Self::at`] and the flat map in one, cheaper than one after the other.
    ///
    /// # Errors
    /// [`ReferenceError`] where the trajectory asks for what cannot be flown.
    pub fn reference(&mut self, tick: Tick) -> Result<Reference, ReferenceError> {
        let Summary { end, shape, .. } = self.trajectory.summary;
        let sample = if tick >= self.end_tick {
            end
        } else {
            let time_ns = self.seek(tick);
            self.piece.at(time_ns, shape)
        };
        // The pieces have been checked: what they give is finite.
        Reference::of_finite(&sample)
    }

    /// What flies the trajectory with a craft `tick` ticks after the start, to the motor forces and their rates.
    ///
    /// # Errors
    /// [`ReferenceError`] where the trajectory asks for what cannot be flown.
    pub fn motor_reference(&mut self, tick: Tick, airframe: &Airframe) -> Result<MotorReference, ReferenceError> {
        if tick >= self.end_tick {
            return MotorReference::of_finite(&FifthOrderSample::of_jerk(self.trajectory.summary.end), airframe);
        }
        let t = seconds(self.seek(tick));
        let shape = self.trajectory.summary.shape;
        // First, while there is little else to be kept.
        let turn = (!shape.straight).then(|| Turn::new(derivatives(&self.piece.heading, t)));
        let (position_m, velocity_m_s, motion) = self.piece.motion(t, shape);
        MotorReference::of_motion(&position_m, &velocity_m_s, &motion, turn.as_ref(), airframe)
    }

    /// The flat output and its derivatives to the fifth `tick` ticks after the start.
    pub fn at_fifth_order(&mut self, tick: Tick) -> FifthOrderSample {
        let Summary { end, shape, .. } = self.trajectory.summary;
        if tick >= self.end_tick {
            return FifthOrderSample::of_jerk(end);
        }
        let t = seconds(self.seek(tick));
        let [heading_rad, heading_rate_rad_s, heading_acceleration_rad_s2, heading_jerk_rad_s3] =
            derivatives(&self.piece.heading, t);
        let (position_m, velocity_m_s, motion) = self.piece.motion(t, shape);
        FifthOrderSample {
            flat: FlatSample {
                position_m,
                velocity_m_s,
                acceleration_m_s2: motion.acceleration,
                jerk_m_s3: motion.jerk,
                heading_rad,
                heading_rate_rad_s,
            },
            snap_m_s4: motion.snap,
            crackle_m_s5: motion.crackle,
            heading_acceleration_rad_s2,
            heading_jerk_rad_s3,
        }
    }

    /// The flat output `tick` ticks after the start.
    pub fn at(&mut self, tick: Tick) -> FlatSample {
        if tick >= self.end_tick {
            return self.trajectory.summary.end;
        }
        let elapsed_ns = self.search(self.clock.time_ns(tick));
        self.piece.at_leisure(elapsed_ns)
    }

    /// Finds the piece of a tick before the end, and the time since that began.
    #[inline]
    fn seek(&mut self, tick: Tick) -> u64 {
        let time_ns = self.clock.time_ns(tick);
        let past_ns = time_ns.wrapping_sub(self.end_ns);
        if time_ns < self.end_ns {
            // Wraps to more than any piece lasts where that is still to begin; few last longer than 32 bits.
            let elapsed_ns = past_ns.wrapping_add(self.piece.duration_ns);
            if elapsed_ns <= u64::from(u32::MAX) || self.piece.lasts(elapsed_ns) {
                return elapsed_ns;
            }
        } else if let Some((next, following)) = self.following.split_first()
            && past_ns < next.duration_ns
        {
            (self.piece, self.following) = (next, following);
            self.end_ns += next.duration_ns;
            return past_ns;
        }
        self.search(time_ns)
    }

    /// The same from the start, for who skips pieces or goes back.
    #[cold]
    #[inline(never)]
    fn search(&mut self, time_ns: u64) -> u64 {
        (self.piece, self.following) = (self.trajectory.first, self.trajectory.following);
        self.end_ns = self.piece.duration_ns;
        while time_ns >= self.end_ns {
            let Some((next, following)) = self.following.split_first() else { break };
            (self.piece, self.following) = (next, following);
            self.end_ns += next.duration_ns;
        }
        time_ns + self.piece.duration_ns - self.end_ns
    }
}
