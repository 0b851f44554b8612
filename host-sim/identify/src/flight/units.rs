//! Units and signs of each quantity against the others: what is wrong is named and put right.

use nalgebra::Vector3;
use quatrack_design::model::GRAVITY_M_S2;

use super::grid::Grid;
use super::signals::{channel, correlation, gain, turning};
use super::{Notes, RATE_HZ, STEP_S};
use crate::IdentifyError;
use crate::filter::{LowPass, derivative, median};
use crate::log::ColumnMap;

/// Corner of what is compared, Hz.
const CORNER_HZ: f64 = 4.0;
/// Correlation of specific force and velocity from which the sign is wrong: drag has -0.9 and less, a flight without drag none.
const SPEEDS_UP: f64 = 0.6;
/// What the position accelerates by has to follow what is felt so closely, before its size is looked at.
const FOLLOWS: f64 = 0.6;

/// At rest and in flight the median of its size is g.
pub(super) fn accelerometer(
    grid: &mut Grid,
    map: &ColumnMap,
    name: &str,
    notes: &mut Notes,
) -> Result<(), IdentifyError> {
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

/// Against what the accelerometer feels in the world frame. Looked at once the attitude is right.
pub(super) fn position(grid: &mut Grid, map: &ColumnMap, name: &str, notes: &mut Notes) {
    if grid.position.is_empty() {
        return;
    }
    let low = LowPass::new(CORNER_HZ, RATE_HZ);
    let felt: Vec<Vector3<f64>> = grid.attitude.iter().zip(&grid.specific_force).map(|(q, f)| q * f).collect();
    let (mut gains, good) = (Vec::new(), grid.good());
    for axis in 0..2 {
        let smooth = low.both_ways(&low.both_ways(&channel(&grid.position, axis)));
        let moved = derivative(&derivative(&smooth, STEP_S), STEP_S);
        let felt = low.both_ways(&low.both_ways(&channel(&felt, axis)));
        if correlation(&good, &moved, &felt) > FOLLOWS {
            gains.push(gain(&good, &moved, &felt));
        }
    }
    let usual = median(&gains);
    let unit = map.position.as_ref().map_or("", |v| v.unit.as_str());
    for (factor, is) in [(1e3, "mm"), (1e-3, "m")] {
        if !gains.is_empty() && (0.3..3.0).contains(&(usual / factor)) {
            notes.0.push(format!(
                "{name}: position: it accelerates by {usual:.4} times the specific force less gravity: its columns are in {is}, not in {unit} as the map \
                 has it; taken so"
            ));
            grid.position.iter_mut().for_each(|p| *p /= factor);
        }
    }
}

/// Against the derivative of the position.
pub(super) fn velocity(grid: &mut Grid, map: &ColumnMap, name: &str, notes: &mut Notes) {
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
pub(super) fn gyroscope(grid: &mut Grid, map: &ColumnMap, name: &str, notes: &mut Notes) {
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

/// Air slows a craft down: what the accelerometer shows across the thrust is against the velocity.
pub(super) fn drag(grid: &mut Grid, name: &str, notes: &mut Notes) {
    let low = LowPass::new(CORNER_HZ, RATE_HZ);
    let world: Vec<Vector3<f64>> = if grid.has_velocity {
        grid.velocity.clone()
    } else {
        let axes = [0, 1, 2].map(|axis| derivative(&low.both_ways(&channel(&grid.position, axis)), STEP_S));
        (0..grid.len()).map(|i| Vector3::new(axes[0][i], axes[1][i], axes[2][i])).collect()
    };
    let body: Vec<Vector3<f64>> =
        grid.attitude.iter().zip(&world).map(|(q, v)| q.inverse_transform_vector(v)).collect();
    let good = grid.good();
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
