//! Units, order of the quaternion and signs: each against the other signals. A wrong one is named and put right.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use quatrack_design::model::GRAVITY_M_S2;

use super::grid::Grid;
use super::{Notes, RATE_HZ, STEP_S};
use crate::IdentifyError;
use crate::filter::{LowPass, derivative, median};
use crate::log::ColumnMap;

/// Corner frequency of the compared signals, Hz.
const CORNER_HZ: f64 = 4.0;
/// By how much another reading of the columns has to fit better, in sums of five correlations.
const CLEARLY: f64 = 0.8;

/// Correlation of specific force and velocity from which the sign is wrong: drag has -0.9 and less, a flight without drag none.
const SPEEDS_UP: f64 = 0.6;

/// One reading of the attitude's columns and of the gyroscope's second one.
struct Reading {
    name: &'static str,
    attitude: fn(&UnitQuaternion<f64>) -> UnitQuaternion<f64>,
    gyro_y: f64,
}

const READINGS: [Reading; 8] = [
    Reading { name: "", attitude: |q| *q, gyro_y: 1.0 },
    Reading {
        name: "the quaternion is scalar first, not last as the map has it: form = \"wxyz\"",
        attitude: |q| raw(q.i, q.j, q.k, q.w),
        gyro_y: 1.0,
    },
    Reading {
        name: "the quaternion is scalar last, not first as the map has it: form = \"xyzw\"",
        attitude: |q| raw(q.k, q.w, q.i, q.j),
        gyro_y: 1.0,
    },
    Reading {
        name: "the attitude turns world to body; it has to turn body to world: conjugate it",
        attitude: UnitQuaternion::inverse,
        gyro_y: 1.0,
    },
    Reading {
        name: "the attitude's pitch has the other sign (nose up positive, as in the Crazyflie's firmware): pitch_up_positive",
        attitude: pitch_mirrored,
        gyro_y: 1.0,
    },
    Reading {
        name: "the gyroscope's y has the other sign: the map's frame is x forwards, y left, z up",
        attitude: |q| *q,
        gyro_y: -1.0,
    },
    Reading {
        name: "the attitude's pitch and the gyroscope's y have the other sign (nose up positive, as in the Crazyflie's firmware)",
        attitude: pitch_mirrored,
        gyro_y: -1.0,
    },
    Reading {
        name: "the quaternion is scalar first and the gyroscope's y has the other sign",
        attitude: |q| raw(q.i, q.j, q.k, q.w),
        gyro_y: -1.0,
    },
];

fn raw(w: f64, x: f64, y: f64, z: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
}

fn pitch_mirrored(q: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    let (roll, pitch, yaw) = q.euler_angles();
    UnitQuaternion::from_euler_angles(roll, -pitch, yaw)
}

/// Puts units and signs right, with a note for each that was wrong.
///
/// # Errors
/// [`IdentifyError::Format`] where no reading of the columns makes sense.
pub(super) fn check(grid: &mut Grid, map: &ColumnMap, name: &str, notes: &mut Notes) -> Result<(), IdentifyError> {
    let format = |reason: String| IdentifyError::Format { path: name.to_owned(), reason };
    accelerometer(grid, map, name, notes)?;
    velocity(grid, map, name, notes);
    let acceleration = acceleration(grid);
    let scores: Vec<f64> = READINGS.iter().map(|reading| score(grid, reading, &acceleration)).collect();
    let (best, score) = scores.iter().enumerate().fold((0, f64::NEG_INFINITY), |best, (i, score)| {
        // The map's own reading wins ties.
        if *score > best.1 + if i == 0 { 0.0 } else { 1e-6 } { (i, *score) } else { best }
    });
    if score < 0.6 {
        return Err(format(format!(
            "attitude, gyroscope and accelerometer contradict each other in every reading of the columns (best sum of correlations {score:.1} of 5); check the map's columns, or whether the craft flies in this log"
        )));
    }
    if best != 0 && score > scores[0] + CLEARLY {
        let reading = &READINGS[best];
        notes.0.push(format!("{name}: attitude: {}; taken so", reading.name));
        grid.attitude.iter_mut().for_each(|q| *q = (reading.attitude)(q));
        grid.gyro.iter_mut().for_each(|w| w.y *= reading.gyro_y);
    }
    gyroscope(grid, map, name, notes);
    drag(grid, name, notes);
    Ok(())
}

