//! Time-varying LQR: `u = u_e - K(t) e`, with gains at evenly spaced knots along one trajectory, linear in between.
//!
//! The gains belong to a trajectory, and a step says where on which one it is ([`Progress`]). Behind the last knot, and
//! for a reference that is not on that trajectory, the last knot's gain is flown: the trajectory ends at rest, and there
//! the gain is that of a hover. Errors are those of [`super::ErrorForm::HeadingFrame`].

use core::fmt;

use nalgebra::Vector3;

use super::FeedForward;
use super::equilibrium::heading_frame_error;
use crate::clock::Rate;
use crate::command::Command;
use crate::flatness::GRAVITY_M_S2;
use crate::gain::{Gain, GainError};
use crate::reference::Reference;
use crate::state::NormalizedState;
use crate::trajectory::Progress;

/// A gain at a knot by rows as a table stores it, each entry an `f32` lowest byte first: outputs `[T p q r]` from
/// errors `[x y z q1 q2 q3 vx vy vz]`. Made by [`GainSchedule::knot`].
pub type Knot = [[[u8; 4]; 9]; 4];

/// Gains over time; borrowed, for they are too many to copy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainSchedule<'a> {
    knots: &'a [Knot],
    last: &'a Knot,
    steps_per_knot: u16,
    trajectory: u32,
}

/// Why knots are no gains over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScheduleError {
    /// There are none.
    Empty,
    /// They are no control step apart.
    NoSpacing,
    /// The gain at one of them is none.
    Knot {
        /// The knot's number, from 0.
        knot: usize,
        /// Why.
        error: GainError,
    },
}

impl fmt::Display for ScheduleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("gains over time: no knots"),
            Self::NoSpacing => f.write_str("gains over time: knots 0 control steps apart; must be at least 1"),
            Self::Knot { knot, error } => write!(f, "gains over time: knot {knot}: {error}"),
        }
    }
}

impl core::error::Error for ScheduleError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Knot { error, .. } => Some(error),
            _ => None,
        }
    }
}

impl<'a> GainSchedule<'a> {
    /// Checks gains for the trajectory of a checksum ([`crate::Trajectory::checksum`]), the first at its start, the others
    /// so many control steps after each other.
    ///
    /// # Errors
    /// [`ScheduleError`].
    pub fn new(knots: &'a [Knot], steps_per_knot: u16, trajectory: u32) -> Result<Self, ScheduleError> {
        let last = knots.last().ok_or(ScheduleError::Empty)?;
        if steps_per_knot == 0 {
            return Err(ScheduleError::NoSpacing);
        }
        for (knot, gain) in knots.iter().enumerate() {
            Gain::new(rows(gain)).map_err(|error| ScheduleError::Knot { knot, error })?;
        }
        Ok(Self { knots, last, steps_per_knot, trajectory })
    }

    /// Of knots and a spacing that have been checked before.
    pub(crate) const fn of_checked(knots: &'a [Knot], steps_per_knot: u16, trajectory: u32) -> Self {
        const NONE: Knot = [[[0; 4]; 9]; 4];
        let last = match knots.last() {
            Some(last) => last,
            None => &NONE,
        };
        Self { knots, last, steps_per_knot, trajectory }
    }

    /// A gain by rows as a knot.
    pub fn knot(rows: &[[f32; 9]; 4]) -> Knot {
        rows.map(|row| row.map(f32::to_le_bytes))
    }

    /// Knots; the first one is at the trajectory's start.
    pub const fn knots(&self) -> usize {
        self.knots.len()
    }

    /// Control steps from one knot to the next.
    pub const fn steps_per_knot(&self) -> u16 {
        self.steps_per_knot
    }

    /// Checksum of the trajectory that the gains are for, as [`crate::Trajectory::checksum`] has it.
    pub const fn trajectory(&self) -> u32 {
        self.trajectory
    }

    /// The gain at a knot, counted from 0.
    pub fn gain(&self, knot: usize) -> Option<[[f32; 9]; 4]> {
        self.knots.get(knot).map(rows)
    }

    /// `K e`, `position` knots behind the first one.
    #[inline]
    fn times(&self, position: Option<f32>, error: &[f32; 9]) -> [f32; 4] {
        // A cast from float to integer saturates: there is no knot behind the last one.
        let Some((position, [before, after, ..])) =
            position.and_then(|position| Some((position, self.knots.get(position as usize..)?)))
        else {
            return product(self.last, error);
        };
        let share = position - (position as u32) as f32;
        let ([t0, p0, q0, r0], [t1, p1, q1, r1]) = (product(before, error), product(after, error));
        let between = |from: f32, to: f32| from + (to - from) * share;
        [between(t0, t1), between(p0, p1), between(q0, q1), between(r0, r1)]
    }
}

fn rows(knot: &Knot) -> [[f32; 9]; 4] {
    knot.map(|row| row.map(f32::from_le_bytes))
}

/// `K e` of one knot, each sum in the order of the columns.
#[inline]
fn product(knot: &Knot, error: &[f32; 9]) -> [f32; 4] {
    knot.each_ref().map(|row| row.iter().zip(error).fold(0.0, |sum, (k, e)| sum + f32::from_le_bytes(*k) * e))
}

/// The time-varying law.
///
/// It is flown from a table: [`crate::gains::table`] has an example.
#[derive(Clone, Copy, Debug)]
pub struct AlongTrajectory<'a> {
    schedule: GainSchedule<'a>,
    feed_forward: FeedForward,
    knots_per_tick: f32,
}

impl<'a> AlongTrajectory<'a> {
    /// The law with gains for control steps at `rate`, on a trajectory that is played at `player_rate`: both are the same
    /// where every tick of the player has a control step.
    pub fn new(schedule: GainSchedule<'a>, rate: Rate, player_rate: Rate, feed_forward: FeedForward) -> Self {
        let ticks_per_knot = f32::from(schedule.steps_per_knot) * player_rate.hz() as f32 / rate.hz() as f32;
        Self { schedule, feed_forward, knots_per_tick: 1.0 / ticks_per_knot }
    }

    /// The command before saturation.
    #[inline]
    pub fn command(&self, progress: Option<Progress>, state: &NormalizedState<'_>, reference: &Reference) -> Command {
        let position = progress
            .filter(|progress| progress.trajectory == self.schedule.trajectory)
            .map(|progress| progress.tick as f32 * self.knots_per_tick);
        let [t, p, q, r] = self.schedule.times(position, &heading_frame_error(state, reference));
        match self.feed_forward {
            FeedForward::Without => {
                Command { thrust_m_s2: GRAVITY_M_S2 - t, body_rates_rad_s: Vector3::new(-p, -q, -r) }
            }
            FeedForward::With => {
                let input = &reference.input;
                let rates = &input.body_rates_rad_s;
                Command {
                    thrust_m_s2: input.thrust_m_s2 - t,
                    body_rates_rad_s: Vector3::new(rates.x - p, rates.y - q, rates.z - r),
                }
            }
        }
    }
}
