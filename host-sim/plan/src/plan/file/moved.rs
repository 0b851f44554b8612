//! A plan file's waypoints, corridors and times in; the same moved, turned, scaled, slowed and reversed, before
//! anything is planned, out.

use nalgebra::Vector3;

use super::entries::{CorridorEntry, PlanFile};
use crate::plan::Waypoint;
use crate::plan::error::PlanError;
use crate::trajectory::transform::Transform;

/// Moves, turns, scales and reverses the file's waypoints, before anything is planned.
pub(super) fn moved(
    transform: &Transform,
    file: &mut PlanFile,
    waypoints: &mut [Waypoint],
    corridors: &mut [CorridorEntry],
) -> Result<(), PlanError> {
    if *transform == Transform::default() {
        return Ok(());
    }
    if transform.turn_rad != 0.0 && !corridors.is_empty() {
        return Err(PlanError::TurnedCorridor);
    }
    let written_s = file.waypoints.iter().filter_map(|entry| entry.time_s).fold(0.0, f64::max);
    // Corridors are in the times of the waypoints, where those are written.
    let end_s = if written_s > 0.0 { written_s } else { file.duration_s.unwrap_or(0.0) };
    if transform.reverse {
        waypoints.reverse();
        file.waypoints.reverse();
        if let Some(shares) = &mut file.segment_shares {
            shares.reverse();
        }
        for entry in &mut file.waypoints {
            entry.time_s = entry.time_s.map(|time_s| written_s - time_s);
        }
        for corridor in corridors.iter_mut() {
            (corridor.from_s, corridor.to_s) =
                (corridor.to_s.map(|to_s| end_s - to_s), corridor.from_s.map(|from_s| end_s - from_s));
        }
    }
    let sign = if transform.reverse { -1.0 } else { 1.0 };
    let origin_m = waypoints[0].position_m;
    for waypoint in waypoints.iter_mut() {
        waypoint.position_m = transform.point(&origin_m, &waypoint.position_m);
        waypoint.tolerance_m *= transform.scale;
        waypoint.velocity_m_s =
            waypoint.velocity_m_s.map(|velocity| transform.vector(&velocity) * (sign / transform.time_scale));
        waypoint.heading_rad = waypoint.heading_rad.map(|heading_rad| heading_rad + transform.turn_rad);
    }
    if transform.turn_rad != 0.0 && waypoints[0].heading_rad.is_none() {
        waypoints[0].heading_rad = Some(transform.turn_rad);
    }
    for corridor in corridors {
        let [min_m, max_m] = [corridor.min_m, corridor.max_m].map(|p| transform.point(&origin_m, &Vector3::from(p)));
        (corridor.min_m, corridor.max_m) = (min_m.into(), max_m.into());
        corridor.from_s = corridor.from_s.map(|from_s| transform.time_scale * from_s);
        corridor.to_s = corridor.to_s.map(|to_s| transform.time_scale * to_s);
    }
    file.duration_s = file.duration_s.map(|duration_s| transform.time_scale * duration_s);
    file.snap_sample_period_s = file.snap_sample_period_s.map(|period_s| transform.time_scale * period_s);
    for entry in &mut file.waypoints {
        entry.time_s = entry.time_s.map(|time_s| transform.time_scale * time_s);
    }
    Ok(())
}
