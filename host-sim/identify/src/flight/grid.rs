//! Streams with their own times in; all of them on one grid of 100 Hz, with missing values marked, out.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::clean::{Removed, Stream};
use super::{Notes, RATE_HZ, STEP_S};
use crate::IdentifyError;
use crate::log::{ColumnMap, RawLog, Series};

/// A gap that a line may bridge, s.
const BRIDGED_S: f64 = 0.055;
/// The voltage changes slowly and is logged so.
const VOLTAGE_BRIDGED_S: f64 = 5.0;

/// All signals of a log on one grid.
#[derive(Clone, Debug, Default)]
pub(super) struct Grid {
    pub(super) start_s: f64,
    pub(super) position: Vec<Vector3<f64>>,
    pub(super) velocity: Vec<Vector3<f64>>,
    pub(super) attitude: Vec<UnitQuaternion<f64>>,
    pub(super) gyro: Vec<Vector3<f64>>,
    pub(super) specific_force: Vec<Vector3<f64>>,
    pub(super) commands: [Vec<f64>; 4],
    pub(super) voltage: Vec<f64>,
    pub(super) estimate: Vec<Vector3<f64>>,
    /// Where nothing is missing on board, and in the pose.
    pub(super) on_board: Vec<bool>,
    pub(super) pose: Vec<bool>,
    pub(super) has_velocity: bool,
}

struct Reader<'a> {
    log: &'a RawLog,
    /// Times of the rows of a table, s.
    times_s: Option<Vec<f64>>,
    notes: &'a mut Notes,
}

impl Reader<'_> {
    fn series(&self, column: &str, quantity: &'static str) -> Result<(Vec<f64>, &Series), IdentifyError> {
        let series = self.log.series.get(column).ok_or_else(|| {
            let names: Vec<&str> = self.log.series.keys().take(8).map(String::as_str).collect();
            let present = if self.log.series.len() > 8 { names.join(", ") + ", .." } else { names.join(", ") };
            IdentifyError::Column { path: self.log.name.clone(), column: column.to_owned(), quantity, present }
        })?;
        let times_s = match &self.times_s {
            Some(times_s) => times_s.clone(),
            None => series.times.iter().map(|time_ms| 1e-3 * time_ms).collect(),
        };
        Ok((times_s, series))
    }

    fn stream(&self, columns: &[String], scale: f64, quantity: &'static str) -> Result<Stream, IdentifyError> {
        let mut stream = Stream::default();
        for column in columns {
            let (times_s, series) = self.series(column, quantity)?;
            if stream.times_s.is_empty() {
                stream.times_s = times_s;
            }
            if series.values.len() != stream.times_s.len() {
                let reason =
                    format!("{column} has another number of samples than {}; log them in one event", columns[0]);
                return Err(IdentifyError::Format { path: self.log.name.clone(), reason });
            }
            stream.channels.push(series.values.iter().map(|value| scale * value).collect());
        }
        Ok(stream)
    }

    fn clean(
        &mut self,
        stream: Stream,
        range: [f64; 2],
        outliers: bool,
        quantity: &str,
    ) -> Result<Stream, IdentifyError> {
        let (clean, Removed { missing, out_of_range, outliers, repeats, of }) = stream.cleaned(range, outliers);
        let name = &self.log.name;
        if out_of_range > 0 || outliers > 0 {
            self.notes.0.push(format!(
                "{name}: {quantity}: {out_of_range} samples out of range and {outliers} outliers of {of} left out"
            ));
        }
        // Where two blocks share a file, half of the cells of each are empty.
        if missing * 50 > of && missing * 3 < of {
            self.notes.0.push(format!("{name}: {quantity}: {missing} of {of} samples missing"));
        }
        if repeats * 100 > of {
            self.notes.0.push(format!(
                "{name}: {quantity}: {:.0} % of the samples are repeats",
                100.0 * repeats as f64 / of as f64
            ));
        }
        if out_of_range * 20 > of {
            let reason = format!(
                "{quantity}: {out_of_range} of {of} samples are out of range ({} to {}); check the map's columns and units, or leave this log out",
                range[0], range[1]
            );
            return Err(IdentifyError::Format { path: name.clone(), reason });
        }
        if clean.times_s.len() < 100 {
            let reason = format!("{quantity}: {} good samples; 100 are the least", clean.times_s.len());
            return Err(IdentifyError::Format { path: name.clone(), reason });
        }
        Ok(clean)
    }
}

/// SI of a unit that the map has checked.
fn si(unit: &str) -> f64 {
    crate::log_scale(unit).unwrap_or(1.0)
}

