//! A log and a map in; each quantity as a stream of clean samples in SI out, or which column is none.

use super::Notes;
use super::clean::{Removed, Stream};
use crate::IdentifyError;
use crate::filter::{median, quantile};
use crate::log::{ColumnMap, RawLog, Scalar, Series, Vector};

/// Whatever a sensor may show.
const ANY: [f64; 2] = [-1e9, 1e9];
/// Samples of a stream, at least.
const LEAST: usize = 100;
/// Samples further apart than this are of no use, s: a motor's lag is 20 to 130 ms.
const APART_S: f64 = 0.05;
/// No battery of a small craft has less or more, V.
const BATTERY_V: [f64; 2] = [2.0, 60.0];
/// Commands that stay below this share of a full one carry nothing.
const CARRIES: f64 = 0.05;

/// All that a map names and a log has.
pub(super) struct Streams {
    pub(super) gyro: Stream,
    pub(super) force: Stream,
    pub(super) motors: Stream,
    pub(super) attitude: Stream,
    pub(super) position: Option<Stream>,
    pub(super) velocity: Option<Stream>,
    pub(super) voltage: Option<Stream>,
    pub(super) estimate: Option<Stream>,
}

impl Streams {
    /// Of a log by a map.
    pub(super) fn of(log: &RawLog, map: &ColumnMap, notes: &mut Notes) -> Result<Self, IdentifyError> {
        let mut reader = Reader { log, times_s: times_s(log, map)?, notes };
        let (gyro, frozen) = reader.sensor(&map.gyroscope, "gyroscope", true)?.without_frozen();
        if frozen > 0 {
            reader.note(&format!("gyroscope: {frozen} samples stand still, as no gyroscope does; left out"));
        }
        if gyro.times_s.len() < LEAST {
            return Err(
                reader.format("gyroscope: it stands still, as none does in flight; the log is frozen".to_owned())
            );
        }
        let force = reader.sensor(&map.accelerometer, "accelerometer", false)?;
        let motors = reader.motors(map)?;
        let attitude = reader.stream(&map.attitude.columns, 1.0, "attitude")?;
        reader.changes(&attitude, &map.attitude.columns, "attitude")?;
        let attitude = reader.attitude(attitude, map)?;
        let position = map.position.as_ref().map(|v| reader.sensor(v, "position", true)).transpose()?;
        // A velocity that the map names and the log does not have is had from the position.
        let has_velocity = |v: &&Vector| position.is_none() || v.columns.iter().all(|c| log.series.contains_key(c));
        let velocity = map.velocity.as_ref().filter(has_velocity);
        let velocity = velocity.map(|v| reader.sensor(v, "velocity", false)).transpose()?;
        if velocity.is_none() && position.is_none() {
            return Err(reader.format("neither velocity nor position: log one of them".to_owned()));
        }
        let voltage = map.voltage.as_ref().and_then(|v| reader.voltage(v));
        let estimate = map.estimate.as_ref().and_then(|v| reader.stream(&v.columns, si(&v.unit), "estimate").ok());
        let estimate = estimate.map(|stream| stream.cleaned(ANY, true).0).filter(|s| s.times_s.len() > LEAST);
        Ok(Self { gyro, force, motors, attitude, position, velocity, voltage, estimate })
    }
}

/// SI of a unit that the map has checked.
pub(super) fn si(unit: &str) -> f64 {
    crate::log_scale(unit).unwrap_or(1.0)
}

/// Of the rows of a table; none where every variable has its own.
fn times_s(log: &RawLog, map: &ColumnMap) -> Result<Option<Vec<f64>>, IdentifyError> {
    match (&map.time, log.timed) {
        (_, true) => Ok(None),
        (Some(time), false) => {
            let column = log.series.get(&time.column).ok_or_else(|| missing(log, &time.column, "time"))?;
            Ok(Some(column.values.iter().map(|value| si(&time.unit) * value).collect()))
        }
        (None, false) => {
            let reason = "this log is a table and the map has no [time]; only a micro SD deck's log goes without";
            Err(IdentifyError::Format { path: log.name.clone(), reason: reason.to_owned() })
        }
    }
}

fn missing(log: &RawLog, column: &str, quantity: &'static str) -> IdentifyError {
    let names: Vec<&str> = log.series.keys().take(8).map(String::as_str).collect();
    let present = if log.series.len() > 8 { names.join(", ") + ", .." } else { names.join(", ") };
    IdentifyError::Column { path: log.name.clone(), column: column.to_owned(), quantity, present }
}

struct Reader<'a> {
    log: &'a RawLog,
    /// Of the rows of a table, s.
    times_s: Option<Vec<f64>>,
    notes: &'a mut Notes,
}

