//! The flights that a page shows in space: rows in; the worst and an ordinary flight of each law, flown again, out.

use quatrack_simulation::scenario::Scenario;
use serde::Serialize;

use crate::definition::Campaign;
use crate::row::{Outcome, Row};

/// Samples of 10 ms from one that is shown to the next.
const STRIDE: usize = 2;

/// A flight as the page has it: a row for every 20 ms.
#[derive(Serialize)]
pub(super) struct Replayed {
    run: u64,
    law: String,
    /// worst or median.
    kind: &'static str,
    lost_s: Option<f64>,
    max_error_m: Option<f64>,
    /// Time, reference x y z, position x y z, attitude w x y z, thrust of each motor, wind x y z.
    columns: [&'static str; 18],
    /// To four digits behind the point.
    rows: Vec<[f64; 18]>,
}

const COLUMNS: [&str; 18] = [
    "t_s",
    "ref_x_m",
    "ref_y_m",
    "ref_z_m",
    "x_m",
    "y_m",
    "z_m",
    "q_w",
    "q_x",
    "q_y",
    "q_z",
    "thrust_1_n",
    "thrust_2_n",
    "thrust_3_n",
    "thrust_4_n",
    "wind_x_m_s",
    "wind_y_m_s",
    "wind_z_m_s",
];

/// For each law the worst of its rows and the one in the middle.
pub(super) fn replayed(campaign: &Campaign, rows: &[Vec<Row>], worst: usize) -> Vec<Replayed> {
    let mut shown = Vec::new();
    for of_law in rows {
        let badness = |row: &Row| match row.outcome {
            Outcome::Lost => 1e9 - row.lost_s.unwrap_or(0.0),
            _ => row.max_error_m.unwrap_or(f64::INFINITY),
        };
        let mut order: Vec<&Row> = of_law.iter().collect();
        order.sort_by(|a, b| badness(b).total_cmp(&badness(a)).then(a.run.cmp(&b.run)));
        let middle = order.get(order.len() / 2).copied();
        for row in order.iter().take(worst) {
            shown.extend(replay(campaign, row, "worst"));
        }
        shown.extend(middle.and_then(|row| replay(campaign, row, "median")));
    }
    shown
}

fn replay(campaign: &Campaign, row: &Row, kind: &'static str) -> Option<Replayed> {
    let scenario: Scenario = campaign.run(row.run).scenario.ok()?;
    let mut law = row.law.start(&scenario.vehicle, &scenario.told).ok()?;
    let recording = scenario.record(law.as_mut(), &scenario.flown(campaign.trajectory().cloned())).ok()?;
    let samples = recording.shown();
    let digits = |value: f64| (value * 1e4).round() / 1e4;
    let rows = samples.iter().step_by(STRIDE).map(|(sample, around)| {
        let (state, turn) = (&sample.state, sample.state.attitude.quaternion());
        let values = [sample.time_s]
            .into_iter()
            .chain(sample.target_m.iter().copied())
            .chain(state.position_m.iter().copied())
            .chain([turn.w, turn.i, turn.j, turn.k])
            .chain(state.thrusts_n.iter().copied())
            .chain(around.wind_m_s.iter().copied());
        let mut cells = [0.0; 18];
        cells.iter_mut().zip(values).for_each(|(cell, value)| *cell = digits(value));
        cells
    });
    Some(Replayed {
        run: row.run,
        law: row.law.name().to_owned(),
        kind,
        lost_s: row.lost_s,
        max_error_m: row.max_error_m,
        columns: COLUMNS,
        rows: rows.collect(),
    })
}
