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
        // The motors hold against the moment of the airflow, `+c v_y` about x and `-c v_x` about y.
        let against = if axis == 0 { -1.0 } else { 1.0 };
        let across = picked(&low.both_ways(&channel(&body, 1 - axis)));
        [angular, across.into_iter().map(|v| against * v).collect()]
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

/// Share of a torque's variance that an inertia and a moment of the airflow explain, neither below 0: else a smooth flight, whose torque
/// is nearly all moment, would be explained as well by motors that push the other way.
fn explained(torque: &[f64], [angular, across]: &[Vec<f64>; 2]) -> f64 {
    let (mut matrix, mut right, mut whole) = (Matrix2::zeros(), Vector2::zeros(), 0.0);
    for ((torque, angular), across) in torque.iter().zip(angular).zip(across) {
        let row = Vector2::new(*angular, *across);
        matrix += row * row.transpose();
        right += row * *torque;
        whole += torque * torque;
    }
    let both = matrix.lu().solve(&right).unwrap_or_default();
    let of_one = |j: usize| right[j].max(0.0).powi(2) / matrix[(j, j)].max(1e-300);
    let explained = if both.x >= 0.0 && both.y >= 0.0 { both.dot(&right) } else { of_one(0).max(of_one(1)) };
    explained / whole.max(1e-300)
}

/// All orders of four.
fn orders() -> impl Iterator<Item = [usize; 4]> {
    (0..256_usize)
        .map(|code| [code & 3, code >> 2 & 3, code >> 4 & 3, code >> 6 & 3])
        .filter(|order| (0..4).all(|k| order.contains(&k)))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use quatrack_simulation::scenario::Scenario;
    use quatrack_simulation::scenario::course::Flown;
    use quatrack_simulation::scenario::file::ScenarioFile;
    use quatrack_simulation::scenario::{LogRow, cflib_csv};

    use super::PLACES;
    use crate::flight::prepare;
    use crate::log::{ColumnMap, parse_csv};

    /// A smooth eight in air, whose torques are nearly all moment of the airflow.
    fn rows() -> Vec<LogRow> {
        let text = "vehicle = \"crazyflie-2.1\"\ncourse = \"eight\"\nair = \"vehicle\"\n";
        let file = ScenarioFile::parse(text, "motors").unwrap();
        let scenario = Scenario::checked(&file, "motors", Path::new("")).unwrap();
        let mut law = scenario.law.start(&scenario.vehicle, &scenario.told).unwrap();
        let recording = scenario.record(law.as_mut(), &Flown::eight(1.5, 12.0)).unwrap();
        recording.log_rows(scenario.vehicle.motors().thrust_max_n)
    }

    fn named(rows: &[LogRow]) -> Vec<String> {
        let log = parse_csv(cflib_csv(rows).as_bytes(), "log").unwrap();
        let map = ColumnMap::parse(include_str!("../log/maps/cflib.toml"), "map").unwrap();
        let notes = prepare(&log, &map).unwrap().notes.0;
        notes.into_iter().filter(|note| note.contains("motors:")).collect()
    }

    #[test]
    fn motors_in_order_stay_and_others_are_named_on_a_smooth_flight() {
        let rows = rows();
        assert_eq!(named(&rows), Vec::<String>::new());
        for order in [[2, 3, 0, 1], [1, 2, 3, 0]] {
            let other: Vec<LogRow> =
                rows.iter().map(|row| LogRow { commands: order.map(|motor| row.commands[motor]), ..*row }).collect();
            let said = named(&other);
            let places: Vec<&str> = order.iter().map(|motor| PLACES[*motor]).collect();
            assert!(said.len() == 1 && said[0].contains(&places.join(", ")), "{order:?}: {said:?}");
        }
    }
}