impl Reader<'_> {
    fn format(&self, reason: String) -> IdentifyError {
        IdentifyError::Format { path: self.log.name.clone(), reason }
    }

    fn note(&mut self, note: &str) {
        self.notes.0.push(format!("{}: {note}", self.log.name));
    }

    fn stream(&self, columns: &[String], scale: f64, quantity: &'static str) -> Result<Stream, IdentifyError> {
        let mut stream = Stream::default();
        for column in columns {
            let series: &Series = self.log.series.get(column).ok_or_else(|| missing(self.log, column, quantity))?;
            if stream.channels.is_empty() {
                stream.times_s = match &self.times_s {
                    Some(times_s) => times_s.clone(),
                    None => series.times.iter().map(|time_ms| 1e-3 * time_ms).collect(),
                };
            }
            if series.values.len() != stream.times_s.len() {
                return Err(self.format(format!(
                    "{column} has another number of samples than {}; log them in one event",
                    columns[0]
                )));
            }
            stream.channels.push(series.values.iter().map(|value| scale * value).collect());
        }
        Ok(stream)
    }

    fn sensor(&mut self, of: &Vector, quantity: &'static str, outliers: bool) -> Result<Stream, IdentifyError> {
        let stream = self.stream(&of.columns, si(&of.unit), quantity)?;
        self.changes(&stream, &of.columns, quantity)?;
        self.clean(stream, ANY, outliers, quantity)
    }

    fn motors(&mut self, map: &ColumnMap) -> Result<Stream, IdentifyError> {
        let (quantity, full) = ("motor commands", map.motors.full);
        let stream = self.stream(&map.motors.columns, 1.0 / full, quantity)?;
        self.changes(&stream, &map.motors.columns, quantity)?;
        let all: Vec<f64> = stream.channels.iter().flatten().copied().collect();
        let (most, usual) = (quantile(&all, 0.99), quantile(&all, 0.9));
        // A craft hovers at a third of a full command or more.
        if usual > 1.5 || most < CARRIES {
            return Err(self.format(format!(
                "motor commands reach {:.4} where the map's full command is {full}: mend motors.full (65535 for a PWM, 1 for a \
                 share, 100 for percent), or leave this log out if nothing flies in it",
                full * most
            )));
        }
        self.clean(stream, [0.0, 1.0 + 1e-6], false, quantity)
    }

    /// Quaternions have a length of 1.
    fn attitude(&mut self, stream: Stream, map: &ColumnMap) -> Result<Stream, IdentifyError> {
        let stream = self.clean(stream, ANY, false, "attitude")?;
        if stream.channels.len() == 4 {
            let length = |i: usize| stream.channels.iter().map(|channel| channel[i].powi(2)).sum::<f64>().sqrt();
            let lengths: Vec<f64> = (0..stream.times_s.len()).map(length).collect();
            let usual = median(&lengths);
            if !(0.9..1.1).contains(&usual) {
                return Err(self.format(format!(
                    "attitude: {} have a length of {usual:.3}; a quaternion's is 1: check the map's columns, and unpack what was \
                     packed",
                    map.attitude.columns.join(", ")
                )));
            }
            let near: Vec<bool> = lengths.iter().map(|length| (0.8..1.2).contains(length)).collect();
            return Ok(stream.only(&near));
        }
        Ok(stream)
    }

    /// Where it is one: a log goes without.
    fn voltage(&mut self, of: &Scalar) -> Option<Stream> {
        let mut stream = self.stream(std::slice::from_ref(&of.column), si(&of.unit), "voltage").ok()?;
        let usual = median(&stream.channels[0]);
        let fits = |value: f64| (BATTERY_V[0]..=BATTERY_V[1]).contains(&value);
        if !fits(usual) && stream.channels[0].iter().any(|value| value.is_finite()) {
            let (factor, unit) = if fits(1e-3 * usual) { (1e-3, "mV") } else { (1e3, "V") };
            if !fits(factor * usual) {
                self.note(&format!("voltage: {usual:.4} V is no battery's; left out"));
                return None;
            }
            self.note(&format!("voltage: {} is in {unit}, not in {} as the map has it; taken so", of.column, of.unit));
            stream.channels[0].iter_mut().for_each(|value| *value *= factor);
        }
        Some(stream.cleaned(BATTERY_V, false).0).filter(|stream| stream.times_s.len() > 1)
    }

    /// A sensor that is logged changes; a column of one number is no sensor.
    fn changes(&self, stream: &Stream, columns: &[String], quantity: &str) -> Result<(), IdentifyError> {
        for (column, channel) in columns.iter().zip(&stream.channels) {
            let mut numbers = channel.iter().filter(|value| value.is_finite());
            let Some(first) = numbers.next() else {
                return Err(self.format(format!("{quantity}: {column} has no number in it; check the map's columns")));
            };
            if numbers.all(|value| value == first) {
                return Err(self.format(format!(
                    "{quantity}: {column} is {first} all along; what is logged in flight changes: check the map's columns"
                )));
            }
        }
        Ok(())
    }

    fn clean(
        &mut self,
        stream: Stream,
        range: [f64; 2],
        outliers: bool,
        quantity: &str,
    ) -> Result<Stream, IdentifyError> {
        let (clean, Removed { missing, stamps, out_of_range, outliers, repeats, of }) = stream.cleaned(range, outliers);
        if out_of_range > 0 || outliers > 0 {
            self.note(&format!(
                "{quantity}: {out_of_range} samples out of range and {outliers} outliers of {of} left out"
            ));
        }
        // Where two blocks share a file, half of the cells of each are empty.
        if missing * 50 > of && missing * 3 < of {
            self.note(&format!("{quantity}: {missing} of {of} samples missing"));
        }
        if stamps * 50 > of {
            self.note(&format!(
                "{quantity}: {stamps} of {of} samples have the time of one before them, or an earlier one; left out"
            ));
        }
        if repeats * 100 > of {
            self.note(&format!("{quantity}: {:.0} % of the samples are repeats", 100.0 * repeats as f64 / of as f64));
        }
        if out_of_range * 20 > of {
            return Err(self.format(format!(
                "{quantity}: {out_of_range} of {of} samples are out of range ({} to {}); check the map's columns and units, or leave \
                 this log out",
                range[0], range[1]
            )));
        }
        if clean.times_s.len() < LEAST {
            let good = clean.times_s.len();
            return Err(self.format(format!("{quantity}: {good} good samples; {LEAST} are the least")));
        }
        let apart_s = clean.period_s();
        if apart_s > APART_S {
            return Err(self.format(format!(
                "{quantity}: a sample every {apart_s:.3} s; one every {APART_S} s is the least that tells a motor's lag: log faster, \
                 or check the unit of the time"
            )));
        }
        Ok(clean)
    }
}
