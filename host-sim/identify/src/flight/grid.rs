//! Streams with their own times in; all of them on one grid of 100 Hz, with missing values marked, out.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::clean::Stream;
use super::streams::{Streams, si};
use super::{Notes, RATE_HZ, STEP_S};
use crate::IdentifyError;
use crate::log::{ColumnMap, RawLog};

/// A gap that a line may bridge, s.
const BRIDGED_S: f64 = 0.055;
/// The voltage changes slowly and is logged so.
const VOLTAGE_BRIDGED_S: f64 = 5.0;

/// All signals of a log on one grid.
#[derive(Clone, Debug, Default)]
pub(super) struct Grid {
    pub(super) start_s: f64,
    /// Of the slowest of commands, gyroscope and accelerometer, s.
    pub(super) period_s: f64,
    pub(super) position: Vec<Vector3<f64>>,
    pub(super) velocity: Vec<Vector3<f64>>,
    pub(super) attitude: Vec<UnitQuaternion<f64>>,
    /// Of angles: what the attitude is where they are in the other unit, which is named.
    pub(super) other_unit: Option<(&'static str, Vec<UnitQuaternion<f64>>)>,
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

impl Grid {
    /// The grid of a log by a map.
    pub(super) fn of(log: &RawLog, map: &ColumnMap, notes: &mut Notes) -> Result<Self, IdentifyError> {
        let Streams { gyro, force, motors, attitude, position, velocity, voltage, estimate } =
            Streams::of(log, map, notes)?;
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
        let unit = map.attitude.unit.as_deref().unwrap_or("deg");
        let (q, q_good) = sampled(&attitude_stream(&attitude, map, unit), start_s, count, BRIDGED_S);
        // The same angles, were they in the other unit.
        let other_unit = (attitude.channels.len() == 3).then(|| {
            let unit = if unit == "deg" { "rad" } else { "deg" };
            (unit, attitudes(&sampled(&attitude_stream(&attitude, map, unit), start_s, count, BRIDGED_S).0))
        });
        let mut on_board: Vec<bool> = (0..count).map(|i| g_good[i] && f_good[i] && m_good[i]).collect();
        let mut pose = q_good;
        let vectors = |channels: &[Vec<f64>]| -> Vec<Vector3<f64>> {
            (0..count).map(|i| Vector3::new(channels[0][i], channels[1][i], channels[2][i])).collect()
        };
        let mut grid = Self {
            start_s,
            period_s: [&gyro, &force, &motors].map(Stream::period_s).into_iter().fold(0.0, f64::max),
            attitude: attitudes(&q),
            other_unit,
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

    /// Points where nothing is missing.
    pub(super) fn good(&self) -> Vec<usize> {
        (0..self.len()).filter(|i| self.pose[*i] && self.on_board[*i]).collect()
    }

    /// How many points.
    pub(super) fn len(&self) -> usize {
        self.gyro.len()
    }
}

/// From `x, y, z, w` as channels.
fn attitudes(q: &[Vec<f64>]) -> Vec<UnitQuaternion<f64>> {
    (0..q[3].len())
        .map(|i| UnitQuaternion::from_quaternion(Quaternion::new(q[3][i], q[0][i], q[1][i], q[2][i])))
        .collect()
}

/// Quaternions `x, y, z, w` without jumps of sign, whatever the map's form; angles in a unit.
fn attitude_stream(stream: &Stream, map: &ColumnMap, unit: &str) -> Stream {
    let Stream { times_s, channels } = stream;
    let angle = si(unit);
    let mut out = vec![Vec::new(); 4];
    let mut before = Quaternion::identity();
    let mut rows: Vec<_> = channels.iter().map(|channel| channel.iter().copied()).collect();
    for _ in times_s {
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
    Stream { times_s: times_s.clone(), channels: out }
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
