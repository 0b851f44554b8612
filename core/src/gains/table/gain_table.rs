//! A table of any kind: bytes in, a sound and certified table out, and back.

#[cfg(feature = "cascade")]
use super::cascade::CascadeTable;
use super::gains::{Content, Gains, bytes_behind_head, require_knots};
use super::{AcceptError, AcceptedTable, Rows, ScheduleRows, TableError, TableHead, TableKind, Vehicle, wire};
use crate::clock::Rate;
use crate::gains::ConstantGain;
use crate::law::{GainSchedule, Knot};
use crate::motor_lag::MotorLag;

/// A sound and certified table of any kind; see [`Self::accept_for`] for one that is flown. Gains along a trajectory are
/// borrowed from the bytes that it was read from, all others are its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainTable<'b> {
    content: Content,
    knots: &'b [Knot],
}

impl<'b> GainTable<'b> {
    /// Reads a table.
    ///
    /// # Errors
    /// [`TableError`]: the first thing that is wrong, from the frame inwards.
    pub fn from_bytes(bytes: &'b [u8]) -> Result<Self, TableError> {
        let payload = wire::open(bytes)?;
        let cut = wire::wrong_length(bytes, wire::HEAD_BYTES);
        let (head, rest) = payload.split_first_chunk::<{ wire::HEAD_BYTES }>().ok_or(cut)?;
        let mut fields = wire::Reader::new(head, cut);
        let kind = fields.kind()?;
        let length = bytes_behind_head(kind, rest, cut)?;
        if rest.len() != length {
            return Err(wire::wrong_length(bytes, wire::HEAD_BYTES + length));
        }
        let head = TableHead::read(fields)?;
        let (gains, knots) = Gains::read(kind, &head, rest)?;
        Ok(Self { content: Content { head, gains }, knots })
    }

    /// Writes a table of gains along a trajectory over the start of `buffer`, and reads it there. The same table gives the same
    /// bytes; [`super::TABLE_BYTES_MAX`] are enough for any.
    ///
    /// # Errors
    /// [`TableError`], as [`Self::from_bytes`] would find in it; [`TableError::Length`] where the buffer is too short.
    pub fn along(buffer: &'b mut [u8], head: &TableHead, rows: &ScheduleRows<'_>) -> Result<Self, TableError> {
        let ScheduleRows { trajectory, steps_per_knot, gains } = *rows;
        let knots = u16::try_from(gains.len()).unwrap_or(u16::MAX);
        require_knots(knots)?;
        let fields = along_fields(knots, steps_per_knot, trajectory);
        let entries = gains.as_flattened().as_flattened();
        let too_short = wire::wrong_length(buffer, wire::HEAD_BYTES + fields.len() + 4 * entries.len());
        let kind = TableKind::AlongTrajectory;
        let bytes = wire::write(buffer, kind, head, &fields, entries.iter().copied()).ok_or(too_short)?;
        Self::from_bytes(bytes)
    }

