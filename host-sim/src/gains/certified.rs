//! A design carried out: design in; gains, certificate and table out, or the figure that fails.

use quatrack::gains::table::{
    GainTable, Hash, Name, SCHEDULE_BYTES_MAX, ScheduleRows, ScheduleTable, TABLE_BYTES_MAX, TableError, TableHead,
    Vehicle,
};
use serde::Serialize;

use super::GainsError;
use super::design::{Design, Problem};
use super::designed::{Designed, TableRows};
use super::statement::{Statement, sha256};
use crate::certify::{Certificate, Minimum, require};

/// A design with its gains, and what they promise.
#[derive(Debug, Clone)]
pub struct Certified {
    /// The design.
    pub design: Design,
    /// SHA-256 of what the design asks for.
    pub design_hash: Hash,
    /// Its gains in f64.
    pub designed: Designed,
    /// Every figure of the gains as rounded to f32.
    pub certificate: Certificate,
    /// What the table says of them.
    pub statement: Statement,
    /// The table; none where no law on board flies the gains, as those that remember past commands.
    pub table: Option<Table>,
}

/// A table that a board loads.
#[derive(Debug, Clone, PartialEq)]
pub enum Table {
    /// One gain.
    Fixed(Box<GainTable>),
    /// Gains over time, which the core reads where they stand.
    OverTime {
        /// What it says beside the gains.
        head: TableHead,
        /// The whole of it.
        bytes: Vec<u8>,
    },
}

/// What the hash of a design is taken of: all that its gains, its limits and its acceptance depend on.
#[derive(Debug, Serialize)]
pub(super) struct Essence<'a> {
    vehicle: String,
    vehicle_id: String,
    linearisation: &'static str,
    method: &'static str,
    parameters: &'a Problem,
    control_rate_hz: u32,
    rate_loop_gain_1_s: Option<f64>,
    thrust_m_s2: [f32; 2],
    body_rates_max_rad_s: [f32; 3],
    minimum: &'a Minimum,
}

impl Design {
    /// Computes the gains, certifies them as rounded to f32 and holds them against the design's own minimum.
    ///
    /// # Errors
    /// [`GainsError::Design`] and [`GainsError::Certify`] where there is nothing to certify; [`GainsError::Minimum`]
    /// with the first figure that falls short; [`GainsError::Table`] for gains that the core refuses.
    pub fn certify(&self) -> Result<Certified, GainsError> {
        let designed = Designed::of(self)?;
        let certificate = designed.certify(self)?;
        require(&certificate, &self.minimum)?;
        let design_hash = sha256(&self.essence());
        let statement = Statement::new(self, &design_hash, &designed, &certificate);
        let head = TableHead {
            name: self.name,
            vehicle: self.table_vehicle()?,
            rate: self.rate,
            limits: self.limits,
            design_hash,
            certificate: statement.on_board(),
        };
        let table = if designed.past_command_gains.is_empty() {
            Some(self.table(head, &designed.gains.rows()).map_err(GainsError::Table)?)
        } else {
            None
        };
        Ok(Certified { design: self.clone(), design_hash, designed, certificate, statement, table })
    }

    fn table(&self, head: TableHead, rows: &TableRows) -> Result<Table, TableError> {
        let gains = match rows {
            TableRows::Fixed(rows) => return Ok(Table::Fixed(Box::new(GainTable::new(head, rows)?))),
            TableRows::OverTime(gains) => gains,
        };
        let (trajectory, steps_per_knot) = self.problem.schedule().unwrap_or_default();
        let rows = ScheduleRows { trajectory, steps_per_knot, gains };
        let mut buffer = [0; SCHEDULE_BYTES_MAX];
        let bytes = ScheduleTable::write(&mut buffer, &head, &rows)?.bytes().to_vec();
        Ok(Table::OverTime { head, bytes })
    }

    pub(super) fn essence(&self) -> Essence<'_> {
        let rates = self.limits.body_rates_max_rad_s();
        let (linearisation, method) = self.problem.named();
        Essence {
            vehicle: self.vehicle.name().to_owned(),
            vehicle_id: format!("{:08x}", self.vehicle.id()),
            linearisation,
            method,
            parameters: &self.problem,
            control_rate_hz: self.rate.hz(),
            rate_loop_gain_1_s: self.rate_loop_gain_1_s,
            thrust_m_s2: [self.limits.thrust_min_m_s2(), self.limits.thrust_max_m_s2()],
            body_rates_max_rad_s: [rates.x, rates.y, rates.z],
            minimum: &self.minimum,
        }
    }

    fn table_vehicle(&self) -> Result<Vehicle, GainsError> {
        let name = Name::new(self.vehicle.name()).map_err(|error| GainsError::Vehicle {
            vehicle: self.vehicle.name().to_owned(),
            reason: error.to_string(),
        })?;
        Ok(Vehicle { name, id: self.vehicle.id() })
    }
}

impl Certified {
    /// The table as a file; nothing where there is none.
    pub fn to_bytes(&self) -> Option<Vec<u8>> {
        match self.table.as_ref()? {
            Table::Fixed(table) => table.to_bytes(&mut [0; TABLE_BYTES_MAX]).map(<[u8]>::to_vec),
            Table::OverTime { bytes, .. } => Some(bytes.clone()),
        }
    }
}

impl Table {
    /// What it says beside the gains.
    pub fn head(&self) -> &TableHead {
        match self {
            Self::Fixed(table) => table.head(),
            Self::OverTime { head, .. } => head,
        }
    }
}
