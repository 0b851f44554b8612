//! One flight of one law: its outcome and figures, and the same as a line of a table.

use quatrack_simulation::scenario::Law;

/// The outcome of a flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Flown to its end.
    Flown,
    /// Lost on the way.
    Lost,
    /// Never flown: the drawn figures have no sense together, or the law refuses them.
    Refused,
}

impl Outcome {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Flown => "flown",
            Self::Lost => "lost",
            Self::Refused => "refused",
        }
    }

    fn of_name(name: &str) -> Option<Self> {
        [Self::Flown, Self::Lost, Self::Refused].into_iter().find(|outcome| outcome.name() == name)
    }
}

/// One flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The run's number.
    pub run: u64,
    /// The law.
    pub law: Law,
    /// Seed of its noise and gusts.
    pub seed: u64,
    /// Its outcome.
    pub outcome: Outcome,
    /// Position error's norm over samples of 10 ms, times 10 ms, m s; of a flight to its end.
    pub iae_m_s: Option<f64>,
    /// Largest position error while it was measured, m; none where it was not flown.
    pub max_error_m: Option<f64>,
    /// Control steps with a motor at its limit.
    pub saturated_steps: Option<u64>,
    /// When it was lost, s since its start.
    pub lost_s: Option<f64>,
    /// Why it was lost or refused.
    pub reason: String,
    /// The drawn figures, in the campaign's order.
    pub drawn: Vec<f64>,
}

/// Columns before the drawn figures.
pub const FIXED: [&str; 9] =
    ["run", "law", "seed", "outcome", "iae_m_s", "max_error_m", "saturated_steps", "lost_s", "reason"];

/// The header: the columns of every row, and the drawn figures by name.
pub fn header(drawn: &[String]) -> Vec<String> {
    FIXED.iter().map(|name| (*name).to_owned()).chain(drawn.iter().cloned()).collect()
}

fn written<T: ToString>(value: Option<T>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

fn read<T: std::str::FromStr>(text: &str) -> Option<Option<T>> {
    if text.is_empty() { Some(None) } else { text.parse().ok().map(Some) }
}

impl Row {
    /// Its cells. Numbers have as many digits as bring them back to the bit.
    pub fn cells(&self) -> Vec<String> {
        let mut cells = vec![
            self.run.to_string(),
            self.law.name().to_owned(),
            self.seed.to_string(),
            self.outcome.name().to_owned(),
            written(self.iae_m_s),
            written(self.max_error_m),
            written(self.saturated_steps),
            written(self.lost_s),
            self.reason.clone(),
        ];
        cells.extend(self.drawn.iter().map(f64::to_string));
        cells
    }

    /// From its cells; nothing where they are no row.
    pub fn of_cells(cells: &csv::StringRecord) -> Option<Self> {
        Some(Self {
            run: cells.get(0)?.parse().ok()?,
            law: cells.get(1)?.parse().ok()?,
            seed: cells.get(2)?.parse().ok()?,
            outcome: Outcome::of_name(cells.get(3)?)?,
            iae_m_s: read(cells.get(4)?)?,
            max_error_m: read(cells.get(5)?)?,
            saturated_steps: read(cells.get(6)?)?,
            lost_s: read(cells.get(7)?)?,
            reason: cells.get(8)?.to_owned(),
            drawn: cells.iter().skip(FIXED.len()).map(|cell| cell.parse().ok()).collect::<Option<_>>()?,
        })
    }

    /// As lines of CSV, each ended by a line feed.
    pub fn to_csv(rows: &[Self]) -> Vec<u8> {
        let mut writer = csv::WriterBuilder::new().from_writer(Vec::new());
        for row in rows {
            // Writing to memory does not fail.
            let _ = writer.write_record(row.cells());
        }
        writer.into_inner().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_comes_back_to_the_bit() {
        let row = Row {
            run: 12,
            law: Law::Lee,
            seed: (1 << 53) - 1,
            outcome: Outcome::Lost,
            iae_m_s: None,
            max_error_m: Some(0.1 + 0.2),
            saturated_steps: Some(3),
            lost_s: Some(1e-3),
            reason: "a, \"b\"".to_owned(),
            drawn: vec![1.0 / 3.0, -0.0, 1e-300],
        };
        let bytes = Row::to_csv(std::slice::from_ref(&row));
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(bytes.as_slice());
        let back = Row::of_cells(&reader.records().next().unwrap().unwrap()).unwrap();
        assert_eq!(back, row);
        assert!(back.drawn[1].is_sign_negative());
    }
}
