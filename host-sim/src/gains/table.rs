//! A table of any kind that a design gives: rows and head in, bytes out, and back.

use quatrack::gains::table::{
    ACTUATOR_TABLE_BYTES, ActuatorTable, GainTable, TABLE_BYTES_MAX, TableError, TableHead, TableKind,
};

/// A table as a board loads it.
#[derive(Debug, Clone, PartialEq)]
pub enum Table {
    /// For the laws of thrust and body rates.
    Gains(Box<GainTable>),
    /// For the law of motor forces.
    Actuator(Box<ActuatorTable>),
}

impl Table {
    /// Reads a file.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TableError> {
        match ActuatorTable::from_bytes(bytes) {
            Err(TableError::OtherKind { .. }) => GainTable::from_bytes(bytes).map(|table| Self::Gains(Box::new(table))),
            read => read.map(|table| Self::Actuator(Box::new(table))),
        }
    }

    /// The file; nothing where the format has no room for it.
    pub fn to_bytes(&self) -> Option<Vec<u8>> {
        let mut buffer =
            [0; if TABLE_BYTES_MAX > ACTUATOR_TABLE_BYTES { TABLE_BYTES_MAX } else { ACTUATOR_TABLE_BYTES }];
        let bytes = match self {
            Self::Gains(table) => table.to_bytes(&mut buffer),
            Self::Actuator(table) => table.to_bytes(&mut buffer),
        };
        bytes.map(<[u8]>::to_vec)
    }

    /// What it says beside its gains.
    pub fn head(&self) -> &TableHead {
        match self {
            Self::Gains(table) => table.head(),
            Self::Actuator(table) => table.head(),
        }
    }

    /// Which law it is for.
    pub fn kind(&self) -> TableKind {
        match self {
            Self::Gains(table) => table.kind(),
            Self::Actuator(_) => TableKind::ActuatorAware,
        }
    }

    /// Lag of the motors that it reckons with, s; none for laws that know of none.
    pub fn motor_lag_s(&self) -> Option<f32> {
        match self {
            Self::Gains(_) => None,
            Self::Actuator(table) => Some(table.lag().lag_s()),
        }
    }

    /// Its gain, each row a list.
    pub fn by_rows(&self) -> Vec<Vec<f32>> {
        let columns = usize::from(self.kind().dimensions().1);
        let listed = |entries: &[f32]| entries.chunks(columns).map(<[f32]>::to_vec).collect();
        match self {
            Self::Gains(table) => listed(table.rows().entries()),
            Self::Actuator(table) => listed(table.gain().gain().rows().as_flattened()),
        }
    }
}
