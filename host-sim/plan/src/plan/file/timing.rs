//! Times of waypoints: those of a file, or the least within its bounds.

use nalgebra::Vector3;

use super::entries::{CorridorEntry, PlanFile, check};
use super::legs::{corridors_of, free_spans};
use super::{DURATIONS_S, SAME_TIME};
use crate::plan::error::{PlanError, WaypointName};
use crate::plan::times::Free;
use crate::plan::{Bounds, Budget, MOST_SPANS, Waypoint};

/// Puts times at the waypoints, from the file or the least within the bounds; whether they were free.
pub(super) fn times(
    file: &PlanFile,
    waypoints: &mut [Waypoint],
    bounds: &Bounds,
    corridors: &mut [CorridorEntry],
    stops: &[bool],
    budget: &Budget<'_>,
    notes: &mut Vec<String>,
) -> Result<bool, PlanError> {
    let timed = file.waypoints.iter().filter(|entry| entry.time_s.is_some()).count();
    let times_s = match (&file.segment_shares, timed) {
        (Some(shares), 0) => of_shares(file, shares)?,
        (Some(_), _) => {
            let first = file.waypoints.iter().zip(1..).find(|(entry, _)| entry.time_s.is_some());
            let waypoint = first.map_or(WaypointName { number: 1, time_s: None }, |(entry, number)| WaypointName {
                number,
                time_s: entry.time_s,
            });
            return Err(PlanError::WaypointTime { waypoint, twice: true });
        }
        (None, 0) => {
            let places: Vec<_> = waypoints.iter().map(|waypoint| (waypoint.position_m, waypoint.tolerance_m)).collect();
            return free_times(file, waypoints, &places, bounds, corridors, stops, budget).map(|()| true);
        }
        (None, _) => written(file)?,
    };
    let end_s = *times_s.last().unwrap_or(&0.0);
    let duration_s = file.duration_s.unwrap_or(end_s);
    let must = format!("from {} to {} s", DURATIONS_S.start(), DURATIONS_S.end());
    check(DURATIONS_S.contains(&duration_s), "duration_s", duration_s, must)?;
    // Another duration than the waypoints' own stretches them, and the corridors with them; the same keeps them to the bit.
    let ratio = duration_s / end_s;
    let stretches = (ratio - 1.0).abs() > SAME_TIME;
    if stretches {
        stretch(corridors, ratio);
        let too = if corridors.is_empty() { "" } else { " and corridors" };
        notes.push(format!("the times of the waypoints{too} are stretched by {ratio:.6} to duration_s = {duration_s}"));
    }
    let last = waypoints.len() - 1;
    let mut before_s: Option<f64> = None;
    for (index, (waypoint, time_s)) in waypoints.iter_mut().zip(&times_s).enumerate() {
        let name = WaypointName { number: index + 1, time_s: Some(*time_s) };
        let time_s = if index == last {
            duration_s
        } else if stretches {
            time_s * ratio
        } else {
            *time_s
        };
        if let Some(before_s) = before_s
            && time_s <= before_s + SAME_TIME * duration_s
        {
            return Err(PlanError::NotIncreasing { waypoint: name, before_s });
        }
        before_s = Some(time_s);
        waypoint.time_s = time_s;
    }
    Ok(false)
}

/// Corridors that last longer or shorter by a ratio.
pub(super) fn stretch(corridors: &mut [CorridorEntry], ratio: f64) {
    for time_s in corridors.iter_mut().flat_map(|corridor| [&mut corridor.from_s, &mut corridor.to_s]).flatten() {
        *time_s *= ratio;
    }
}