/// At rest and in flight the median of its size is g.
fn accelerometer(grid: &mut Grid, map: &ColumnMap, name: &str, notes: &mut Notes) -> Result<(), IdentifyError> {
    let sizes: Vec<f64> =
        grid.specific_force.iter().zip(&grid.on_board).filter(|(_, good)| **good).map(|(f, _)| f.norm()).collect();
    let size = median(&sizes) / GRAVITY_M_S2;
    let fits = |factor: f64| (0.8..1.25).contains(&(size * factor));
    if fits(1.0) {
        return Ok(());
    }
    let mapped = crate::log_scale(&map.accelerometer.unit).unwrap_or(1.0);
    for unit in ["m/s^2", "g", "mg"] {
        let factor = crate::log_scale(unit).unwrap_or(1.0) / mapped;
        if fits(factor) {
            notes.0.push(format!(
                "{name}: accelerometer: its columns are in {unit}, not in {} as the map has it: at hover they would show {size:.3} g; taken so",
                map.accelerometer.unit
            ));
            grid.specific_force.iter_mut().for_each(|f| *f *= factor);
            return Ok(());
        }
    }
    let reason = format!(
        "accelerometer: {size:.3} g is the median of its size, in no unit that is known; at hover it shows g upwards, gravity included"
    );
    Err(IdentifyError::Format { path: name.to_owned(), reason })
}

/// Against the derivative of the position.
fn velocity(grid: &mut Grid, map: &ColumnMap, name: &str, notes: &mut Notes) {
    if !grid.has_velocity || grid.position.is_empty() {
        return;
    }
    let low = LowPass::new(CORNER_HZ, RATE_HZ);
    let (mut dot, mut square) = (0.0, 0.0);
    for axis in 0..3 {
        let slope = derivative(&low.both_ways(&channel(&grid.position, axis)), STEP_S);
        let own = low.both_ways(&channel(&grid.velocity, axis));
        for i in (0..grid.len()).filter(|i| grid.pose[*i]) {
            dot += slope[i] * own[i];
            square += slope[i] * slope[i];
        }
    }
    let gain = dot / square.max(1e-12);
    let right = [1e3, 1e-3, -1.0].into_iter().find(|factor| (0.6..1.6).contains(&(gain / factor)));
    if let Some(factor) = right {
        let unit = map.velocity.as_ref().map_or("", |v| v.unit.as_str());
        notes.0.push(format!(
            "{name}: velocity: {gain:.3} times the position's rate of change: not in {unit} as the map has it; divided by {factor}"
        ));
        grid.velocity.iter_mut().for_each(|v| *v /= factor);
    }
}

/// Against the turning of the attitude.
fn gyroscope(grid: &mut Grid, map: &ColumnMap, name: &str, notes: &mut Notes) {
    let low = LowPass::new(CORNER_HZ, RATE_HZ);
    let turning = turning(&grid.attitude);
    let (mut dot, mut square) = (0.0, 0.0);
    for axis in 0..2 {
        let (own, turn) = (low.both_ways(&channel(&grid.gyro, axis)), low.both_ways(&channel(&turning, axis)));
        for i in (0..grid.len()).filter(|i| grid.pose[*i] && grid.on_board[*i]) {
            dot += own[i] * turn[i];
            square += turn[i] * turn[i];
        }
    }
    let gain = dot / square.max(1e-12);
    let degree = 1_f64.to_radians();
    for (factor, unit) in [(degree, "deg/s"), (1.0 / degree, "rad/s"), (1e-3, "mrad/s"), (1e3, "rad/s")] {
        if (0.3..3.0).contains(&(gain * factor)) && !(0.3..3.0).contains(&gain) {
            notes.0.push(format!(
                "{name}: gyroscope: {gain:.3} times the attitude's rate of turn: its columns are in {unit}, not in {} as the map has it; taken so",
                map.gyroscope.unit
            ));
            grid.gyro.iter_mut().for_each(|w| *w *= factor);
            return;
        }
    }
}

/// Air slows a craft down: the specific force across the thrust is against the velocity.
fn drag(grid: &mut Grid, name: &str, notes: &mut Notes) {
    let low = LowPass::new(CORNER_HZ, RATE_HZ);
    let world: Vec<Vector3<f64>> = if grid.has_velocity {
        grid.velocity.clone()
    } else {
        let axes = [0, 1, 2].map(|axis| derivative(&low.both_ways(&channel(&grid.position, axis)), STEP_S));
        (0..grid.len()).map(|i| Vector3::new(axes[0][i], axes[1][i], axes[2][i])).collect()
    };
    let body: Vec<Vector3<f64>> =
        grid.attitude.iter().zip(&world).map(|(q, v)| q.inverse_transform_vector(v)).collect();
    let good: Vec<usize> = (0..grid.len()).filter(|i| grid.pose[*i] && grid.on_board[*i]).collect();
    for axis in 0..2 {
        let (felt, moved) = (low.both_ways(&channel(&grid.specific_force, axis)), low.both_ways(&channel(&body, axis)));
        if correlation(&good, &felt, &moved) > SPEEDS_UP {
            notes.0.push(format!(
                "{name}: accelerometer: its {} has the other sign: it shows a drag that speeds up; turned round",
                ["x", "y"][axis]
            ));
            grid.specific_force.iter_mut().for_each(|f| f[axis] = -f[axis]);
        }
    }
}

