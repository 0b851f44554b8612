//! A whole flight's waypoints and stops in; one plan from stop to stop, each with its spans, its samples and its
//! corridors, out.

use super::SAME_TIME;
use super::entries::{CorridorEntry, PlanFile, check, check_point};
use crate::plan::error::PlanError;
use crate::plan::{Bounds, Corridor, MOST_SPANS, Plan, Waypoint};
use crate::trajectory::bspline::UniformBasis;

pub(super) fn fewest_spans(degree: usize, rest: bool) -> usize {
    if rest { 8_usize.saturating_sub(degree).max(1) } else { 1 }
}

/// One plan from stop to stop.
pub(super) fn legs(
    file: &PlanFile,
    waypoints: &[Waypoint],
    bounds: &Bounds,
    corridors: &[CorridorEntry],
    stops: &[bool],
    free: bool,
) -> Result<Vec<Plan>, PlanError> {
    let last = waypoints.len() - 1;
    let duration_s = waypoints[last].time_s;
    let corridors = corridors_of(corridors, duration_s)?;
    let mut legs = Vec::new();
    let mut start = 0;
    for end in 1..=last {
        if end != last && !stops[end] {
            continue;
        }
        let start_s = waypoints[start].time_s;
        let leg_s = waypoints[end].time_s - start_s;
        let rest = [start != 0 || file.rest_to_rest, end != last || file.rest_to_rest];
        let mut own = waypoints[start..=end].to_vec();
        for waypoint in &mut own {
            waypoint.time_s = if start == 0 { waypoint.time_s } else { waypoint.time_s - start_s };
        }
        if let Some(end_waypoint) = own.last_mut() {
            end_waypoint.time_s = leg_s;
        }
        let fewest = fewest_spans(file.degree, rest.contains(&true));
        let spans = match file.spans {
            Some(spans) if free || (start == 0 && end == last) => spans,
            Some(spans) => ((spans as f64 * leg_s / duration_s).round() as usize).max(fewest),
            None if free => free_spans(own.len() - 1),
            None => default_spans(&own),
        };
        let whole = start == 0 && end == last;
        let snap_sample_period_s = snap_sample_period_s(file, leg_s, spans, whole)?;
        let own_corridors = corridors.iter().filter(|c| c.from_s < start_s + leg_s && c.to_s > start_s);
        let plan = Plan {
            basis: UniformBasis::new(file.degree, spans, leg_s)?,
            rest,
            snap_sample_period_s,
            body_rate_slack_reward: file.body_rate_slack_reward,
            waypoints: own,
            bounds: *bounds,
            corridors: own_corridors
                .map(|c| Corridor { from_s: (c.from_s - start_s).max(0.0), to_s: (c.to_s - start_s).min(leg_s), ..*c })
                .collect(),
            first_number: start + 1,
        };
        plan.check_spans()?;
        legs.push(plan);
        start = end;
    }
    Ok(legs)
}

/// Sixteen spans a segment where the times are free, as far as they go: with fewer than two or three the slowest segment sets the
/// pace of all.
pub(super) fn free_spans(segments: usize) -> usize {
    (16 * segments).clamp(60, MOST_SPANS)
}

/// Eight spans a segment, and at least four in the shortest, so that each waypoint has control points of its own.
pub(super) fn default_spans(waypoints: &[Waypoint]) -> usize {
    let segments = waypoints.windows(2).map(|pair| pair[1].time_s - pair[0].time_s);
    let duration_s: f64 = segments.clone().sum();
    let shortest_s = segments.fold(f64::INFINITY, f64::min);
    let of_shortest = (4.0 * duration_s / shortest_s).ceil().min(MOST_SPANS as f64) as usize;
    (8 * (waypoints.len() - 1)).max(of_shortest).clamp(24, MOST_SPANS)
}

/// With fewer samples than the snap has coefficients in a span, a curve could wiggle between them for nothing.
/// The period of a file is that of a whole flight.
pub(super) fn snap_sample_period_s(
    file: &PlanFile,
    duration_s: f64,
    spans: usize,
    whole: bool,
) -> Result<f64, PlanError> {
    let longest_s = duration_s / (spans * (file.degree - 3)) as f64;
    let Some(period_s) = file.snap_sample_period_s else { return Ok(0.5 * longest_s) };
    if !whole && period_s > 0.0 {
        return Ok(period_s.clamp(1e-6 * duration_s, longest_s));
    }
    check(
        period_s >= 1e-6 * duration_s && period_s <= longest_s * (1.0 + SAME_TIME),
        "snap_sample_period_s",
        period_s,
        format!(
            "above 0 and at most {longest_s:.6} s, that is {} samples a span (and at least a millionth of duration_s); or \
             leave it out",
            file.degree - 3
        ),
    )?;
    Ok(period_s)
}

pub(super) fn corridors_of(entries: &[CorridorEntry], duration_s: f64) -> Result<Vec<Corridor>, PlanError> {
    let corridor = |(entry, number): (&CorridorEntry, usize)| {
        let (from_s, to_s) = (entry.from_s.unwrap_or(0.0), entry.to_s.unwrap_or(duration_s));
        let must = format!("from 0 to duration_s = {duration_s} s");
        check((0.0..=duration_s).contains(&from_s), format!("corridor {number}: from_s"), from_s, &must)?;
        check((0.0..=duration_s).contains(&to_s), format!("corridor {number}: to_s"), to_s, &must)?;
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
    entries.iter().zip(1..).map(corridor).collect()
}
