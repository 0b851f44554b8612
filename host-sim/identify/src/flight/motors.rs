//! Whether the motors' columns are in the order that the map says: the torques that they would give, against how the craft turned.

use nalgebra::{Matrix2, Vector2, Vector3};
use quatrack_design::vehicle::ROTOR_SIDES;

use super::grid::Grid;
use super::signals::channel;
use super::{Notes, RATE_HZ, STEP_S};
use crate::filter::{LowPass, derivative, lagged, mean};

/// Corner of what is compared, Hz.
const CORNER_HZ: f64 = 6.0;
/// Between the lags of small crafts, s: an order is told by signs, not by a lag.
const LAG_S: f64 = 0.06;
/// Share of the torques that another order has to explain, and by how much more than the map's.
const EXPLAINS: f64 = 0.4;
const CLEARLY: f64 = 0.25;

const PLACES: [&str; 4] = ["front right", "rear right", "rear left", "front left"];

/// Puts the commands into the order front right, rear right, rear left, front left, with a note where they are not.
pub(super) fn order(grid: &mut Grid, flying: &[bool], name: &str, notes: &mut Notes) {
    let points: Vec<usize> = (0..grid.len()).filter(|i| flying[*i]).collect();
    if points.len() < 4 * RATE_HZ as usize {
        return;
    }
    let low = LowPass::new(CORNER_HZ, RATE_HZ);
    let picked = |signal: &[f64]| -> Vec<f64> {
        let of: Vec<f64> = points.iter().map(|i| signal[*i]).collect();
        let middle = mean(&of);
        of.into_iter().map(|value| value - middle).collect()
    };
    let body: Vec<Vector3<f64>> =
        grid.attitude.iter().zip(&grid.velocity).map(|(q, v)| q.inverse_transform_vector(v)).collect();
    let balances = [0, 1].map(|axis| {
        let angular = picked(&low.both_ways(&derivative(&channel(&grid.gyro, axis), STEP_S)));
        let across = picked(&low.both_ways(&channel(&body, 1 - axis)));
        [angular, across]
    });
    let commands =
        grid.commands.each_ref().map(|command| picked(&low.both_ways(&lagged(command, LAG_S, LAG_S, STEP_S))));
    let explained = |order: [usize; 4]| -> f64 {
        let share = |axis: usize| {
            let side = |motor: usize| if axis == 0 { ROTOR_SIDES[motor][1] } else { -ROTOR_SIDES[motor][0] };
            let torque: Vec<f64> =
                (0..points.len()).map(|i| (0..4).map(|motor| side(motor) * commands[order[motor]][i]).sum()).collect();
            explained(&torque, &balances[axis])
        };
        0.5 * (share(0) + share(1))
    };
    let own = explained([0, 1, 2, 3]);
    let best = orders().map(|order| (explained(order), order)).max_by(|a, b| a.0.total_cmp(&b.0));
    let Some((share, order)) = best.filter(|(share, _)| *share > EXPLAINS && *share > own + CLEARLY) else { return };
    let of: Vec<&str> = (0..4).map(|column| PLACES[order.iter().position(|k| *k == column).unwrap_or(0)]).collect();
    notes.0.push(format!(
        "{name}: motors: the map's columns are {}, not front right, rear right, rear left, front left: so they explain {share:.2} of how \
         the craft turns, as the map has them {own:.2}; taken so",
        of.join(", ")
    ));
    grid.commands = order.map(|column| grid.commands[column].clone());
}

/// Share of a torque's variance that goes with angular acceleration and velocity across; none where the inertia would be negative.
fn explained(torque: &[f64], [angular, across]: &[Vec<f64>; 2]) -> f64 {
    let (mut matrix, mut right, mut whole) = (Matrix2::zeros(), Vector2::zeros(), 0.0);
    for ((torque, angular), across) in torque.iter().zip(angular).zip(across) {
        let row = Vector2::new(*angular, *across);
        matrix += row * row.transpose();
        right += row * *torque;
        whole += torque * torque;
    }
    let solution = matrix.lu().solve(&right).unwrap_or_default();
    if solution.x > 0.0 { solution.dot(&right) / whole.max(1e-300) } else { 0.0 }
}

/// All orders of four.
fn orders() -> impl Iterator<Item = [usize; 4]> {
    (0..256_usize)
        .map(|code| [code & 3, code >> 2 & 3, code >> 4 & 3, code >> 6 & 3])
        .filter(|order| (0..4).all(|k| order.contains(&k)))
}