/// Over the points that are good.
fn correlation(good: &[usize], a: &[f64], b: &[f64]) -> f64 {
    let mean = |x: &[f64]| good.iter().map(|i| x[*i]).sum::<f64>() / good.len().max(1) as f64;
    let (a_mean, b_mean) = (mean(a), mean(b));
    let sum = |f: &dyn Fn(usize) -> f64| good.iter().map(|i| f(*i)).sum::<f64>();
    let ab = sum(&|i| (a[i] - a_mean) * (b[i] - b_mean));
    let (aa, bb) = (sum(&|i| (a[i] - a_mean).powi(2)), sum(&|i| (b[i] - b_mean).powi(2)));
    ab / (aa * bb).sqrt().max(1e-12)
}

/// Acceleration in the world frame, low-passed.
fn acceleration(grid: &Grid) -> [Vec<f64>; 2] {
    let low = LowPass::new(CORNER_HZ, RATE_HZ);
    [0, 1].map(|axis| {
        if grid.has_velocity {
            derivative(&low.both_ways(&channel(&grid.velocity, axis)), STEP_S)
        } else {
            derivative(&derivative(&low.both_ways(&channel(&grid.position, axis)), STEP_S), STEP_S)
        }
    })
}

/// Correlations of the two turning rates and of the two horizontal accelerations, and how much of the specific force is upwards.
fn score(grid: &Grid, reading: &Reading, acceleration: &[Vec<f64>; 2]) -> f64 {
    let low = LowPass::new(CORNER_HZ, RATE_HZ);
    let attitude: Vec<UnitQuaternion<f64>> = grid.attitude.iter().map(reading.attitude).collect();
    let turning = turning(&attitude);
    let felt: Vec<Vector3<f64>> = attitude.iter().zip(&grid.specific_force).map(|(q, f)| q * f).collect();
    let good: Vec<usize> = (0..grid.len()).filter(|i| grid.pose[*i] && grid.on_board[*i]).collect();
    let mut total = good.iter().map(|i| felt[*i].z / felt[*i].norm().max(1e-9)).sum::<f64>() / good.len().max(1) as f64;
    for (axis, acceleration) in acceleration.iter().enumerate() {
        let sign = if axis == 1 { reading.gyro_y } else { 1.0 };
        let own: Vec<f64> = low.both_ways(&channel(&grid.gyro, axis)).into_iter().map(|w| sign * w).collect();
        total += correlation(&good, &own, &low.both_ways(&channel(&turning, axis)));
        total += correlation(&good, &low.both_ways(&channel(&felt, axis)), acceleration);
    }
    total
}

/// Body rates that an attitude turns by, rad/s.
pub(super) fn turning(attitude: &[UnitQuaternion<f64>]) -> Vec<Vector3<f64>> {
    let n = attitude.len();
    (0..n)
        .map(|i| {
            let (low, high) = (i.saturating_sub(1), (i + 1).min(n - 1));
            let span_s = (high - low).max(1) as f64 * STEP_S;
            (attitude[low].inverse() * attitude[high]).scaled_axis() / span_s
        })
        .collect()
}

