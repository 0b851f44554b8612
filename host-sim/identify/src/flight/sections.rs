//! Where a craft flies: a log and a map in; a flight cut into parts without a gap out.

use nalgebra::Vector3;

use super::align::{moved, pose_shift_s, turned};
use super::check::check;
use super::grid::Grid;
use super::motors::order;
use super::signals::channel;
use super::tilt::mend;
use super::{Flight, Notes, RATE_HZ, STEP_S, Section};
use crate::IdentifyError;
use crate::filter::{LowPass, derivative, median};
use crate::log::{ColumnMap, RawLog};

/// Above the floor, m: below, the ground adds to the thrust.
const CLEAR_M: f64 = 0.25;
/// Left out after it is that high, and before it is no more, s.
const AFTER_START_S: f64 = 1.0;
const BEFORE_END_S: f64 = 0.5;
/// Motors below this share of a full command do not carry a craft.
const OFF: f64 = 0.05;
/// Shortest part that is used, s.
const SHORTEST_S: f64 = 4.0;
/// Corner for the velocity that is had from the position, Hz.
const VELOCITY_HZ: f64 = 8.0;
/// The same where the log has a velocity of its own.
const CORRECTED_HZ: f64 = 3.0;

/// A flight out of a log.
///
/// # Errors
/// [`IdentifyError`] for columns that are not there or contradict each other, and where the craft does not fly.
pub fn prepare(log: &RawLog, map: &ColumnMap) -> Result<Flight, IdentifyError> {
    let mut notes = Notes::default();
    let mut grid = Grid::of(log, map, &mut notes)?;
    check(&mut grid, map, &log.name, &mut notes)?;
    velocity(&mut grid);
    let flying = flying(&grid);
    let shift_s = pose_shift_s(&grid, &flying);
    grid.attitude = turned(&grid.attitude, shift_s);
    grid.velocity = moved(&grid.velocity, shift_s);
    grid.position = moved(&grid.position, shift_s);
    mend(&mut grid, &flying);
    if grid.position.is_empty() {
        grid.position = summed(&grid.velocity);
    }
    order(&mut grid, &flying, &log.name, &mut notes);
    let sections = cut(&grid, &flying);
    if sections.is_empty() {
        let reason = format!(
            "no {SHORTEST_S} s of flight without a gap: motors above {OFF} of a full command, {CLEAR_M} m above where they were off"
        );
        return Err(IdentifyError::Format { path: log.name.clone(), reason });
    }
    Ok(Flight {
        name: log.name.clone(),
        estimate_rms_m: estimate_rms_m(&grid, &flying),
        has_voltage: !grid.voltage.is_empty(),
        sections,
        pose_shift_s: shift_s,
        period_s: grid.period_s,
        notes,
    })
}

/// Velocity by the position, as far as a low-pass lets it through; above, that of the log where it has one. An estimator that does not know of drag is
/// 5 to 15 % too fast, and it is corrected by the position.
fn velocity(grid: &mut Grid) {
    if grid.position.is_empty() {
        return;
    }
    let corner_hz = if grid.has_velocity { CORRECTED_HZ } else { VELOCITY_HZ };
    let low = LowPass::new(corner_hz, RATE_HZ);
    if !grid.has_velocity {
        grid.velocity = vec![Vector3::zeros(); grid.len()];
    }
    for axis in 0..3 {
        let slope = derivative(&channel(&grid.position, axis), STEP_S);
        let off: Vec<f64> = slope.iter().zip(&grid.velocity).map(|(slope, v)| slope - v[axis]).collect();
        for (v, off) in grid.velocity.iter_mut().zip(low.both_ways(&off)) {
            v[axis] += off;
        }
    }
}

/// Motors on, and clear of where the craft was while they were off.
fn flying(grid: &Grid) -> Vec<bool> {
    let count = grid.len();
    let weakest = |i: usize| grid.commands.iter().map(|command| command[i]).fold(f64::INFINITY, f64::min);
    let strongest = |i: usize| grid.commands.iter().map(|command| command[i]).fold(0.0, f64::max);
    let off: Vec<f64> = if grid.position.is_empty() {
        Vec::new()
    } else {
        (0..count)
            .filter(|i| grid.on_board[*i] && grid.pose[*i] && strongest(*i) < OFF)
            .map(|i| grid.position[i].z)
            .collect()
    };
    let floor_m = if off.len() > 20 { median(&off) } else { f64::NEG_INFINITY };
    let mut flying: Vec<bool> = (0..count)
        .map(|i| {
            grid.on_board[i]
                && grid.pose[i]
                && weakest(i) > 0.0
                && strongest(i) > OFF
                && (grid.position.is_empty() || grid.position[i].z > floor_m + CLEAR_M)
        })
        .collect();
    if floor_m.is_finite() {
        // The time after a start and the time before a landing.
        let ends = |forward: bool, span_s: f64, flying: &[bool]| -> Vec<bool> {
            let span = (span_s * RATE_HZ) as usize;
            (0..count)
                .map(|i| {
                    let near = if forward { i.saturating_sub(span)..i + 1 } else { i..(i + span + 1).min(count) };
                    flying[i] && near.len() > span && flying[near].iter().all(|flies| *flies)
                })
                .collect()
        };
        let first = flying.iter().position(|flies| *flies).unwrap_or(0);
        let last = flying.iter().rposition(|flies| *flies).unwrap_or(0);
        let (started, landed) = (ends(true, AFTER_START_S, &flying), ends(false, BEFORE_END_S, &flying));
        let after = first + (AFTER_START_S * RATE_HZ) as usize;
        let before = last.saturating_sub((BEFORE_END_S * RATE_HZ) as usize);
        for i in 0..count {
            // Short gaps in the middle cost no more than themselves.
            flying[i] &= (i > after && i < before) || (started[i] && landed[i]);
        }
    }
    flying
}

fn cut(grid: &Grid, flying: &[bool]) -> Vec<Section> {
    let whole = Section {
        start_s: grid.start_s,
        position: grid.position.clone(),
        velocity: grid.velocity.clone(),
        attitude: grid.attitude.clone(),
        gyro: grid.gyro.clone(),
        specific_force: grid.specific_force.clone(),
        commands: grid.commands.clone(),
        voltage: grid.voltage.clone(),
    };
    let mut sections = Vec::new();
    let mut i = 0;
    while i < flying.len() {
        let end = (i..flying.len()).find(|k| !flying[*k]).unwrap_or(flying.len());
        if (end - i) as f64 * STEP_S >= SHORTEST_S {
            sections.push(whole.part(i..end));
        }
        i = end.max(i + 1);
    }
    sections
}

fn summed(velocity: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let mut place = Vector3::zeros();
    velocity
        .iter()
        .map(|v| {
            place += v * STEP_S;
            place
        })
        .collect()
}

/// Of the on-board position against the pose, with the shift that fits best.
fn estimate_rms_m(grid: &Grid, flying: &[bool]) -> Option<f64> {
    if grid.estimate.is_empty() {
        return None;
    }
    let rms = |shift_s: f64| {
        let estimate = moved(&grid.estimate, shift_s);
        let flown: Vec<f64> =
            (0..grid.len()).filter(|i| flying[*i]).map(|i| (estimate[i] - grid.position[i]).norm_squared()).collect();
        (flown.iter().sum::<f64>() / flown.len().max(1) as f64).sqrt()
    };
    (-15..=15).map(|k| rms(0.01 * f64::from(k))).min_by(f64::total_cmp)
}
