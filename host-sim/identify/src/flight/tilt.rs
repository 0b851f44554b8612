//! Attitude and velocity with an estimator's errors mended, in whichever of two ways explains the drag better.
//!
//! Poses by cameras are good and need little; the inertial sensors would add their own errors of scale and of alignment to them. An
//! estimator on board needs more than its tilt mended: see [`super::inertial`]. The specific force across the thrust is drag alone, and
//! tells which of the two a log is.

use nalgebra::{UnitQuaternion, Vector3};
use quatrack_design::model::GRAVITY_M_S2;

use super::grid::Grid;
use super::inertial::smoothed;
use super::signals::{channel, correlation};
use super::{RATE_HZ, STEP_S};
use crate::filter::{LowPass, derivative};

/// Below this, Hz, the accelerometer and the position know the tilt better than an estimator does.
const TILT_HZ: f64 = 1.5;
/// Larger corrections of the tilt, rad, are ignored: they are no error of an estimator.
const TILT_MOST: f64 = 0.35;
/// Corner of what is compared, Hz.
const CORNER_HZ: f64 = 4.0;

/// Mends a grid's attitude and velocity.
pub(super) fn mend(grid: &mut Grid, flying: &[bool]) {
    let inertial = smoothed(grid);
    tilt(grid);
    let Some((attitude, velocity)) = inertial else { return };
    let own = (std::mem::replace(&mut grid.attitude, attitude), std::mem::replace(&mut grid.velocity, velocity));
    let by_sensors = drag_explained(grid, flying);
    let by_sensors_kept = (std::mem::replace(&mut grid.attitude, own.0), std::mem::replace(&mut grid.velocity, own.1));
    if by_sensors > drag_explained(grid, flying) {
        (grid.attitude, grid.velocity) = by_sensors_kept;
    }
}

/// Share of the specific force across the thrust that goes against the velocity, both axes.
fn drag_explained(grid: &Grid, flying: &[bool]) -> f64 {
    let low = LowPass::new(CORNER_HZ, RATE_HZ);
    let points: Vec<usize> = (0..grid.len()).filter(|i| flying[*i]).collect();
    let body: Vec<Vector3<f64>> =
        grid.attitude.iter().zip(&grid.velocity).map(|(q, v)| q.inverse_transform_vector(v)).collect();
    (0..2)
        .map(|axis| {
            let (felt, moved) =
                (low.both_ways(&channel(&grid.specific_force, axis)), low.both_ways(&channel(&body, axis)));
            correlation(&points, &felt, &moved).min(0.0).powi(2)
        })
        .sum()
}

/// Turns the attitude so that the accelerometer, low-passed, shows in the world frame the velocity's rate of change, and
/// gravity. An estimator that does not know of drag is off by as much as the drag is of g: 7 degrees at 2 m/s.
fn tilt(grid: &mut Grid) {
    let low = LowPass::new(TILT_HZ, RATE_HZ);
    let felt: Vec<Vector3<f64>> = grid.attitude.iter().zip(&grid.specific_force).map(|(q, f)| q * f).collect();
    let [felt, due] = [0, 1].map(|k| {
        [0, 1, 2].map(|axis| {
            let signal = if k == 0 { channel(&felt, axis) } else { derivative(&channel(&grid.velocity, axis), STEP_S) };
            low.both_ways(&signal)
        })
    });
    for i in 0..grid.len() {
        let felt = Vector3::new(felt[0][i], felt[1][i], felt[2][i]);
        let due = Vector3::new(due[0][i], due[1][i], due[2][i] + GRAVITY_M_S2);
        let turn = felt.cross(&due) / (felt.norm() * due.norm()).max(1e-6);
        // At rest on the floor or in a fall there is nothing to turn by.
        if turn.norm() < TILT_MOST {
            grid.attitude[i] = UnitQuaternion::from_scaled_axis(turn) * grid.attitude[i];
        }
    }
}
