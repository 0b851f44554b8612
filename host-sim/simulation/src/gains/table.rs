//! A table of any kind that a design gives: rows and head in, bytes out, and back.

use quatrack::gains::table::{
    ACTUATOR_TABLE_BYTES, ActuatorTable, GainTable, SCHEDULE_BYTES_MAX, ScheduleRows, ScheduleTable, TABLE_BYTES_MAX,
    TableError, TableHead, TableKind,
};

/// A table as a board loads it.
#[derive(Debug, Clone, PartialEq)]
pub enum Table {
    /// For the laws of thrust and body rates.
    Gains(Box<GainTable>),
    /// For the law of motor forces.
    Actuator(Box<ActuatorTable>),
    /// Gains over time, which the core reads where they stand.
    OverTime(Box<OverTime>),
}

/// Gains over time with the file that they stand in.
#[derive(Debug, Clone, PartialEq)]
pub struct OverTime {
    head: TableHead,
    bytes: Vec<u8>,
    /// Checksum of the trajectory that they are for.
    pub trajectory: u32,
    /// Control steps from one knot to the next.
    pub steps_per_knot: u16,
    /// A gain at each knot.
    pub gains: Vec<[[f32; 9]; 4]>,
}

impl Table {
    /// Reads a file.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TableError> {
        match TableKind::of(bytes)? {
            TableKind::ActuatorAware => ActuatorTable::from_bytes(bytes).map(|table| Self::Actuator(Box::new(table))),
            TableKind::AlongTrajectory => {
                ScheduleTable::from_bytes(bytes).map(|table| Self::of_schedule(&table, bytes))
            }
            _ => GainTable::from_bytes(bytes).map(|table| Self::Gains(Box::new(table))),
        }
    }

    /// Writes gains over time.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn over_time(head: TableHead, rows: &ScheduleRows<'_>) -> Result<Self, TableError> {
        let mut buffer = [0; SCHEDULE_BYTES_MAX];
        let bytes = ScheduleTable::write(&mut buffer, &head, rows)?.bytes().to_vec();
        ScheduleTable::from_bytes(&bytes).map(|table| Self::of_schedule(&table, &bytes))
    }

    fn of_schedule(table: &ScheduleTable<'_>, bytes: &[u8]) -> Self {
        let schedule = table.schedule();
        Self::OverTime(Box::new(OverTime {
            head: *table.head(),
            bytes: bytes.to_vec(),
            trajectory: schedule.trajectory(),
            steps_per_knot: schedule.steps_per_knot(),
            gains: (0..schedule.knots()).filter_map(|knot| schedule.gain(knot)).collect(),
        }))
    }

    /// The file; nothing where the format has no room for it.
    pub fn to_bytes(&self) -> Option<Vec<u8>> {
        let mut buffer =
            [0; if TABLE_BYTES_MAX > ACTUATOR_TABLE_BYTES { TABLE_BYTES_MAX } else { ACTUATOR_TABLE_BYTES }];
        let bytes = match self {
            Self::Gains(table) => table.to_bytes(&mut buffer),
            Self::Actuator(table) => table.to_bytes(&mut buffer),
            Self::OverTime(table) => Some(&*table.bytes),
        };
        bytes.map(<[u8]>::to_vec)
    }

    /// What it says beside its gains.
    pub fn head(&self) -> &TableHead {
        match self {
            Self::Gains(table) => table.head(),
            Self::Actuator(table) => table.head(),
            Self::OverTime(table) => &table.head,
        }
    }

    /// Which law it is for.
    pub fn kind(&self) -> TableKind {
        match self {
            Self::Gains(table) => table.kind(),
            Self::Actuator(_) => TableKind::ActuatorAware,
            Self::OverTime(_) => TableKind::AlongTrajectory,
        }
    }

    /// Lag of the motors that it reckons with, s; none for laws that know of none.
    pub fn motor_lag_s(&self) -> Option<f32> {
        match self {
            Self::Gains(_) | Self::OverTime(_) => None,
            Self::Actuator(table) => Some(table.lag().lag_s()),
        }
    }

    /// Its gain, each row a list; of gains over time the rows of one knot after those of the other.
    pub fn by_rows(&self) -> Vec<Vec<f32>> {
        let columns = usize::from(self.kind().dimensions().1);
        let listed = |entries: &[f32]| entries.chunks(columns).map(<[f32]>::to_vec).collect();
        match self {
            Self::Gains(table) => listed(table.rows().entries()),
            Self::Actuator(table) => listed(table.gain().gain().rows().as_flattened()),
            Self::OverTime(table) => listed(table.gains.as_flattened().as_flattened()),
        }
    }
}
