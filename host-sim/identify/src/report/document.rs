//! A report in; the same as JSON has it out.

use std::collections::BTreeMap;

use serde::Serialize;

use super::Report;
use crate::flight::STEP_S;
use crate::predict::{Course, HORIZON};

/// The report as JSON has it.
#[derive(Serialize)]
pub struct Document {
    schema: &'static str,
    vehicle: String,
    mass_kg: f64,
    logs: Vec<String>,
    figures: BTreeMap<&'static str, Option<Figure>>,
    refused: BTreeMap<&'static str, String>,
    prediction: BTreeMap<&'static str, Row>,
    prediction_starts: usize,
    horizon_s: f64,
    tables: Vec<Table>,
    notes: Vec<String>,
    pub(super) streams: Vec<Stream>,
}

#[derive(Serialize)]
struct Figure {
    value: f64,
    low: f64,
    high: f64,
}

#[derive(Serialize)]
struct Row {
    position_m: f64,
    velocity_m_s: f64,
    rotation_rad: f64,
    body_rate_rad_s: f64,
}

#[derive(Serialize)]
struct Table {
    table: &'static str,
    inside: bool,
    outside: Vec<String>,
    unknown: Vec<&'static str>,
}

#[derive(Serialize)]
pub(super) struct Stream {
    pub(super) log: String,
    pub(super) flight_s: f64,
    pub(super) pose_shift_ms: f64,
    pub(super) estimate_rms_m: Option<f64>,
}

impl Report {
    /// For `--json`.
    pub fn document(&self) -> Document {
        let figures = self.fit.figures.iter().map(|(name, figure)| {
            (*name, figure.as_ref().ok().map(|e| Figure { value: e.value, low: e.low, high: e.high }))
        });
        let refused =
            self.fit.figures.iter().filter_map(|(name, figure)| figure.as_ref().err().map(|why| (*name, why.clone())));
        let row = |course: &Course| {
            let e = course[HORIZON - 1];
            Row {
                position_m: e.position_m,
                velocity_m_s: e.velocity_m_s,
                rotation_rad: e.rotation_rad,
                body_rate_rad_s: e.body_rate_rad_s,
            }
        };
        let prediction = self.prediction.as_ref().map_or_else(
            |_| BTreeMap::new(),
            |prediction| {
                BTreeMap::from([
                    ("ours", row(&prediction.ours)),
                    ("no_angular_acceleration", row(&prediction.no_angular_acceleration)),
                    ("no_change", row(&prediction.no_change)),
                ])
            },
        );
        Document {
            schema: "quatrack/identify/1",
            vehicle: self.fit.base.name.clone(),
            mass_kg: self.fit.base.mass_kg,
            logs: self.logs.clone(),
            figures: figures.collect(),
            refused: refused.collect(),
            prediction,
            prediction_starts: self.prediction.as_ref().map_or(0, |prediction| prediction.starts),
            horizon_s: HORIZON as f64 * STEP_S,
            tables: self
                .standings
                .iter()
                .map(|one| Table {
                    table: one.table,
                    inside: one.outside.is_empty() && one.unknown.is_empty(),
                    outside: one.outside.clone(),
                    unknown: one.unknown.clone(),
                })
                .collect(),
            notes: self.notes.clone(),
            streams: self
                .flights
                .iter()
                .map(|flight| Stream {
                    log: flight.name.clone(),
                    flight_s: flight.sections.iter().map(|s| s.len() as f64 * STEP_S).sum(),
                    pose_shift_ms: 1e3 * flight.pose_shift_s,
                    estimate_rms_m: flight.estimate_rms_m,
                })
                .collect(),
        }
    }
}
