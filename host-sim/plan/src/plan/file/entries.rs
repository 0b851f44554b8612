//! The keys of a plan file as they are written.

use nalgebra::Vector3;
use quatrack_design::model::GRAVITY_M_S2;
use serde::Deserialize;

use crate::plan::PlanError;
use crate::quote::{line_of, one_line};

/// Far beyond any flight; keeps products of numbers in range.
pub(super) const LARGEST_COORDINATE_M: f64 = 1e5;

/// A plan as written.
#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PlanFile {
    #[serde(default = "five")]
    pub(super) degree: usize,
    pub(super) spans: Option<usize>,
    pub(super) duration_s: Option<f64>,
    #[serde(default = "yes")]
    pub(super) rest_to_rest: bool,
    pub(super) snap_sample_period_s: Option<f64>,
    #[serde(default = "one")]
    pub(super) body_rate_slack_reward: f64,
    pub(super) segment_shares: Option<Vec<f64>>,
    #[serde(default)]
    pub(super) waypoints: Vec<WaypointEntry>,
    #[serde(default)]
    pub(super) bounds: BoundsEntry,
    #[serde(default)]
    pub(super) corridors: Vec<CorridorEntry>,
}

#[derive(Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WaypointEntry {
    pub(super) time_s: Option<f64>,
    pub(super) position_m: [f64; 3],
    #[serde(default)]
    pub(super) tolerance_m: f64,
    pub(super) velocity_m_s: Option<[f64; 3]>,
    #[serde(default)]
    pub(super) stop: bool,
    pub(super) yaw_deg: Option<f64>,
}

#[derive(Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BoundsEntry {
    pub(super) vehicle: Option<String>,
    pub(super) speed_max_m_s: Option<f64>,
    pub(super) acceleration_max_m_s2: Option<f64>,
    pub(super) tilt_max_deg: Option<f64>,
    pub(super) thrust_min_m_s2: Option<f64>,
    pub(super) thrust_max_m_s2: Option<f64>,
    pub(super) body_rate_max_deg_s: Option<f64>,
    pub(super) yaw_rate_max_deg_s: Option<f64>,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CorridorEntry {
    pub(super) from_s: Option<f64>,
    pub(super) to_s: Option<f64>,
    pub(super) min_m: [f64; 3],
    pub(super) max_m: [f64; 3],
}

fn five() -> usize {
    5
}

fn yes() -> bool {
    true
}

fn one() -> f64 {
    1.0
}

impl Default for PlanFile {
    fn default() -> Self {
        Self {
            degree: five(),
            spans: None,
            duration_s: None,
            rest_to_rest: yes(),
            snap_sample_period_s: None,
            body_rate_slack_reward: one(),
            segment_shares: None,
            waypoints: Vec::new(),
            bounds: BoundsEntry::default(),
            corridors: Vec::new(),
        }
    }
}

impl PlanFile {
    pub(super) fn parse(text: &str) -> Result<Self, PlanError> {
        toml::from_str(text)
            .map_err(|error| PlanError::Syntax { line: line_of(text, &error), reason: one_line(error.message()) })
    }
}

impl BoundsEntry {
    /// Whether every bound is in range.
    pub(super) fn check(&self) -> Result<(), PlanError> {
        let positive = [
            ("speed_max_m_s", self.speed_max_m_s),
            ("acceleration_max_m_s2", self.acceleration_max_m_s2),
            ("body_rate_max_deg_s", self.body_rate_max_deg_s),
            ("yaw_rate_max_deg_s", self.yaw_rate_max_deg_s),
        ];
        for (field, value) in positive {
            if let Some(v) = value {
                check(v > 0.0 && v <= 1e6, format!("bounds.{field}"), v, "above 0, up to 1e6")?;
            }
        }
        if let Some(v) = self.tilt_max_deg {
            check(v > 0.0 && v < 90.0, "bounds.tilt_max_deg", v, "above 0 and below 90 (leave it out for none)")?;
        }
        if let Some(v) = self.thrust_min_m_s2 {
            let must = format!("at least 0 and below g = {GRAVITY_M_S2}: no flight can accelerate up all the time");
            check((0.0..GRAVITY_M_S2).contains(&v), "bounds.thrust_min_m_s2", v, must)?;
        }
        if let Some(v) = self.thrust_max_m_s2 {
            let must = format!("above g = {GRAVITY_M_S2}: it is divided by mass and must carry the weight");
            check(v > GRAVITY_M_S2 && v <= 1e6, "bounds.thrust_max_m_s2", v, must)?;
        }
        Ok(())
    }
}

/// `Ok` if `holds`; a NaN makes every comparison false and so never passes.
pub(super) fn check(
    holds: bool,
    field: impl Into<String>,
    value: f64,
    must: impl Into<String>,
) -> Result<(), PlanError> {
    if holds { Ok(()) } else { Err(PlanError::Value { field: field.into(), value, must: must.into() }) }
}

pub(super) fn check_point(name: &str, point: [f64; 3]) -> Result<Vector3<f64>, PlanError> {
    for value in point {
        check(
            value.abs() <= LARGEST_COORDINATE_M,
            name,
            value,
            format!("a finite number within {LARGEST_COORDINATE_M} of 0"),
        )?;
    }
    Ok(Vector3::from(point))
}
