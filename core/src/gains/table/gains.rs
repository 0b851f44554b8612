//! The gains in a table, of any kind: rows or bytes in, checked gains out.

#[cfg(feature = "cascade")]
use super::cascade::{self, CascadeTable};
#[cfg(feature = "cascade")]
use super::error::count;
use super::error::{KnotFault, TableError};
use super::{ENTRY_MAX, ENTRY_MIN, KNOTS_MAX, Rows, TableHead, TableKind, wire};
use crate::gains::ConstantGain;
use crate::law::{EquilibriumGain, FlatOutputGain, GainSchedule, IntegralGain, Knot};
#[cfg(feature = "cascade")]
use crate::motor_lag::MotorLag;

/// All of a table but the gains at knots, which stay where they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Content {
    pub(crate) head: TableHead,
    pub(crate) gains: Gains,
}

#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to put the larger one on")]
pub(crate) enum Gains {
    /// The same all the time.
    Constant(ConstantGain),
    /// Of the cascade, with the lag in its table.
    #[cfg(feature = "cascade")]
    Cascade { table: CascadeTable, lag: MotorLag },
    /// At knots along the trajectory of a checksum.
    Along { steps_per_knot: u16, trajectory: u32 },
}

/// Bytes of the fields between head and gains along a trajectory: knots, their spacing, the trajectory's checksum.
pub(super) const ALONG_BYTES: usize = 2 + 2 + 4;

impl Gains {
    pub(super) const fn kind(&self) -> TableKind {
        match self {
            Self::Constant(ConstantGain::Equilibrium(_)) => TableKind::Equilibrium,
            Self::Constant(ConstantGain::FlatOutput(_)) => TableKind::FlatOutput,
            Self::Constant(ConstantGain::Integral(_)) => TableKind::Integral,
            #[cfg(feature = "cascade")]
            Self::Cascade { .. } => TableKind::Cascade,
            Self::Along { .. } => TableKind::AlongTrajectory,
        }
    }

    pub(super) fn new(rows: &Rows) -> Result<Self, TableError> {
        match rows {
            Rows::Equilibrium(rows) => Self::equilibrium(rows),
            Rows::FlatOutput(rows) => Self::flat_output(rows),
            Rows::Integral(rows) => Self::integral(rows),
        }
    }

    /// From the bytes behind the head; with the gains at knots where they are.
    pub(super) fn read<'b>(
        kind: TableKind,
        head: &TableHead,
        rest: &'b [u8],
    ) -> Result<(Self, &'b [Knot]), TableError> {
        let gains = match kind {
            TableKind::Equilibrium => {
                let mut rows = [[0.0; 9]; 4];
                wire::read_entries(rest, rows.as_flattened_mut());
                Self::equilibrium(&rows)?
            }
            TableKind::FlatOutput => {
                let mut rows = [[0.0; 10]; 7];
                wire::read_entries(rest, rows.as_flattened_mut());
                Self::flat_output(&rows)?
            }
            TableKind::Integral => {
                let mut rows = [[0.0; 12]; 4];
                wire::read_entries(rest, rows.as_flattened_mut());
                Self::integral(&rows)?
            }
            TableKind::ActuatorAware => return Err(TableError::ActuatorAware),
            #[cfg(feature = "cascade")]
            TableKind::Cascade => {
                let ended = TableError::Length { bytes: count(rest.len()), wanted: count(cascade::BYTES) };
                Self::cascade(&CascadeTable::read(rest, ended)?, head)?
            }
            #[cfg(not(feature = "cascade"))]
            TableKind::Cascade => {
                let _ = head;
                return Err(TableError::Kind { found: kind.number() });
            }
            TableKind::AlongTrajectory => return Self::along(rest),
        };
        Ok((gains, &[]))
    }

    #[cfg(feature = "cascade")]
    pub(super) fn cascade(table: &CascadeTable, head: &TableHead) -> Result<Self, TableError> {
        Ok(Self::Cascade { table: *table, lag: table.checked(head)? })
    }

    fn equilibrium(rows: &[[f32; 9]; 4]) -> Result<Self, TableError> {
        let gain = EquilibriumGain::new(*rows).map_err(TableError::Gain)?;
        in_proportion(rows.as_flattened(), 9)?;
        Ok(Self::Constant(ConstantGain::Equilibrium(gain)))
    }

    fn flat_output(rows: &[[f32; 10]; 7]) -> Result<Self, TableError> {
        let gain = FlatOutputGain::new(*rows).map_err(TableError::Gain)?;
        in_proportion(rows.as_flattened(), 10)?;
        Ok(Self::Constant(ConstantGain::FlatOutput(gain)))
    }

    fn integral(rows: &[[f32; 12]; 4]) -> Result<Self, TableError> {
        let gain = IntegralGain::new(*rows).map_err(TableError::Gain)?;
        in_proportion(rows.as_flattened(), 12)?;
        Ok(Self::Constant(ConstantGain::Integral(gain)))
    }

    fn along(rest: &[u8]) -> Result<(Self, &[Knot]), TableError> {
        let (fields, entries) = rest.split_first_chunk::<ALONG_BYTES>().unwrap_or((&[0; ALONG_BYTES], &[]));
        let [_, _, s0, s1, t0, t1, t2, t3] = *fields;
        let (steps_per_knot, trajectory) = (u16::from_le_bytes([s0, s1]), u32::from_le_bytes([t0, t1, t2, t3]));
        let knots = as_knots(entries);
        GainSchedule::new(knots, steps_per_knot, trajectory)?;
        for (knot, gain) in (0..).zip(knots) {
            let gain = gain.map(|row| row.map(f32::from_le_bytes));
            if let Some((row, column, value)) = out_of_proportion(gain.as_flattened(), 9) {
                return Err(TableError::Knot { knot, fault: KnotFault::Entry { row, column, value } });
            }
        }
        Ok((Self::Along { steps_per_knot, trajectory }, knots))
    }
}