/// Times of the waypoints as written, s; the first is 0.
fn written(file: &PlanFile) -> Result<Vec<f64>, PlanError> {
    let mut times_s = Vec::new();
    for (entry, number) in file.waypoints.iter().zip(1..) {
        let name = WaypointName { number, time_s: None };
        times_s.push(entry.time_s.ok_or(PlanError::WaypointTime { waypoint: name, twice: false })?);
    }
    let end_s = *times_s.last().unwrap_or(&0.0);
    for (time_s, number) in times_s.iter_mut().zip(1..) {
        if number == 1 {
            if time_s.abs() > SAME_TIME * end_s.abs() {
                let waypoint = WaypointName { number, time_s: Some(*time_s) };
                return Err(PlanError::StartTime { waypoint });
            }
            *time_s = 0.0;
        }
        let must = format!("from 0 to that of the last waypoint, {end_s} s");
        let inside = *time_s >= 0.0 && *time_s <= end_s * (1.0 + SAME_TIME);
        check(inside, format!("waypoint {number}: time_s"), *time_s, must)?;
    }
    Ok(times_s)
}

fn of_shares(file: &PlanFile, shares: &[f64]) -> Result<Vec<f64>, PlanError> {
    if shares.len() + 1 != file.waypoints.len() {
        return Err(PlanError::SegmentShares { found: shares.len(), waypoints: file.waypoints.len() });
    }
    for (share, number) in shares.iter().zip(1..) {
        check(*share > 0.0 && *share <= 1e9, format!("segment_shares, entry {number}"), *share, "above 0, up to 1e9")?;
    }
    let Some(duration_s) = file.duration_s else { return Err(PlanError::SharesWithoutDuration) };
    let total: f64 = shares.iter().sum();
    let mut passed = 0.0;
    let later = shares.iter().map(|share| {
        passed += share;
        duration_s * (passed / total)
    });
    Ok(std::iter::once(0.0).chain(later).collect())
}

/// The least times within the bounds, from stop to stop; with a duration, in proportion to them.
fn free_times(
    file: &PlanFile,
    waypoints: &mut [Waypoint],
    places: &[(Vector3<f64>, f64)],
    bounds: &Bounds,
    corridors: &[CorridorEntry],
    stops: &[bool],
    budget: &Budget<'_>,
) -> Result<(), PlanError> {
    let accelerates = [bounds.acceleration_max_m_s2, bounds.tilt_max_rad, bounds.thrust_max_m_s2];
    if bounds.speed_max_m_s.is_none() && accelerates.iter().all(Option::is_none) {
        return Err(PlanError::NothingBounds);
    }
    if !file.rest_to_rest || waypoints.iter().any(|waypoint| waypoint.velocity_m_s.is_some()) {
        return Err(PlanError::MovingWithoutTimes);
    }
    if corridors.iter().any(|corridor| corridor.from_s.is_some() || corridor.to_s.is_some()) {
        return Err(PlanError::CorridorWithoutTimes);
    }
    let corridors = corridors_of(corridors, f64::INFINITY)?;
    let mut start = 0;
    let mut start_s = 0.0;
    waypoints[0].time_s = 0.0;
    for end in 1..waypoints.len() {
        if end + 1 != waypoints.len() && !stops[end] {
            continue;
        }
        let places = &places[start..=end];
        if places.len() == 2 && places[0].0 == places[1].0 {
            let waypoint = WaypointName { number: end + 1, time_s: None };
            return Err(PlanError::PauseWithoutTimes { waypoint });
        }
        let spans = file.spans.unwrap_or_else(|| free_spans(places.len() - 1));
        let free = Free { places, bounds, corridors: &corridors, degree: file.degree, spans };
        let Some(times_s) = free.times_s(budget) else {
            return Err(if budget.is_over() {
                PlanError::TimeLimit { limit_s: budget.limit_s() }
            } else {
                PlanError::NoTimes {
                    corridors: !corridors.is_empty(),
                    spans: spans < MOST_SPANS,
                    thrust: bounds.thrust_max_m_s2.is_some(),
                }
            });
        };
        for (waypoint, time_s) in waypoints[start..=end].iter_mut().zip(times_s) {
            waypoint.time_s = start_s + time_s;
        }
        (start, start_s) = (end, waypoints[end].time_s);
    }
    if let Some(duration_s) = file.duration_s {
        let ratio = duration_s / start_s;
        waypoints.iter_mut().for_each(|waypoint| waypoint.time_s *= ratio);
    }
    Ok(())
}
