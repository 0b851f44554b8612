//! Gains over time as bytes: a table in, the gains at its knots out, borrowed from where they stand.

use super::error::{KnotFault, TableError};
use super::{AcceptError, LoadError, TableHead, TableKind, Vehicle, out_of_proportion, wire};
use crate::clock::Rate;
use crate::command::Limits;
use crate::law::{AlongTrajectory, FeedForward, GainSchedule, Knot, ScheduleError};
use crate::trajectory::Trajectory;

/// Most knots: with as many, a table goes where an uploaded trajectory goes.
pub const KNOTS_MAX: usize = 60;

/// Bytes of the fields between head and gains: knots, their spacing, the trajectory's checksum.
const FIELD_BYTES: usize = 2 + 2 + 4;

/// Bytes of the longest table of gains over time.
pub const SCHEDULE_BYTES_MAX: usize =
    wire::FRAME_BYTES + wire::HEAD_BYTES + FIELD_BYTES + KNOTS_MAX * TableKind::AlongTrajectory.gain_bytes();

/// What a table of gains over time is written from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScheduleRows<'a> {
    /// [`Trajectory::checksum`] of the trajectory that they are for.
    pub trajectory: u32,
    /// Control steps from one knot to the next, at the rate in the head.
    pub steps_per_knot: u16,
    /// The gains by rows, the first at the trajectory's start: outputs `[T p q r]` from errors
    /// `[x y z q1 q2 q3 vx vy vz]`.
    pub gains: &'a [[[f32; 9]; 4]],
}

/// A sound and certified table of gains over time; see [`Self::accept_for`] for one that is flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScheduleTable<'a> {
    bytes: &'a [u8],
    head: TableHead,
    schedule: GainSchedule<'a>,
}

/// A table for this board's vehicle and rate; made by [`ScheduleTable::accept_for`] alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AcceptedSchedule<'a> {
    table: ScheduleTable<'a>,
}

impl<'a> ScheduleTable<'a> {
    /// Writes a table over the start of `buffer`, and reads it there. The same table gives the same bytes;
    /// [`SCHEDULE_BYTES_MAX`] are enough for any.
    ///
    /// # Errors
    /// [`TableError`], as [`Self::from_bytes`] would find in it; [`TableError::Length`] where the buffer is too short.
    pub fn write(buffer: &'a mut [u8], head: &TableHead, rows: &ScheduleRows<'_>) -> Result<Self, TableError> {
        let ScheduleRows { trajectory, steps_per_knot, gains } = *rows;
        let knots = u16::try_from(gains.len()).unwrap_or(u16::MAX);
        require_knots(knots)?;
        let [k0, k1] = knots.to_le_bytes();
        let [s0, s1] = steps_per_knot.to_le_bytes();
        let [t0, t1, t2, t3] = trajectory.to_le_bytes();
        let fields: [u8; FIELD_BYTES] = [k0, k1, s0, s1, t0, t1, t2, t3];
        let too_short = wire::wrong_length(buffer, payload_bytes(knots));
        let entries = gains.as_flattened().as_flattened();
        let bytes = wire::write(buffer, TableKind::AlongTrajectory, head, &fields, entries).ok_or(too_short)?;
        Self::from_bytes(bytes)
    }

