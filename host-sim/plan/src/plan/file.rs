//! Plan files: TOML in, a [`Plan`] whose numbers are all in range out.

use nalgebra::Vector3;
use quatrack_design::model::GRAVITY_M_S2;
use serde::Deserialize;

use super::error::{PlanError, WaypointName};
use super::{Bounds, Corridor, Plan, Waypoint};
use crate::trajectory::bspline::UniformBasis;

/// More spans than any flight here needs; keeps a slip of the finger from filling the memory.
const MOST_SPANS: usize = 500;
/// Far beyond any flight; keeps products of numbers in range.
const LARGEST_COORDINATE_M: f64 = 1e5;
/// Likewise for times.
const LONGEST_S: f64 = 1e5;
/// Shortest flight; shorter ones have snaps beyond what the solver can scale.
const SHORTEST_S: f64 = 1e-2;
/// Two times closer than this part of the duration are the same; that of a decimal number written in full.
const SAME_TIME: f64 = 1e-12;

/// A plan as written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PlanFile {
    degree: usize,
    spans: usize,
    duration_s: f64,
    #[serde(default = "yes")]
    rest_to_rest: bool,
    snap_sample_period_s: f64,
    #[serde(default = "one")]
    body_rate_slack_reward: f64,
    segment_shares: Option<Vec<f64>>,
    #[serde(default)]
    waypoints: Vec<WaypointEntry>,
    #[serde(default)]
    bounds: BoundsEntry,
    #[serde(default)]
    corridors: Vec<CorridorEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WaypointEntry {
    time_s: Option<f64>,
    position_m: [f64; 3],
    #[serde(default)]
    tolerance_m: f64,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct BoundsEntry {
    speed_max_m_s: Option<f64>,
    tilt_max_deg: Option<f64>,
    thrust_min_m_s2: Option<f64>,
    thrust_max_m_s2: Option<f64>,
    body_rate_max_deg_s: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CorridorEntry {
    from_s: Option<f64>,
    to_s: Option<f64>,
    min_m: [f64; 3],
    max_m: [f64; 3],
}

fn yes() -> bool {
    true
}

fn one() -> f64 {
    1.0
}

/// Reads a plan.
pub(super) fn read(text: &str) -> Result<Plan, PlanError> {
    if text.lines().all(|line| line.split('#').next().is_none_or(|data| data.trim().is_empty())) {
        return Err(PlanError::Empty);
    }
    let file: PlanFile = toml::from_str(text).map_err(|error| syntax(text, &error))?;
    check_spline(&file)?;
    let waypoints = waypoints(&file)?;
    let plan = Plan {
        basis: UniformBasis::new(file.degree, file.spans, file.duration_s)?,
        rest_to_rest: file.rest_to_rest,
        snap_sample_period_s: file.snap_sample_period_s,
        body_rate_slack_reward: file.body_rate_slack_reward,
        bounds: bounds(&file.bounds)?,
        corridors: corridors(&file)?,
        waypoints,
    };
    plan.check_spans()?;
    Ok(plan)
}

fn syntax(text: &str, error: &toml::de::Error) -> PlanError {
    let start = error.span().map_or(0, |span| span.start);
    let line = 1 + text.bytes().take(start).filter(|byte| *byte == b'\n').count();
    PlanError::Syntax { line, reason: crate::quote::one_line(error.message()) }
}

/// `Ok` if `holds`; a NaN makes every comparison false and so never passes.
fn check(holds: bool, field: impl Into<String>, value: f64, must: impl Into<String>) -> Result<(), PlanError> {
    if holds { Ok(()) } else { Err(PlanError::Value { field: field.into(), value, must: must.into() }) }
}

fn check_spline(file: &PlanFile) -> Result<(), PlanError> {
    let PlanFile { degree, spans, duration_s, snap_sample_period_s, body_rate_slack_reward, .. } = *file;
    check(
        (4..=7).contains(&degree),
        "degree",
        degree as f64,
        "from 4, the least with a snap, to 7, the most that is flown",
    )?;
    let fewest = if file.rest_to_rest { 8_usize.saturating_sub(degree).max(1) } else { 1 };
    let must = format!(
        "from {fewest}{} to {MOST_SPANS}",
        if fewest > 1 { " (four control points at rest at each end)" } else { "" }
    );
    check((fewest..=MOST_SPANS).contains(&spans), "spans", spans as f64, must)?;
    check(
        (SHORTEST_S..=LONGEST_S).contains(&duration_s),
        "duration_s",
        duration_s,
        format!("from {SHORTEST_S} to {LONGEST_S} s"),
    )?;
    // With fewer samples than the snap has coefficients in a span, a curve could wiggle between them for nothing.
    let longest_s = duration_s / (spans * (degree - 3)) as f64;
    check(
        snap_sample_period_s >= 1e-6 * duration_s && snap_sample_period_s <= longest_s * (1.0 + SAME_TIME),
        "snap_sample_period_s",
        snap_sample_period_s,
        format!(
            "above 0 and at most {longest_s:.6} s, that is {} samples a span (and at least a millionth of duration_s)",
            degree - 3
        ),
    )?;
    check(
        (0.0..=1e6).contains(&body_rate_slack_reward),
        "body_rate_slack_reward",
        body_rate_slack_reward,
        "from 0 (none) to 1e6",
    )
}

fn check_point(name: &str, point: [f64; 3]) -> Result<Vector3<f64>, PlanError> {
    for value in point {
        check(
            value.abs() <= LARGEST_COORDINATE_M,
            name,
            value,
            format!("a finite number within {LARGEST_COORDINATE_M} m of 0"),
        )?;
    }
    Ok(Vector3::from(point))
}

/// Times of the waypoints, s, from `time_s` or from `segment_shares`.
fn times_s(file: &PlanFile) -> Result<Vec<f64>, PlanError> {
    let entries = file.waypoints.iter().zip(1..);
    let Some(shares) = &file.segment_shares else {
        return entries
            .map(|(entry, number)| {
                let name = WaypointName { number, time_s: None };
                entry.time_s.ok_or(PlanError::WaypointTime { waypoint: name, twice: false })
            })
            .collect();
    };
    for (entry, number) in entries {
        if entry.time_s.is_some() {
            let waypoint = WaypointName { number, time_s: entry.time_s };
            return Err(PlanError::WaypointTime { waypoint, twice: true });
        }
    }
    if shares.len() + 1 != file.waypoints.len() {
        return Err(PlanError::SegmentShares { found: shares.len(), waypoints: file.waypoints.len() });
    }
    for (share, number) in shares.iter().zip(1..) {
        check(*share > 0.0 && *share <= 1e9, format!("segment_shares, entry {number}"), *share, "above 0, up to 1e9")?;
    }
    let total: f64 = shares.iter().sum();
    let mut passed = 0.0;
    let later = shares.iter().map(|share| {
        passed += share;
        file.duration_s * (passed / total)
    });
    Ok(std::iter::once(0.0).chain(later).collect())
}

fn waypoints(file: &PlanFile) -> Result<Vec<Waypoint>, PlanError> {
    let count = file.waypoints.len();
    if count < 2 {
        return Err(PlanError::TooFewWaypoints(count));
    }
    if !file.rest_to_rest && count < 4 {
        return Err(PlanError::Undetermined(count));
    }
    let mut waypoints: Vec<Waypoint> = Vec::with_capacity(count);
    for ((entry, mut time_s), number) in file.waypoints.iter().zip(times_s(file)?).zip(1..) {
        let name = WaypointName { number, time_s: Some(time_s) };
        let inside = time_s >= 0.0 && time_s <= file.duration_s * (1.0 + SAME_TIME);
        let must = format!("from 0 to duration_s = {} s", file.duration_s);
        check(inside, format!("waypoint {number}: time_s"), time_s, must)?;
        // The ends are where the flight starts and ends, and are met exactly, whatever is written.
        let end_s = if number == 1 { Some(0.0) } else { (number == count).then_some(file.duration_s) };
        if let Some(expected_s) = end_s {
            if (time_s - expected_s).abs() > SAME_TIME * file.duration_s {
                return Err(PlanError::EndTime { waypoint: name, expected_s });
            }
            time_s = expected_s;
            let field = format!("waypoint {number}: tolerance_m");
            check(
                entry.tolerance_m == 0.0,
                field,
                entry.tolerance_m,
                "0 or left out: the flight starts and ends exactly",
            )?;
        }
        if let Some(before) = waypoints.last()
            && time_s <= before.time_s + SAME_TIME * file.duration_s
        {
            return Err(PlanError::NotIncreasing { waypoint: name, before_s: before.time_s });
        }
        let field = format!("waypoint {number}: tolerance_m");
        let must = format!("from 0 (met exactly) to {LARGEST_COORDINATE_M} m");
        check((0.0..=LARGEST_COORDINATE_M).contains(&entry.tolerance_m), field, entry.tolerance_m, must)?;
        let position_m = check_point(&format!("waypoint {number}: position_m"), entry.position_m)?;
        waypoints.push(Waypoint { time_s, position_m, tolerance_m: entry.tolerance_m });
    }
    Ok(waypoints)
}

fn bounds(entry: &BoundsEntry) -> Result<Bounds, PlanError> {
    let positive = |value: Option<f64>, field: &str| {
        value.map_or(Ok(()), |v| check(v > 0.0 && v <= 1e6, format!("bounds.{field}"), v, "above 0, up to 1e6"))
    };
    positive(entry.speed_max_m_s, "speed_max_m_s")?;
    positive(entry.body_rate_max_deg_s, "body_rate_max_deg_s")?;
    if let Some(v) = entry.tilt_max_deg {
        check(v > 0.0 && v < 90.0, "bounds.tilt_max_deg", v, "above 0 and below 90 (leave it out for none)")?;
    }
    if let Some(v) = entry.thrust_min_m_s2 {
        let must = format!("at least 0 and below g = {GRAVITY_M_S2}: no flight can accelerate up all the time");
        check((0.0..GRAVITY_M_S2).contains(&v), "bounds.thrust_min_m_s2", v, must)?;
    }
    if let Some(v) = entry.thrust_max_m_s2 {
        let must = format!("above g = {GRAVITY_M_S2}: it is divided by mass and must carry the weight");
        check(v > GRAVITY_M_S2 && v <= 1e6, "bounds.thrust_max_m_s2", v, must)?;
    }
    Ok(Bounds {
        speed_max_m_s: entry.speed_max_m_s,
        tilt_max_rad: entry.tilt_max_deg.map(f64::to_radians),
        thrust_min_m_s2: entry.thrust_min_m_s2,
        thrust_max_m_s2: entry.thrust_max_m_s2,
        body_rate_max_rad_s: entry.body_rate_max_deg_s.map(f64::to_radians),
    })
}

fn corridors(file: &PlanFile) -> Result<Vec<Corridor>, PlanError> {
    let corridor = |(entry, number): (&CorridorEntry, usize)| {
        let (from_s, to_s) = (entry.from_s.unwrap_or(0.0), entry.to_s.unwrap_or(file.duration_s));
        let must = format!("from 0 to duration_s = {} s", file.duration_s);
        check((0.0..=file.duration_s).contains(&from_s), format!("corridor {number}: from_s"), from_s, &must)?;
        check((0.0..=file.duration_s).contains(&to_s), format!("corridor {number}: to_s"), to_s, &must)?;
        if from_s >= to_s {
            return Err(PlanError::Crossed { field: format!("corridor {number}, time"), lower: from_s, upper: to_s });
        }
        let min_m = check_point(&format!("corridor {number}: min_m"), entry.min_m)?;
        let max_m = check_point(&format!("corridor {number}: max_m"), entry.max_m)?;
        for axis in 0..3 {
            if min_m[axis] >= max_m[axis] {
                let field = format!("corridor {number}, {}", ["x", "y", "z"][axis]);
                return Err(PlanError::Crossed { field, lower: min_m[axis], upper: max_m[axis] });
            }
        }
        Ok(Corridor { from_s, to_s, min_m, max_m })
    };
    file.corridors.iter().zip(1..).map(corridor).collect()
}
