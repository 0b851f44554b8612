//! Laws beside each other on one scenario: flights in; one table, and the curves of a picture, out.

use std::fmt;

use serde::Serialize;

use crate::flight::rigid_loop::RigidFlight;

/// The schema that the file states.
pub const SCHEMA: &str = "quatrack/compare/1";

/// One law's flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The law.
    pub law: String,
    /// Sum of the position error's norm over samples of 10 ms, times 10 ms, m s; nothing for a flight that was lost.
    pub iae_m_s: Option<f64>,
    /// Largest position error while it was measured, m.
    pub max_error_m: f64,
    /// Whether the craft was lost.
    pub lost: bool,
}

/// All of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Table {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// The laws in the order in which they flew.
    pub rows: Vec<Row>,
}

impl Table {
    /// The comparison of named flights.
    pub fn of(flights: &[(String, RigidFlight)]) -> Self {
        let rows = flights.iter().map(|(law, flight)| Row {
            law: law.clone(),
            iae_m_s: flight.iae_m_s(),
            max_error_m: flight.max_error_m(),
            lost: flight.lost.is_some(),
        });
        Self { schema: SCHEMA, rows: rows.collect() }
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.rows.iter().map(|row| row.law.len()).max().unwrap_or(0).max(4);
        writeln!(f, "{:<width$}{:>12}{:>12}", "law", "IAE, m s", "most, m")?;
        for Row { law, iae_m_s, max_error_m, .. } in &self.rows {
            let iae = iae_m_s.map_or_else(|| "lost".to_owned(), |iae| format!("{iae:.4}"));
            writeln!(f, "{law:<width$}{iae:>12}{max_error_m:>12.4}")?;
        }
        Ok(())
    }
}