    /// Reads a table, and leaves its gains where they are.
    ///
    /// # Errors
    /// [`TableError`]: the first thing that is wrong, from the frame inwards.
    pub fn from_bytes(bytes: &'a [u8]) -> Result<Self, TableError> {
        let payload = wire::open(bytes)?;
        let cut = wire::wrong_length(bytes, wire::HEAD_BYTES + FIELD_BYTES);
        let (head, rest) = payload.split_first_chunk::<{ wire::HEAD_BYTES }>().ok_or(cut)?;
        let mut head = wire::Reader::new(head, cut);
        let kind = head.kind()?;
        if kind != TableKind::AlongTrajectory {
            return Err(TableError::OtherKind { kind });
        }
        let (fields, entries) = rest.split_first_chunk::<FIELD_BYTES>().ok_or(cut)?;
        let mut fields = wire::Reader::new(fields, cut);
        let (knots, steps_per_knot, trajectory) = (fields.u16()?, fields.u16()?, fields.u32()?);
        require_knots(knots)?;
        if payload.len() != payload_bytes(knots) {
            return Err(wire::wrong_length(bytes, payload_bytes(knots)));
        }
        let gains = as_knots(entries);
        let schedule = GainSchedule::new(gains, steps_per_knot, trajectory)?;
        for (knot, gain) in (0..).zip(gains) {
            let gain = gain.map(|row| row.map(f32::from_le_bytes));
            if let Some((row, column, value)) = out_of_proportion(gain.as_flattened(), 9) {
                return Err(TableError::Knot { knot, fault: KnotFault::Entry { row, column, value } });
            }
        }
        Ok(Self { bytes, head: TableHead::read(head)?, schedule })
    }

    /// The table as one that this board flies: it was designed for `vehicle` and certified at `rate`, that of the
    /// control steps.
    ///
    /// # Errors
    /// [`AcceptError`].
    pub fn accept_for(self, vehicle: &Vehicle, rate: Rate) -> Result<AcceptedSchedule<'a>, AcceptError> {
        self.head.accept_for(vehicle, rate)?;
        Ok(AcceptedSchedule { table: self })
    }

    /// What it says beside the gains.
    pub const fn head(&self) -> &TableHead {
        &self.head
    }

    /// The gains, to be looked at.
    pub const fn schedule(&self) -> &GainSchedule<'a> {
        &self.schedule
    }

    /// The bytes that it was read from.
    pub const fn bytes(&self) -> &'a [u8] {
        self.bytes
    }
}

impl<'a> AcceptedSchedule<'a> {
    /// Reads a table and accepts it, in one.
    ///
    /// # Errors
    /// [`LoadError`].
    pub fn from_bytes(bytes: &'a [u8], vehicle: &Vehicle, rate: Rate) -> Result<Self, LoadError> {
        Ok(ScheduleTable::from_bytes(bytes)?.accept_for(vehicle, rate)?)
    }

    /// The law, for a trajectory that is played at `player_rate`.
    pub fn law(&self, player_rate: Rate, feed_forward: FeedForward) -> AlongTrajectory<'a> {
        AlongTrajectory::new(self.table.schedule, self.table.head.rate, player_rate, feed_forward)
    }

    /// Whether the gains are for this trajectory; on another one the law flies the last knot's gain throughout.
    pub fn is_for(&self, trajectory: &Trajectory<'_>) -> bool {
        self.table.schedule.trajectory() == trajectory.checksum()
    }

    /// What the vehicle can be asked for.
    pub const fn limits(&self) -> Limits {
        self.table.head.limits
    }

    /// The table, to be looked at.
    pub const fn table(&self) -> &ScheduleTable<'a> {
        &self.table
    }
}

fn require_knots(found: u16) -> Result<(), TableError> {
    if (2..=KNOTS_MAX).contains(&usize::from(found)) { Ok(()) } else { Err(TableError::Knots { found }) }
}

fn payload_bytes(knots: u16) -> usize {
    wire::HEAD_BYTES + FIELD_BYTES + usize::from(knots) * TableKind::AlongTrajectory.gain_bytes()
}

/// The entries as gains, without copying one.
fn as_knots(entries: &[u8]) -> &[Knot] {
    let (entries, _) = entries.as_chunks::<4>();
    let (rows, _) = entries.as_chunks::<9>();
    let (knots, _) = rows.as_chunks::<4>();
    knots
}

impl From<ScheduleError> for TableError {
    fn from(error: ScheduleError) -> Self {
        match error {
            ScheduleError::Empty => Self::Knots { found: 0 },
            ScheduleError::NoSpacing => Self::KnotSpacing,
            ScheduleError::Knot { knot, error } => {
                Self::Knot { knot: u16::try_from(knot).unwrap_or(u16::MAX), fault: KnotFault::Gain(error) }
            }
        }
    }
}
