//! Logs with a part turned, mirrored or in another unit in; the reading of each, or the refusal, out.

use quatrack_design::model::GRAVITY_M_S2;

use super::*;
use crate::flight::{Flight, prepare};
use crate::log::{RawLog, parse_csv};
use quatrack_simulation::control_law::Estimate;
use quatrack_simulation::scenario::{LogRow, cflib_csv};

/// Thirty seconds of leaning to and fro, with the drag and the specific force that belong to it.
fn rows() -> Vec<LogRow> {
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
            let row = LogRow {
                time_s: t,
                estimate: Estimate {
                    position_m: p,
                    velocity_m_s: v,
                    attitude: q,
                    body_rates_rad_s: (attitude(t - 0.005).inverse() * attitude(t + 0.005)).scaled_axis() / 0.01,
                    specific_force_m_s2: force,
                },
                commands: [0.6 + 0.05 * (7.0 * t).sin(); 4],
                voltage: None,
            };
            p += v * 0.01;
            v += (q * force - Vector3::new(0.0, 0.0, GRAVITY_M_S2)) * 0.01;
            row
        })
        .collect()
}

fn prepared(rows: &[LogRow], change: impl Fn(&mut RawLog), map: &str) -> Flight {
    let mut log = parse_csv(cflib_csv(rows).as_bytes(), "log").unwrap();
    change(&mut log);
    prepare(&log, &ColumnMap::parse(map, "map").unwrap()).unwrap()
}

const MAP: &str = include_str!("../../log/maps/cflib.toml");

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
    let exchanged = |log: &mut RawLog| {
        let [x, y] = ["gyro.x", "gyro.y"].map(|name| log.series.remove(name).unwrap());
        log.series.insert("gyro.x".to_owned(), y);
        log.series.insert("gyro.y".to_owned(), x);
    };
    let negated = |log: &mut RawLog| {
        for name in ["acc.x", "acc.y", "acc.z"] {
            times(name, -1.0)(log);
        }
    };
    let metres = |log: &mut RawLog| {
        for name in ["stateEstimate.x", "stateEstimate.y", "stateEstimate.z"] {
            times(name, 1e3)(log);
        }
    };
    let cases: [(&str, Flight); 9] = [
        ("gyroscope's x and y are exchanged", prepared(&rows, exchanged, MAP)),
        ("accelerometer has the other sign", prepared(&rows, negated, MAP)),
        ("its columns are in mm, not in m", prepared(&rows, metres, MAP)),
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
    rows.iter_mut().for_each(|row| row.estimate.attitude = pitch_mirrored(&row.estimate.attitude));
    let flight = prepared(&rows, |_| {}, MAP);
    assert!(flight.notes.0.iter().any(|note| note.contains("pitch has the other sign")), "{:?}", flight.notes);
}

#[test]
fn a_late_pose_is_found() {
    let all = rows();
    let late: Vec<LogRow> = (7..all.len())
        .map(|i| {
            let (now, before) = (all[i].estimate, all[i - 7].estimate);
            let Estimate { body_rates_rad_s, specific_force_m_s2, .. } = now;
            LogRow { estimate: Estimate { body_rates_rad_s, specific_force_m_s2, ..before }, ..all[i] }
        })
        .collect();
    let flight = prepared(&late, |_| {}, MAP);
    assert!((flight.pose_shift_s - 0.07).abs() < 0.002, "{}", flight.pose_shift_s);
}
