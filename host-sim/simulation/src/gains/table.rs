//! A table of any kind that a design gives: rows and head in, bytes out, and back.

use quatrack::gains::table::{
    CascadeTable, GainTable, Rows, ScheduleRows, TABLE_BYTES_MAX, TableError, TableHead, TableKind,
};

/// A table as a board loads it: a file that has been read, of any kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    bytes: Vec<u8>,
    head: TableHead,
    kind: TableKind,
    motor_lag_s: Option<f32>,
    /// Of a table along a trajectory.
    along: Option<Along>,
    cascade: Option<CascadeTable>,
    by_rows: Vec<Vec<f32>>,
}

/// Gains over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Along {
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
        let table = GainTable::from_bytes(bytes)?;
        let along = table.schedule().map(|schedule| Along {
            trajectory: schedule.trajectory(),
            steps_per_knot: schedule.steps_per_knot(),
            gains: (0..schedule.knots()).filter_map(|knot| schedule.gain(knot)).collect(),
        });
        let columns = usize::from(table.kind().dimensions().1);
        let listed = |entries: &[f32]| entries.chunks(columns).map(<[f32]>::to_vec).collect();
        let by_rows = match (&along, table.rows()) {
            (Some(along), _) => listed(along.gains.as_flattened().as_flattened()),
            (None, Some(rows)) => listed(rows.entries()),
            (None, None) => table.cascade().map_or_else(Vec::new, |cascade| listed(&cascade.gains.numbers())),
        };
        Ok(Self {
            bytes: bytes.to_vec(),
            head: *table.head(),
            kind: table.kind(),
            motor_lag_s: table.lag().map(quatrack::MotorLag::lag_s),
            along,
            cascade: table.cascade().copied(),
            by_rows,
        })
    }

    /// Writes a table of one gain.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn new(head: TableHead, rows: &Rows) -> Result<Self, TableError> {
        let table = GainTable::new(head, rows)?;
        Self::from_bytes(table.to_bytes(&mut [0; TABLE_BYTES_MAX]).unwrap_or_default())
    }

    /// Writes one of the cascade.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn of_cascade(head: TableHead, cascade: &CascadeTable) -> Result<Self, TableError> {
        let table = GainTable::of_cascade(head, cascade)?;
        Self::from_bytes(table.to_bytes(&mut [0; TABLE_BYTES_MAX]).unwrap_or_default())
    }

    /// Writes gains over time.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn over_time(head: &TableHead, rows: &ScheduleRows<'_>) -> Result<Self, TableError> {
        let mut buffer = [0; TABLE_BYTES_MAX];
        let table = GainTable::along(&mut buffer, head, rows)?;
        Self::from_bytes(table.to_bytes(&mut [0; TABLE_BYTES_MAX]).unwrap_or_default())
    }

    /// The file.
    pub fn to_bytes(&self) -> Option<Vec<u8>> {
        Some(self.bytes.clone())
    }

    /// Its head: all but the gains.
    pub fn head(&self) -> &TableHead {
        &self.head
    }

    /// The law that it is for.
    pub fn kind(&self) -> TableKind {
        self.kind
    }

    /// Lag of the motors that it reckons with, s; none for laws that know of none.
    pub fn motor_lag_s(&self) -> Option<f32> {
        self.motor_lag_s
    }

    /// The gains over time, if that is its kind.
    pub fn along(&self) -> Option<&Along> {
        self.along.as_ref()
    }

    /// The cascade's fields, if that is its kind.
    pub fn cascade(&self) -> Option<&CascadeTable> {
        self.cascade.as_ref()
    }

    /// Its gain, each row a list; of gains over time the rows of one knot after those of the other.
    pub fn by_rows(&self) -> &[Vec<f32>] {
        &self.by_rows
    }
}