impl Grid {
    /// The grid of a log by a map.
    pub(super) fn of(log: &RawLog, map: &ColumnMap, notes: &mut Notes) -> Result<Self, IdentifyError> {
        let times_s = match (&map.time, log.timed) {
            (_, true) => None,
            (Some(time), false) => {
                let missing = |present: String| IdentifyError::Column {
                    path: log.name.clone(),
                    column: time.column.clone(),
                    quantity: "time",
                    present,
                };
                let column = log
                    .series
                    .get(&time.column)
                    .ok_or_else(|| missing(log.series.keys().take(8).cloned().collect::<Vec<_>>().join(", ")))?;
                Some(column.values.iter().map(|value| si(&time.unit) * value).collect())
            }
            (None, false) => {
                let reason =
                    "this log is a table and the map has no [time]; only a micro SD deck's log goes without".to_owned();
                return Err(IdentifyError::Format { path: log.name.clone(), reason });
            }
        };
        let mut reader = Reader { log, times_s, notes };
        const ANY: [f64; 2] = [-1e9, 1e9];
        let gyro = reader.stream(&map.gyroscope.columns, si(&map.gyroscope.unit), "the gyroscope")?;
        let gyro = reader.clean(gyro, ANY, true, "gyroscope")?;
        let force = reader.stream(&map.accelerometer.columns, si(&map.accelerometer.unit), "the accelerometer")?;
        let force = reader.clean(force, ANY, false, "accelerometer")?;
        let motors = reader.stream(&map.motors.columns, 1.0 / map.motors.full, "the motor commands")?;
        let motors = reader.clean(motors, [0.0, 1.0 + 1e-6], false, "motor commands")?;
        let attitude = reader.stream(&map.attitude.columns, 1.0, "the attitude")?;
        let attitude = reader.clean(attitude, ANY, false, "attitude")?;
        let position = match &map.position {
            Some(vector) => Some(reader.stream(&vector.columns, si(&vector.unit), "the position")?),
            None => None,
        };
        let position = position.map(|stream| reader.clean(stream, ANY, true, "position")).transpose()?;
        // A velocity that the map names and the log does not have is had from the position.
        let velocity = map.velocity.as_ref().and_then(|v| reader.stream(&v.columns, si(&v.unit), "the velocity").ok());
        let velocity = velocity.map(|stream| reader.clean(stream, ANY, false, "velocity")).transpose()?;
        if velocity.is_none() && position.is_none() {
            let reason = "neither velocity nor position: log one of them".to_owned();
            return Err(IdentifyError::Format { path: log.name.clone(), reason });
        }
        let voltage = map
            .voltage
            .as_ref()
            .and_then(|v| reader.stream(std::slice::from_ref(&v.column), si(&v.unit), "the voltage").ok());
        let voltage =
            voltage.map(|stream| stream.cleaned([0.5, 100.0], false).0).filter(|stream| stream.times_s.len() > 1);
        let estimate = map.estimate.as_ref().and_then(|v| reader.stream(&v.columns, si(&v.unit), "the estimate").ok());
        let estimate = estimate.map(|stream| stream.cleaned(ANY, true).0).filter(|stream| stream.times_s.len() > 100);

        let end = |of: fn(&[f64]) -> Option<f64>, all: &[&Stream]| -> Vec<f64> {
            all.iter().filter_map(|s| of(&s.times_s)).collect()
        };
        let all = [&gyro, &force, &motors, &attitude];
        let start_s = end(|t| t.first().copied(), &all).into_iter().fold(f64::NEG_INFINITY, f64::max);
        let end_s = end(|t| t.last().copied(), &all).into_iter().fold(f64::INFINITY, f64::min);
        // Two hours at most: a clock in another unit would take all memory.
        if !(end_s - start_s > 1.0 && end_s - start_s < 7200.0) {
            let reason = format!("from {start_s} to {end_s} s: a log has 1 to 7200 s; check the unit of its time");
            return Err(IdentifyError::Format { path: log.name.clone(), reason });
        }
        let count = ((end_s - start_s) * RATE_HZ) as usize + 1;
        let (g, g_good) = sampled(&gyro, start_s, count, BRIDGED_S);
        let (f, f_good) = sampled(&force, start_s, count, BRIDGED_S);
        let (m, m_good) = sampled(&motors, start_s, count, BRIDGED_S);
        let (q, q_good) = sampled(&attitude_stream(attitude, map), start_s, count, BRIDGED_S);
        let mut on_board: Vec<bool> = (0..count).map(|i| g_good[i] && f_good[i] && m_good[i]).collect();
        let mut pose = q_good;
        let vectors = |channels: &[Vec<f64>]| -> Vec<Vector3<f64>> {
            (0..count).map(|i| Vector3::new(channels[0][i], channels[1][i], channels[2][i])).collect()
        };
        let mut grid = Self {
            start_s,
            attitude: (0..count)
                .map(|i| UnitQuaternion::from_quaternion(Quaternion::new(q[3][i], q[0][i], q[1][i], q[2][i])))
                .collect(),
            gyro: vectors(&g),
            specific_force: vectors(&f),
            commands: [0, 1, 2, 3].map(|motor| m[motor].clone()),
            has_velocity: velocity.is_some(),
            ..Self::default()
        };
        if let Some(position) = &position {
            let (p, good) = sampled(position, start_s, count, BRIDGED_S);
            grid.position = vectors(&p);
            pose.iter_mut().zip(&good).for_each(|(pose, good)| *pose &= *good);
        }
        if let Some(velocity) = &velocity {
            let (v, good) = sampled(velocity, start_s, count, BRIDGED_S);
            grid.velocity = vectors(&v);
            pose.iter_mut().zip(&good).for_each(|(pose, good)| *pose &= *good);
        }
        if let Some(voltage) = &voltage {
            let (v, good) = sampled(voltage, start_s, count, VOLTAGE_BRIDGED_S);
            grid.voltage.clone_from(&v[0]);
            on_board.iter_mut().zip(&good).for_each(|(on, good)| *on &= *good);
        }
        if let Some(estimate) = &estimate {
            grid.estimate = vectors(&sampled(estimate, start_s, count, BRIDGED_S).0);
        }
        (grid.on_board, grid.pose) = (on_board, pose);
        Ok(grid)
    }