/// One axis of a series of vectors.
pub(super) fn channel(vectors: &[Vector3<f64>], axis: usize) -> Vec<f64> {
    vectors.iter().map(|v| v[axis]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::{Flight, prepare};
    use crate::log::{RawLog, Row, cflib_csv, parse_csv};

    /// Thirty seconds of leaning to and fro, with the drag and the specific force that belong to it.
    fn rows() -> Vec<Row> {
        let attitude = |t: f64| {
            let (roll, pitch) = (0.2 * (3.1 * t).sin(), 0.15 * (4.4 * t + 1.0).sin());
            UnitQuaternion::from_euler_angles(roll, pitch, 0.3)
        };
        let (mut v, mut p) = (Vector3::zeros(), Vector3::new(0.0, 0.0, 1.0));
        (0..3000)
            .map(|i| {
                let t = 0.01 * f64::from(i);
                let q = attitude(t);
                let body: Vector3<f64> = q.inverse_transform_vector(&v);
                let force = Vector3::new(-0.4 * body.x, -0.4 * body.y, GRAVITY_M_S2 / (q * Vector3::z()).z);
                let row = Row {
                    time_s: t,
                    position: p,
                    velocity: v,
                    attitude: q,
                    gyro: (attitude(t - 0.005).inverse() * attitude(t + 0.005)).scaled_axis() / 0.01,
                    specific_force: force,
                    commands: [0.6 + 0.05 * (7.0 * t).sin(); 4],
                    voltage: None,
                };
                p += v * 0.01;
                v += (q * force - Vector3::new(0.0, 0.0, GRAVITY_M_S2)) * 0.01;
                row
            })
            .collect()
    }

    fn prepared(rows: &[Row], change: impl Fn(&mut RawLog), map: &str) -> Flight {
        let mut log = parse_csv(cflib_csv(rows).as_bytes(), "log").unwrap();
        change(&mut log);
        prepare(&log, &ColumnMap::parse(map, "map").unwrap()).unwrap()
    }

    const MAP: &str = include_str!("../log/maps/cflib.toml");

    #[test]
    fn a_sound_log_stays_as_it_is() {
        let flight = prepared(&rows(), |_| {}, MAP);
        assert!(flight.notes.0.iter().all(|note| note.contains("repeats")), "{:?}", flight.notes);
        assert!(flight.pose_shift_s.abs() < 0.0015, "{}", flight.pose_shift_s);
    }

    #[test]
    fn wrong_units_and_signs_are_named_and_put_right() {
        let rows = rows();
        let right = prepared(&rows, |_| {}, MAP);
        let times = |column: &'static str, factor: f64| {
            move |log: &mut RawLog| log.series.get_mut(column).unwrap().values.iter_mut().for_each(|v| *v *= factor)
        };
        let cases: [(&str, Flight); 6] = [
            ("in deg/s, not in rad/s", prepared(&rows, |_| {}, &MAP.replace("deg/s", "rad/s"))),
            ("in g, not in m/s^2", prepared(&rows, |_| {}, &MAP.replace("\"g\"", "\"m/s^2\""))),
            ("scalar last, not first", prepared(&rows, |_| {}, &MAP.replace("xyzw", "wxyz"))),
            ("not in mm/s", prepared(&rows, |_| {}, &MAP.replace("\"m/s\"", "\"mm/s\""))),
            ("gyroscope's y has the other sign", prepared(&rows, times("gyro.y", -1.0), MAP)),
            ("its x has the other sign", prepared(&rows, times("acc.x", -1.0), MAP)),
        ];
        for (said, flight) in cases {
            let named: Vec<&String> = flight.notes.0.iter().filter(|note| !note.contains("repeats")).collect();
            assert!(named.len() == 1 && named[0].contains(said), "{said}: {named:?}");
            let (own, other) = (&right.sections[0], &flight.sections[0]);
            for i in (0..own.len().min(other.len())).step_by(100) {
                assert!((own.gyro[i] - other.gyro[i]).norm() < 1e-6, "{said}");
                assert!((own.specific_force[i] - other.specific_force[i]).norm() < 1e-5, "{said}");
                assert!((own.velocity[i] - other.velocity[i]).norm() < 1e-4, "{said}");
                assert!(own.attitude[i].angle_to(&other.attitude[i]) < 1e-6, "{said}");
            }
        }
    }

    #[test]
    fn a_mirrored_pitch_is_named() {
        let mut rows = rows();
        rows.iter_mut().for_each(|row| row.attitude = pitch_mirrored(&row.attitude));
        let flight = prepared(&rows, |_| {}, MAP);
        assert!(flight.notes.0.iter().any(|note| note.contains("pitch has the other sign")), "{:?}", flight.notes);
    }

    #[test]
    fn a_late_pose_is_found() {
        let all = rows();
        let late: Vec<Row> = (7..all.len())
            .map(|i| Row {
                time_s: all[i].time_s,
                position: all[i - 7].position,
                velocity: all[i - 7].velocity,
                attitude: all[i - 7].attitude,
                ..all[i]
            })
            .collect();
        let flight = prepared(&late, |_| {}, MAP);
        assert!((flight.pose_shift_s - 0.07).abs() < 0.002, "{}", flight.pose_shift_s);
    }
}