    /// Writes the table over the start of `buffer` and returns that part; nothing if it is too short. The same table
    /// gives the same bytes; [`super::TABLE_BYTES_MAX`] are enough for any, and [`super::CONSTANT_TABLE_BYTES_MAX`] for any but
    /// one along a trajectory.
    pub fn to_bytes<'o>(&self, buffer: &'o mut [u8]) -> Option<&'o [u8]> {
        let (kind, head) = (self.kind(), &self.content.head);
        match &self.content.gains {
            Gains::Constant(_) => wire::write(buffer, kind, head, &[], self.rows()?.entries().iter().copied()),
            #[cfg(feature = "cascade")]
            Gains::Cascade { table, .. } => {
                wire::write(buffer, kind, head, &table.fields(), table.gains.numbers().into_iter())
            }
            Gains::Along { steps_per_knot, trajectory } => {
                let fields = along_fields(u16::try_from(self.knots.len()).ok()?, *steps_per_knot, *trajectory);
                let entries = self.knots.as_flattened().as_flattened();
                wire::write(buffer, kind, head, &fields, entries.iter().map(|entry| f32::from_le_bytes(*entry)))
            }
        }
    }

    /// The table as one that this board flies: it was designed for `vehicle` and certified at `rate`, that of the
    /// control steps.
    ///
    /// # Errors
    /// [`AcceptError`].
    pub fn accept_for(&self, vehicle: &Vehicle, rate: Rate) -> Result<AcceptedTable<'_>, AcceptError> {
        self.content.head.accept_for(vehicle, rate)?;
        Ok(AcceptedTable::of(&self.content, self.knots))
    }

    /// The law that it is for.
    pub const fn kind(&self) -> TableKind {
        self.content.gains.kind()
    }

    /// Its head: all but the gains.
    pub const fn head(&self) -> &TableHead {
        &self.content.head
    }

    /// The gain, if it is one matrix that is the same all the time.
    pub const fn gain(&self) -> Option<&ConstantGain> {
        match &self.content.gains {
            Gains::Constant(gain) => Some(gain),
            #[cfg(feature = "cascade")]
            Gains::Cascade { .. } => None,
            Gains::Along { .. } => None,
        }
    }

    /// The cascade's fields, if that is its kind.
    #[cfg(feature = "cascade")]
    pub const fn cascade(&self) -> Option<&CascadeTable> {
        match &self.content.gains {
            Gains::Cascade { table, .. } => Some(table),
            _ => None,
        }
    }

    /// The motor lag that it was designed for, if it reckons with one.
    pub const fn lag(&self) -> Option<&MotorLag> {
        match &self.content.gains {
            #[cfg(feature = "cascade")]
            Gains::Cascade { lag, .. } => Some(lag),
            _ => None,
        }
    }

    /// The gains along a trajectory, if that is its kind.
    pub const fn schedule(&self) -> Option<GainSchedule<'b>> {
        match &self.content.gains {
            Gains::Along { steps_per_knot, trajectory } => {
                Some(GainSchedule::of_checked(self.knots, *steps_per_knot, *trajectory))
            }
            _ => None,
        }
    }

    /// The rows that it was written from, if that is one matrix.
    pub const fn rows(&self) -> Option<Rows> {
        Some(match self.gain() {
            Some(ConstantGain::Equilibrium(gain)) => Rows::Equilibrium(*gain.gain().rows()),
            Some(ConstantGain::FlatOutput(gain)) => Rows::FlatOutput(*gain.gain().rows()),
            Some(ConstantGain::Integral(gain)) => Rows::Integral(gain.rows()),
            None => return None,
        })
    }
}

impl GainTable<'static> {
    /// Checks the parts of a table that is to be written, of one gain.
    ///
    /// # Errors
    /// [`TableError`], as [`Self::from_bytes`] would find in it.
    pub fn new(head: TableHead, rows: &Rows) -> Result<Self, TableError> {
        head.check()?;
        Ok(Self { content: Content { head, gains: Gains::new(rows)? }, knots: &[] })
    }

    /// The same of one of the cascade.
    ///
    /// # Errors
    /// As [`Self::new`].
    #[cfg(feature = "cascade")]
    pub fn of_cascade(head: TableHead, table: &CascadeTable) -> Result<Self, TableError> {
        head.check()?;
        Ok(Self { content: Content { head, gains: Gains::cascade(table, &head)? }, knots: &[] })
    }
}

impl GainTable<'_> {
    /// The table without the bytes that it was read from; nothing where it borrows its gains from there.
    pub const fn owned(&self) -> Option<GainTable<'static>> {
        match &self.content.gains {
            Gains::Along { .. } => None,
            _ => Some(GainTable { content: self.content, knots: &[] }),
        }
    }
}

/// Knots, their spacing, the trajectory's checksum.
fn along_fields(knots: u16, steps_per_knot: u16, trajectory: u32) -> [u8; 8] {
    let [k0, k1] = knots.to_le_bytes();
    let [s0, s1] = steps_per_knot.to_le_bytes();
    let [t0, t1, t2, t3] = trajectory.to_le_bytes();
    [k0, k1, s0, s1, t0, t1, t2, t3]
}