    /// The number of points.
    pub(super) fn len(&self) -> usize {
        self.gyro.len()
    }
}

/// Quaternions `x, y, z, w` without jumps of sign, from any form of the map.
fn attitude_stream(stream: Stream, map: &ColumnMap) -> Stream {
    let Stream { times_s, channels } = stream;
    let angle = map.attitude.unit.as_deref().map_or(1_f64.to_radians(), si);
    let mut out = vec![Vec::new(); 4];
    let mut before = Quaternion::identity();
    let mut rows: Vec<_> = channels.iter().map(|channel| channel.iter().copied()).collect();
    for _ in &times_s {
        let row: Vec<f64> = rows.iter_mut().filter_map(Iterator::next).collect();
        let value = |k: usize| row[k];
        let mut q = match map.attitude.form.as_str() {
            "xyzw" => Quaternion::new(value(3), value(0), value(1), value(2)),
            "wxyz" => Quaternion::new(value(0), value(1), value(2), value(3)),
            _ => {
                let pitch = if map.attitude.pitch_up_positive { -value(1) } else { value(1) };
                *UnitQuaternion::from_euler_angles(angle * value(0), angle * pitch, angle * value(2)).quaternion()
            }
        };
        if q.dot(&before) < 0.0 {
            q = -q;
        }
        before = q;
        for (out, value) in out.iter_mut().zip([q.i, q.j, q.k, q.w]) {
            out.push(value);
        }
    }
    Stream { times_s, channels: out }
}

/// A stream on the grid, by a line between samples; where samples are denser than the grid, by the mean of a step. With where it
/// may be believed.
fn sampled(stream: &Stream, start_s: f64, count: usize, bridged_s: f64) -> (Vec<Vec<f64>>, Vec<bool>) {
    let times = &stream.times_s;
    let last = times.len() - 1;
    let mut good = vec![false; count];
    let mut out = vec![vec![0.0; count]; stream.channels.len()];
    let (mut above, mut low) = (0, 0);
    for i in 0..count {
        let t = start_s + i as f64 * STEP_S;
        while above < last && times[above] < t {
            above += 1;
        }
        let below = above.saturating_sub(1);
        let gap = times[above] - times[below];
        good[i] = (gap <= bridged_s && t >= times[below] - 0.5 * bridged_s && t <= times[above] + 0.5 * bridged_s)
            || (t - times[above]).abs() < 1e-6;
        let share = if gap > 0.0 { ((t - times[below]) / gap).clamp(0.0, 1.0) } else { 0.0 };
        while low < last && times[low] < t - 0.5 * STEP_S {
            low += 1;
        }
        let mut high = low;
        while high <= last && times[high] <= t + 0.5 * STEP_S {
            high += 1;
        }
        for (out, channel) in out.iter_mut().zip(&stream.channels) {
            out[i] = if high > low + 2 {
                channel[low..high].iter().sum::<f64>() / (high - low) as f64
            } else {
                channel[below] + share * (channel[above] - channel[below])
            };
        }
    }
    (out, good)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sparse_samples_are_bridged_and_gaps_are_marked() {
        let times_s: Vec<f64> = (0..100).map(|i| 0.02 * f64::from(i)).filter(|t| !(0.5..0.7).contains(t)).collect();
        let stream = Stream { channels: vec![times_s.iter().map(|t| 3.0 * t).collect()], times_s };
        let (values, good) = sampled(&stream, 0.0, 190, BRIDGED_S);
        assert!((values[0][31] - 0.93).abs() < 1e-12 && good[31]);
        assert!(!good[60] && good[150]);
    }

    #[test]
    fn dense_samples_are_averaged() {
        let times_s: Vec<f64> = (0..1000).map(|i| 0.002 * f64::from(i)).collect();
        let noise = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
        let stream = Stream { channels: vec![(0..1000).map(noise).collect()], times_s };
        let (values, _) = sampled(&stream, 0.0, 190, BRIDGED_S);
        assert!(values[0][50].abs() <= 0.21, "a fifth of the sum of five samples: {}", values[0][50]);
    }
}