/// Bytes of the payload of a kind's table behind the head, from its start.
///
/// # Errors
/// [`TableError::ActuatorAware`]; [`TableError::Knots`] for gains along a trajectory of too few or too many knots; `ended` where
/// their number is cut off.
pub(super) fn bytes_behind_head(kind: TableKind, rest: &[u8], ended: TableError) -> Result<usize, TableError> {
    Ok(match kind {
        TableKind::AlongTrajectory => {
            let (fields, _) = rest.split_first_chunk::<ALONG_BYTES>().ok_or(ended)?;
            let [k0, k1, ..] = *fields;
            let knots = require_knots(u16::from_le_bytes([k0, k1]))?;
            ALONG_BYTES + knots * kind.gain_bytes()
        }
        TableKind::ActuatorAware => return Err(TableError::ActuatorAware),
        #[cfg(feature = "cascade")]
        TableKind::Cascade => cascade::BYTES,
        #[cfg(not(feature = "cascade"))]
        TableKind::Cascade => return Err(TableError::Kind { found: kind.number() }),
        _ => kind.gain_bytes(),
    })
}

/// As many knots as a table may have.
pub(super) fn require_knots(found: u16) -> Result<usize, TableError> {
    let knots = usize::from(found);
    if (2..=KNOTS_MAX).contains(&knots) { Ok(knots) } else { Err(TableError::Knots { found }) }
}

/// The entries as gains, without copying one.
fn as_knots(entries: &[u8]) -> &[Knot] {
    let (entries, _) = entries.as_chunks::<4>();
    let (rows, _) = entries.as_chunks::<9>();
    let (knots, _) = rows.as_chunks::<4>();
    knots
}

fn in_proportion(entries: &[f32], columns: u8) -> Result<(), TableError> {
    match out_of_proportion(entries, columns) {
        None => Ok(()),
        Some((row, column, value)) => Err(TableError::Entry { row, column, value }),
    }
}

/// The row, column and value of the first entry that is neither 0 nor of a size from [`ENTRY_MIN`] to [`ENTRY_MAX`].
#[inline(never)]
fn out_of_proportion(entries: &[f32], columns: u8) -> Option<(u8, u8, f32)> {
    let (mut row, mut column) = (0, 0);
    for value in entries.iter().copied() {
        if value != 0.0 && !(ENTRY_MIN..=ENTRY_MAX).contains(&value.abs()) {
            return Some((row, column, value));
        }
        column += 1;
        if column == columns {
            (row, column) = (row + 1, 0);
        }
    }
    None
}
