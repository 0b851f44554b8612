//! Waypoints as a file writes them in; checked ones, where the flight stops, and its headings there out.

use nalgebra::Vector3;

use super::entries::{LARGEST_COORDINATE_M, PlanFile, check, check_point};
use crate::plan::Waypoint;
use crate::plan::error::{PlanError, WaypointName};

/// Waypoints with the times that are written, and not a number where there are none.
pub(super) fn waypoints(file: &PlanFile) -> Result<Vec<Waypoint>, PlanError> {
    let count = file.waypoints.len();
    if count < 2 {
        return Err(PlanError::TooFewWaypoints(count));
    }
    let velocities = file.waypoints.iter().filter(|entry| entry.velocity_m_s.is_some()).count();
    if !file.rest_to_rest && count + velocities < 4 {
        return Err(PlanError::Undetermined(count));
    }
    let largest = LARGEST_COORDINATE_M;
    file.waypoints
        .iter()
        .zip(1..)
        .map(|(entry, number)| {
            let field = format!("waypoint {number}: tolerance_m");
            let must = format!("from 0 (met exactly) to {largest} m");
            check((0.0..=largest).contains(&entry.tolerance_m), &field, entry.tolerance_m, must)?;
            if number == 1 || number == count {
                let must = "0 or left out: the flight starts and ends exactly";
                check(entry.tolerance_m == 0.0, field, entry.tolerance_m, must)?;
            }
            let position_m = check_point(&format!("waypoint {number}: position_m"), entry.position_m)?;
            let velocity_m_s = entry
                .velocity_m_s
                .map(|velocity| check_point(&format!("waypoint {number}: velocity_m_s"), velocity))
                .transpose()?;
            if let Some(yaw_deg) = entry.yaw_deg {
                let must = "a finite number within 1e6 degrees, turns counted";
                check(yaw_deg.abs() <= 1e6, format!("waypoint {number}: yaw_deg"), yaw_deg, must)?;
            }
            Ok(Waypoint {
                time_s: f64::NAN,
                position_m,
                tolerance_m: entry.tolerance_m,
                velocity_m_s,
                heading_rad: entry.yaw_deg.map(f64::to_radians),
            })
        })
        .collect()
}

/// Where the flight comes to rest: where a waypoint says so, and where two follow each other at the same place.
pub(super) fn stops(file: &PlanFile, waypoints: &[Waypoint], notes: &mut Vec<String>) -> Result<Vec<bool>, PlanError> {
    let last = waypoints.len() - 1;
    let mut stops: Vec<bool> = file.waypoints.iter().map(|entry| entry.stop).collect();
    for index in 0..last {
        let [here, next] = [&waypoints[index], &waypoints[index + 1]];
        let exact = here.tolerance_m == 0.0 && next.tolerance_m == 0.0;
        let free = here.velocity_m_s.is_none() && next.velocity_m_s.is_none();
        if here.position_m == next.position_m && exact && free && last > 1 {
            (stops[index], stops[index + 1]) = (true, true);
            notes.push(format!("waypoints {} and {} are the same place: it rests there", index + 1, index + 2));
        }
    }
    for (index, (stop, waypoint)) in stops.iter_mut().zip(waypoints).enumerate() {
        let moving = waypoint.velocity_m_s.is_some_and(|velocity| velocity != Vector3::zeros());
        let rests = *stop || (file.rest_to_rest && (index == 0 || index == last));
        if rests && moving {
            let waypoint = WaypointName { number: index + 1, time_s: file.waypoints[index].time_s };
            return Err(PlanError::MovingStop { waypoint });
        }
        // A stop is met where it is said to be.
        if *stop && waypoint.tolerance_m > 0.0 {
            let field = format!("waypoint {}: tolerance_m", index + 1);
            check(false, field, waypoint.tolerance_m, "0 or left out: a stop is met exactly")?;
        }
        *stop &= index != 0 && index != last;
    }
    Ok(stops)
}

/// Headings at both ends, where there are any at all: 0 at the start and the last given one at the end, unless one is given there.
pub(super) fn headings_at_ends(waypoints: &mut [Waypoint]) {
    let given = waypoints.iter().rev().find_map(|waypoint| waypoint.heading_rad);
    if let (Some(given), [first, .., last]) = (given, waypoints) {
        first.heading_rad.get_or_insert(0.0);
        last.heading_rad.get_or_insert(given);
    }
}

/// The same, and at stops those in between in proportion to time.
pub(super) fn headings(waypoints: &mut [Waypoint], stops: &[bool]) {
    headings_at_ends(waypoints);
    if waypoints.iter().all(|waypoint| waypoint.heading_rad.is_none()) {
        return;
    }
    for index in 1..waypoints.len() {
        if !stops[index] || waypoints[index].heading_rad.is_some() {
            continue;
        }
        let known = |waypoint: &Waypoint| Some((waypoint.time_s, waypoint.heading_rad?));
        let before = waypoints[..index].iter().rev().find_map(known).unwrap_or((0.0, 0.0));
        let after = waypoints[index..].iter().find_map(known).unwrap_or((f64::INFINITY, before.1));
        let share = (waypoints[index].time_s - before.0) / (after.0 - before.0);
        waypoints[index].heading_rad = Some(before.1 + share * (after.1 - before.1));
    }
}
