//! The gain of the actuator-aware law as bytes: a table in, the gain and the motor lag that it was designed for out.

use super::error::TableError;
use super::{AcceptError, LoadError, TableHead, TableKind, Vehicle, in_proportion, wire};
use crate::airframe::Airframe;
use crate::clock::Rate;
use crate::command::Limits;
use crate::law::{ActuatorAware, ActuatorAwareGain};
use crate::motor_lag::MotorLag;

/// Bytes of the field between head and gain: the motor lag.
const FIELD_BYTES: usize = 4;

const PAYLOAD_BYTES: usize = wire::HEAD_BYTES + FIELD_BYTES + TableKind::ActuatorAware.gain_bytes();

/// Bytes of a table for the actuator-aware law.
pub const ACTUATOR_TABLE_BYTES: usize = wire::FRAME_BYTES + PAYLOAD_BYTES;

/// A sound and certified table for the actuator-aware law; see [`Self::accept_for`] for one that is flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActuatorTable {
    head: TableHead,
    lag: MotorLag,
    gain: ActuatorAwareGain,
}

/// A table for this board's vehicle and rate; made by [`ActuatorTable::accept_for`] alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AcceptedActuatorTable {
    table: ActuatorTable,
}

impl ActuatorTable {
    /// Checks the parts of a table that is to be written: the lag of the motors that it was designed for, s, and the gain by
    /// rows, outputs and errors as in [`ActuatorAwareGain`].
    ///
    /// # Errors
    /// [`TableError`], as [`Self::from_bytes`] would find in it.
    pub fn new(head: TableHead, motor_lag_s: f32, rows: &[[f32; 19]; 4]) -> Result<Self, TableError> {
        let gain = ActuatorAwareGain::new(*rows).map_err(TableError::Gain)?;
        in_proportion(rows.as_flattened(), 19)?;
        head.check()?;
        let unfit = TableError::MotorLag { lag_s: motor_lag_s };
        if motor_lag_s > head.certificate.motor_lag_max_s {
            return Err(unfit);
        }
        let lag = MotorLag::new(motor_lag_s, head.rate).map_err(|_| unfit)?;
        Ok(Self { head, lag, gain })
    }

    /// Reads a table.
    ///
    /// # Errors
    /// [`TableError`]: the first thing that is wrong, from the frame inwards.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TableError> {
        let payload = wire::open(bytes)?;
        let cut = wire::wrong_length(bytes, PAYLOAD_BYTES);
        let (head, rest) = payload.split_first_chunk::<{ wire::HEAD_BYTES }>().ok_or(cut)?;
        let mut head = wire::Reader::new(head, cut);
        let kind = head.kind()?;
        if kind != TableKind::ActuatorAware {
            return Err(TableError::OtherKind { kind });
        }
        if payload.len() != PAYLOAD_BYTES {
            return Err(cut);
        }
        let (field, entries) = rest.split_first_chunk::<FIELD_BYTES>().ok_or(cut)?;
        let mut rows = [[0.0; 19]; 4];
        wire::read_entries(entries, rows.as_flattened_mut());
        Self::new(TableHead::read(head)?, f32::from_le_bytes(*field), &rows)
    }

    /// Writes the table over the start of `buffer` and returns that part; nothing if it is too short. The same table
    /// gives the same bytes; they are [`ACTUATOR_TABLE_BYTES`].
    pub fn to_bytes<'b>(&self, buffer: &'b mut [u8]) -> Option<&'b [u8]> {
        let field = self.lag.lag_s().to_le_bytes();
        wire::write(buffer, TableKind::ActuatorAware, &self.head, &field, self.gain.gain().rows().as_flattened())
    }

    /// The table as one that this board flies: it was designed for `vehicle` and certified at `rate`, that of the
    /// control steps.
    ///
    /// # Errors
    /// [`AcceptError`].
    pub fn accept_for(self, vehicle: &Vehicle, rate: Rate) -> Result<AcceptedActuatorTable, AcceptError> {
        self.head.accept_for(vehicle, rate)?;
        Ok(AcceptedActuatorTable { table: self })
    }

    /// What it says beside the gain.
    pub const fn head(&self) -> &TableHead {
        &self.head
    }

    /// The lag that it was designed for, at its rate.
    pub const fn lag(&self) -> &MotorLag {
        &self.lag
    }

    /// The gain, to be looked at.
    pub const fn gain(&self) -> &ActuatorAwareGain {
        &self.gain
    }
}

impl AcceptedActuatorTable {
    /// Reads a table and accepts it, in one.
    ///
    /// # Errors
    /// [`LoadError`].
    pub fn from_bytes(bytes: &[u8], vehicle: &Vehicle, rate: Rate) -> Result<Self, LoadError> {
        Ok(ActuatorTable::from_bytes(bytes)?.accept_for(vehicle, rate)?)
    }

    /// The board's craft as the table reckons with it: its motors have the table's lag, its commands are held over the periods
    /// of the table's rate. For [`Self::law`], and for the references that it flies.
    pub const fn airframe(&self, board: &Airframe) -> Airframe {
        board.reckoning_with(&self.table.lag)
    }

    /// The law, within the force range of the board's craft.
    pub const fn law(&self, board: &Airframe) -> ActuatorAware<'_> {
        ActuatorAware::with_lag(&self.table.gain, board, self.table.lag)
    }

    /// What the vehicle can be asked for by laws of thrust and body rates.
    pub const fn limits(&self) -> Limits {
        self.table.head.limits
    }

    /// The table, to be looked at or written.
    pub const fn table(&self) -> &ActuatorTable {
        &self.table
    }
}
