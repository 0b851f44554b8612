//! Takes that share a file: a table whose clock jumps in; one log for each take out.

use super::{ColumnMap, RawLog, Series, scale};

/// A clock that goes back by more began anew, s; streams that were put together are out of order by less.
const BACK_S: f64 = 1.0;
/// A longer pause is between two flights, s.
const PAUSE_S: f64 = 10.0;

impl RawLog {
    /// The takes of a table, by its clock; a log of one take, and one whose variables have times of their own, as it is.
    pub fn takes(mut self, map: &ColumnMap) -> Vec<Self> {
        let Some(time) = map.time.as_ref().filter(|_| !self.timed) else { return vec![self] };
        let (Some(column), Some(si)) = (self.series.get(&time.column), scale(&time.unit)) else { return vec![self] };
        let begins = begins(&column.values, si);
        let count = begins.len() + 1;
        let mut takes = Vec::with_capacity(count);
        for (k, row) in begins.into_iter().enumerate().rev() {
            let split = |series: &mut Series| Series { times: Vec::new(), values: series.values.split_off(row) };
            let series = self.series.iter_mut().map(|(name, series)| (name.clone(), split(series))).collect();
            takes.push(Self { name: format!("{}, take {} of {count}", self.name, k + 2), series, timed: false });
        }
        if count > 1 {
            self.name = format!("{}, take 1 of {count}", self.name);
        }
        takes.push(self);
        takes.reverse();
        takes
    }
}

/// Rows that a take begins with, but for the first.
fn begins(times: &[f64], si: f64) -> Vec<usize> {
    let mut begins = Vec::new();
    let mut before: Option<f64> = None;
    for (row, time) in times.iter().enumerate().filter(|(_, time)| time.is_finite()) {
        let passed_s = before.map_or(0.0, |before| si * (time - before));
        if !(-BACK_S..=PAUSE_S).contains(&passed_s) {
            begins.push(row);
        }
        before = Some(*time);
    }
    begins
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::parse_csv;

    #[test]
    fn a_clock_that_begins_anew_or_pauses_begins_a_take() {
        let mut text = String::from("timestamp,x\n");
        let starts_ms = [0, 500, 30_000];
        for (take, start) in starts_ms.into_iter().enumerate() {
            for k in 0..200 {
                // The first take runs to 2 s, the second begins at 0.5 s and ends at 2.5 s, the third after 27 s.
                text += &format!("{},{}\n", start + 10 * k, 1000 * take + k);
            }
        }
        let map = ColumnMap::built_in("cflib").unwrap();
        let takes = parse_csv(text.as_bytes(), "log.csv").unwrap().takes(&map);
        let firsts: Vec<f64> = takes.iter().map(|take| take.series["x"].values[0]).collect();
        let names: Vec<&str> = takes.iter().map(|take| take.name.as_str()).collect();
        assert_eq!(firsts, [0.0, 1000.0, 2000.0]);
        assert_eq!(names, ["log.csv, take 1 of 3", "log.csv, take 2 of 3", "log.csv, take 3 of 3"]);
        assert!(takes.iter().all(|take| take.series["x"].values.len() == 200));
    }
}
