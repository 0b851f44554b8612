//! A trajectory played by ticks: a tick in; the flat output, or the reference of a law, out.

use super::checked::{Summary, Trajectory};
use super::piece::{Piece, seconds};
use super::polynomial::derivatives;
use crate::clock::{Rate, Tick, TickClock};
use crate::error::ReferenceError;
use crate::motor_reference::FifthOrderSample;
use crate::reference::{FlatSample, Reference};

/// Walks along a trajectory, one tick at a time.
///
/// Ticks may be skipped or run backwards; a step forward within a piece or to the next one is the cheap case. After the
/// end the trajectory rests at its last position and heading.
///
/// ```
/// use quatrack::{Piece, Player, Rate, Trajectory};
///
/// // One metre along x in two seconds, `10 s^3 - 15 s^4 + 6 s^5` with `s = t / 2 s`.
/// let pieces = [Piece {
///     duration_ns: 2_000_000_000,
///     x: [0.0, 0.0, 0.0, 1.25, -0.9375, 0.1875, 0.0, 0.0],
///     y: [0.0; 8],
///     z: [0.0; 8],
///     heading: [0.0; 8],
/// }];
/// let mut player = Player::new(Trajectory::new(&pieces)?, Rate::from_hz(500).ok_or("no rate")?);
/// assert_eq!(player.end_tick(), 1000);
/// let halfway = player.reference(500)?;
/// assert!((halfway.state().position_m.x - 0.5).abs() < 1e-6);
/// // 30/16 of the mean speed, where it is fastest.
/// assert!((halfway.state().velocity_m_s.x - 0.9375).abs() < 1e-6);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
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

/// Where a player is, without its trajectory: for callers that cannot keep a trajectory borrowed between two steps.
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

    /// Its place.
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

    /// The trajectory that is played.
    pub const fn trajectory(&self) -> &Trajectory<'a> {
        &self.trajectory
    }

    /// The first tick at or after the trajectory's end.
    pub fn end_tick(&self) -> Tick {
        self.end_tick
    }

    /// The reference `tick` ticks after the start: [`Self::at`] and the flat map in one, cheaper than one after the other.
    ///
    /// # Errors
    /// [`ReferenceError`] where the trajectory asks for a motion that cannot be flown.
    pub fn reference(&mut self, tick: Tick) -> Result<Reference, ReferenceError> {
        let Summary { end, shape, .. } = self.trajectory.summary;
        let sample = if tick >= self.end_tick {
            end
        } else {
            let time_ns = self.seek(tick);
            self.piece.at(time_ns, shape)
        };
        // The pieces have been checked: their values are finite.
        Reference::of_finite(&sample)
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

    /// The same from the start, for callers that skip pieces or go back.
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
