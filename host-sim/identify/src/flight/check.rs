//! Order of the quaternion, unit of angles and signs: the reading of the columns that agrees best with the other signals. What is wrong
//! is named and put right.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::grid::Grid;
use super::signals::{channel, correlation, turning};
use super::units::{accelerometer, drag, gyroscope, position, velocity};
use super::{Notes, RATE_HZ, STEP_S};
use crate::IdentifyError;
use crate::filter::{LowPass, derivative};
use crate::log::ColumnMap;

/// Corner frequency of the compared signals, Hz.
const CORNER_HZ: f64 = 4.0;
/// By how much another reading of the columns has to fit better, in sums of five correlations.
const CLEARLY: f64 = 0.8;
/// A sum of so much at least makes sense: gravity alone, upwards, has 1.
const SENSE: f64 = 0.6;

/// One reading of the attitude's columns and of the gyroscope's second one.
struct Reading {
    name: &'static str,
    attitude: fn(&UnitQuaternion<f64>) -> UnitQuaternion<f64>,
    gyro_y: f64,
    /// Whether the gyroscope's x and y change places.
    exchanged: bool,
    /// Of the accelerometer as a whole.
    force: f64,
}

const READINGS: [Reading; 10] = [
    Reading { name: "", attitude: |q| *q, gyro_y: 1.0, exchanged: false, force: 1.0 },
    Reading {
        name: "the quaternion is scalar first, not last as the map has it: form = \"wxyz\"",
        attitude: |q| raw(q.i, q.j, q.k, q.w),
        gyro_y: 1.0,
        exchanged: false,
        force: 1.0,
    },
    Reading {
        name: "the quaternion is scalar last, not first as the map has it: form = \"xyzw\"",
        attitude: |q| raw(q.k, q.w, q.i, q.j),
        gyro_y: 1.0,
        exchanged: false,
        force: 1.0,
    },
    Reading {
        name: "the attitude turns world to body; it has to turn body to world: conjugate it",
        attitude: UnitQuaternion::inverse,
        gyro_y: 1.0,
        exchanged: false,
        force: 1.0,
    },
    Reading {
        name: "the attitude's pitch has the other sign (nose up positive, as in the Crazyflie's firmware): pitch_up_positive",
        attitude: pitch_mirrored,
        gyro_y: 1.0,
        exchanged: false,
        force: 1.0,
    },
    Reading {
        name: "the gyroscope's y has the other sign: the map's frame is x forwards, y left, z up",
        attitude: |q| *q,
        gyro_y: -1.0,
        exchanged: false,
        force: 1.0,
    },
    Reading {
        name: "the attitude's pitch and the gyroscope's y have the other sign (nose up positive, as in the Crazyflie's firmware)",
        attitude: pitch_mirrored,
        gyro_y: -1.0,
        exchanged: false,
        force: 1.0,
    },
    Reading {
        name: "the quaternion is scalar first and the gyroscope's y has the other sign",
        attitude: |q| raw(q.i, q.j, q.k, q.w),
        gyro_y: -1.0,
        exchanged: false,
        force: 1.0,
    },
    Reading {
        name: "the gyroscope's x and y are exchanged: the map's frame is x forwards, y left, z up",
        attitude: |q| *q,
        gyro_y: 1.0,
        exchanged: true,
        force: 1.0,
    },
    Reading {
        name: "the accelerometer has the other sign: at hover it shows g upwards",
        attitude: |q| *q,
        gyro_y: 1.0,
        exchanged: false,
        force: -1.0,
    },
];

impl Reading {
    fn gyro(&self, w: &Vector3<f64>) -> Vector3<f64> {
        let [x, y] = if self.exchanged { [w.y, w.x] } else { [w.x, w.y] };
        Vector3::new(x, self.gyro_y * y, w.z)
    }
}

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
    accelerometer(grid, map, name, notes)?;
    attitude(grid, map, name, notes)?;
    position(grid, map, name, notes);
    velocity(grid, map, name, notes);
    gyroscope(grid, map, name, notes);
    drag(grid, name, notes);
    Ok(())
}

/// The reading that fits best, where it does so clearly.
fn attitude(grid: &mut Grid, map: &ColumnMap, name: &str, notes: &mut Notes) -> Result<(), IdentifyError> {
    let acceleration = acceleration(grid);
    let bases = [Some(&grid.attitude), grid.other_unit.as_ref().map(|(_, attitude)| attitude)];
    let mut best = (f64::NEG_INFINITY, 0, 0);
    let mut own = f64::NEG_INFINITY;
    for (b, base) in bases.iter().enumerate() {
        let Some(base) = base else { continue };
        for (r, reading) in READINGS.iter().enumerate() {
            let score = score(grid, base, reading, &acceleration);
            if (b, r) == (0, 0) {
                own = score;
            }
            // The map's own reading wins ties.
            if score > best.0 + 1e-6 {
                best = (score, b, r);
            }
        }
    }
    let (score, base, reading) = (best.0, best.1, &READINGS[best.2]);
    if score < SENSE {
        let reason = format!(
            "attitude, gyroscope and accelerometer contradict each other in every reading of the columns (best sum of correlations \
             {score:.1} of 5); check the map's columns, or whether the craft flies in this log"
        );
        return Err(IdentifyError::Format { path: name.to_owned(), reason });
    }
    if (base, best.2) == (0, 0) || score <= own + CLEARLY {
        return Ok(());
    }
    if let (1, Some((unit, attitude))) = (base, grid.other_unit.take()) {
        let said = map.attitude.unit.as_deref().unwrap_or("deg");
        notes.0.push(format!("{name}: attitude: its angles are in {unit}, not in {said} as the map has it; taken so"));
        grid.attitude = attitude;
    }
    if !reading.name.is_empty() {
        notes.0.push(format!("{name}: {}; taken so", reading.name));
    }
    grid.attitude.iter_mut().for_each(|q| *q = (reading.attitude)(q));
    grid.gyro.iter_mut().for_each(|w| *w = reading.gyro(w));
    grid.specific_force.iter_mut().for_each(|f| *f *= reading.force);
    Ok(())
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
fn score(grid: &Grid, attitude: &[UnitQuaternion<f64>], reading: &Reading, acceleration: &[Vec<f64>; 2]) -> f64 {
    let low = LowPass::new(CORNER_HZ, RATE_HZ);
    let attitude: Vec<UnitQuaternion<f64>> = attitude.iter().map(reading.attitude).collect();
    let turning = turning(&attitude);
    let felt: Vec<Vector3<f64>> =
        attitude.iter().zip(&grid.specific_force).map(|(q, f)| q * f * reading.force).collect();
    let gyro: Vec<Vector3<f64>> = grid.gyro.iter().map(|w| reading.gyro(w)).collect();
    let good = grid.good();
    let mut total = good.iter().map(|i| felt[*i].z / felt[*i].norm().max(1e-9)).sum::<f64>() / good.len().max(1) as f64;
    for (axis, acceleration) in acceleration.iter().enumerate() {
        let own = low.both_ways(&channel(&gyro, axis));
        total += correlation(&good, &own, &low.both_ways(&channel(&turning, axis)));
        total += correlation(&good, &low.both_ways(&channel(&felt, axis)), acceleration);
    }
    total
}

#[cfg(test)]
mod tests;
