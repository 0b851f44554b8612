//! Stored trajectories: polynomial pieces and a tick in, the flat output to jerk out.
//!
//! A [`Trajectory`] is pieces that have been checked; a [`Player`] walks along them at a fixed rate. Time is the tick:
//! the time within a piece is found by integers, in nanoseconds, and only then becomes an `f32`.

use core::fmt;

use nalgebra::Vector3;

use crate::clock::{Rate, Tick, TickClock};
use crate::reference::FlatSample;

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
    duration_ns: u64,
    end: FlatSample,
    /// Whether any piece has a heading other than 0.
    turns: bool,
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

impl<'a> Trajectory<'a> {
    /// Checks pieces.
    ///
    /// # Errors
    /// [`TrajectoryError`] names the piece.
    pub fn new(pieces: &'a [Piece]) -> Result<Self, TrajectoryError> {
        let (first, following) = pieces.split_first().ok_or(TrajectoryError::Empty)?;
        let mut duration_ns = 0_u64;
        let mut end = first.at(0, true);
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
            end = piece.at(piece.duration_ns, true);
        }
        let turns = pieces.iter().any(|piece| piece.heading.iter().any(|c| *c != 0.0));
        let end = FlatSample::at_rest(end.position_m, end.heading_rad);
        Ok(Self { first, following, duration_ns, end, turns })
    }

    /// Length in time, ns.
    pub fn duration_ns(&self) -> u64 {
        self.duration_ns
    }
}

impl Piece {
    /// The flat output `time_ns` after the piece began.
    #[inline]
    fn at(&self, time_ns: u64, turns: bool) -> FlatSample {
        let t = seconds(time_ns);
        let [x, vx, ax, jx] = derivatives(&self.x, t);
        let [y, vy, ay, jy] = derivatives(&self.y, t);
        let [z, vz, az, jz] = derivatives(&self.z, t);
        let [heading_rad, heading_rate_rad_s] = if turns { value_and_rate(&self.heading, t) } else { [0.0, 0.0] };
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
        let t = (self.duration_ns as f32 * 1e-9).max(1.0);
        [&self.x, &self.y, &self.z, &self.heading].iter().all(|coefficients| {
            // Bounds |p|, |p'|, |p''| and |p'''| over the piece: 210 = 7 * 6 * 5.
            (210.0 * coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c.abs())).is_finite()
        })
    }

    /// How far this piece begins from `end`, if further than allowed.
    fn jump_from(&self, end: &FlatSample) -> Option<f32> {
        let start = self.at(0, true);
        let position = (start.position_m - end.position_m).amax();
        let heading = (start.heading_rad - end.heading_rad).abs();
        let jumps = [(position, MAX_JUMP_M), (heading, MAX_HEADING_JUMP_RAD)];
        jumps.iter().find(|(size, max)| size > max).map(|(size, _)| *size)
    }
}

/// A polynomial and its first three derivatives at `t`, all by one pass of Horner's scheme. The first steps are written
/// out: what is still zero there costs nothing.
#[inline]
fn derivatives(coefficients: &Coefficients, t: f32) -> [f32; 4] {
    let [c0, c1, c2, c3, c4, c5, c6, c7] = *coefficients;
    let p = c7;
    let (d1, p) = (p, p * t + c6);
    let (d2, d1, p) = (d1, d1 * t + p, p * t + c5);
    let (mut d3, mut d2, mut d1, mut p) = (d2, d2 * t + d1, d1 * t + p, p * t + c4);
    for c in [c3, c2, c1, c0] {
        d3 = d3 * t + d2;
        d2 = d2 * t + d1;
        d1 = d1 * t + p;
        p = p * t + c;
    }
    [p, d1, 2.0 * d2, 6.0 * d3]
}

/// A polynomial and its first derivative at `t`.
#[inline]
fn value_and_rate(coefficients: &Coefficients, t: f32) -> [f32; 2] {
    let [c0, c1, c2, c3, c4, c5, c6, c7] = *coefficients;
    let (mut d1, mut p) = (c7, c7 * t + c6);
    for c in [c5, c4, c3, c2, c1, c0] {
        d1 = d1 * t + p;
        p = p * t + c;
    }
    [p, d1]
}

/// A time within a piece in seconds. Nearly all are below 2^32 ns, which the FPU converts in one instruction, to the
/// same bits.
#[inline]
fn seconds(time_ns: u64) -> f32 {
    let ns = u32::try_from(time_ns).map_or_else(|_| time_ns as f32, |ns| ns as f32);
    ns * 1e-9
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
    /// The piece of the last tick and when it begins.
    piece: &'a Piece,
    following: &'a [Piece],
    start_ns: u64,
}

impl<'a> Player<'a> {
    /// A player at the start of `trajectory`, ticking at `rate`.
    pub fn new(trajectory: Trajectory<'a>, rate: Rate) -> Self {
        let clock = TickClock::new(rate);
        let end_tick = clock.first_tick_at(trajectory.duration_ns);
        let (piece, following) = (trajectory.first, trajectory.following);
        Self { trajectory, clock, end_tick, piece, following, start_ns: 0 }
    }

    /// The first tick at or after the trajectory's end.
    pub fn end_tick(&self) -> Tick {
        self.end_tick
    }

    /// The flat output `tick` ticks after the start.
    #[inline]
    pub fn at(&mut self, tick: Tick) -> FlatSample {
        if tick >= self.end_tick {
            return self.trajectory.end;
        }
        let time_ns = self.clock.time_ns(tick);
        if time_ns < self.start_ns {
            self.rewind();
        }
        while time_ns - self.start_ns >= self.piece.duration_ns {
            let Some((next, following)) = self.following.split_first() else { break };
            self.start_ns += self.piece.duration_ns;
            (self.piece, self.following) = (next, following);
        }
        self.piece.at(time_ns - self.start_ns, self.trajectory.turns)
    }

    #[cold]
    fn rewind(&mut self) {
        (self.piece, self.following, self.start_ns) = (self.trajectory.first, self.trajectory.following, 0);
    }
}
