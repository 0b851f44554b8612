//! Plan files: TOML, or rows of waypoints, in; a [`FlightPlan`] whose numbers are all in range out.

mod entries;
mod legs;
mod moved;
mod timing;
mod waypoints;

use quatrack_design::model::GRAVITY_M_S2;
use quatrack_design::vehicle::Vehicle;

use super::error::PlanError;
use super::{Bounds, Budget, FlightPlan, MOST_SPANS, Plan};
use crate::trajectory::transform::Transform;
use crate::trajectory::waypoints::{self as rows, WaypointRow};
use entries::{BoundsEntry, PlanFile, WaypointEntry, check};
use legs::{fewest_spans, legs};
use moved::moved;
use waypoints::{headings, headings_at_ends, stops, waypoints};

/// Longest and shortest flight, s; shorter ones have snaps beyond the solver's scaling.
const DURATIONS_S: std::ops::RangeInclusive<f64> = 1e-2..=1e5;
/// Two times closer than this part of the duration are the same; that of a decimal number written in full.
const SAME_TIME: f64 = 1e-12;
/// Room that a flight in the least time is given, so that a curve smoother than the fastest meets its bounds.
const ROOMS: [f64; 4] = [1.005, 1.01, 1.02, 1.05];

/// From the name of a vehicle, as a file has it, to its figures, or to its fault in one line.
pub type FindVehicle<'a> = &'a dyn Fn(&str) -> Result<Vehicle, String>;

/// Values in place of the keys of a file, each where it is given.
#[derive(Clone, Copy, Default)]
pub struct Overrides<'a> {
    /// Bounds, SI.
    pub bounds: Bounds,
    /// A vehicle whose thrust and rates bound the flight.
    pub vehicle: Option<&'a Vehicle>,
    /// Length in time, s.
    pub duration_s: Option<f64>,
    /// Where the flight is moved, turned, scaled.
    pub transform: Transform,
    /// Finds the vehicle that a file names.
    pub vehicles: Option<FindVehicle<'a>>,
}

/// Reads a plan, TOML or rows of waypoints.
pub(super) fn read(text: &str, over: &Overrides<'_>, budget: &Budget<'_>) -> Result<FlightPlan, PlanError> {
    if text.lines().all(|line| line.split('#').next().is_none_or(|data| data.trim().is_empty())) {
        return Err(PlanError::Empty);
    }
    let file = if rows::recognises(text) {
        PlanFile::of_rows(&rows::parse(text).map_err(PlanError::Rows)?)
    } else {
        let meant = |error| match rows::parse(text) {
            Err(reason) if rows::are_numbers(text) => PlanError::Rows(reason),
            _ => error,
        };
        PlanFile::parse(text).map_err(meant)?
    };
    build(file, over, budget)
}

impl PlanFile {
    /// Rows of waypoints with the defaults of every other key; the first row is at time 0.
    fn of_rows(rows: &[WaypointRow]) -> Self {
        let start_s = rows.first().and_then(|row| row.time_s).unwrap_or(0.0);
        let entry = |row: &WaypointRow| WaypointEntry {
            time_s: row.time_s.map(|time_s| time_s - start_s),
            position_m: row.position_m.into(),
            yaw_deg: row.yaw_rad.map(f64::to_degrees),
            ..WaypointEntry::default()
        };
        Self { waypoints: rows.iter().map(entry).collect(), ..Self::default() }
    }
}

fn build(mut file: PlanFile, over: &Overrides<'_>, budget: &Budget<'_>) -> Result<FlightPlan, PlanError> {
    if let Some(duration_s) = over.duration_s {
        // Times written at waypoints are stretched later, with those of the corridors.
        if let (Some(_), Some(written_s)) = (&file.segment_shares, file.duration_s) {
            timing::stretch(&mut file.corridors, duration_s / written_s);
        }
        file.duration_s = Some(duration_s);
    }
    check_spline(&file)?;
    let mut waypoints = waypoints(&file)?;
    let bounds = bounds(&file.bounds, over)?;
    let mut notes = Vec::new();
    let stops = stops(&file, &waypoints, &mut notes)?;
    let mut corridors = file.corridors.clone();
    headings_at_ends(&mut waypoints);
    moved(&over.transform, &mut file, &mut waypoints, &mut corridors)?;
    let stops: Vec<bool> = if over.transform.reverse { stops.into_iter().rev().collect() } else { stops };
    let free = timing::times(&file, &mut waypoints, &bounds, &mut corridors, &stops, budget, &mut notes)?;
    headings(&mut waypoints, &stops);
    let legs = legs(&file, &waypoints, &bounds, &corridors, &stops, free)?;
    if !free {
        return Ok(FlightPlan { legs, free, notes });
    }
    // A duration has been scaled already.
    let (legs, time_scale) = match file.duration_s {
        Some(_) => (legs, None),
        None => (roomy(legs, budget), Some(over.transform.time_scale).filter(|scale| *scale != 1.0)),
    };
    let legs = match time_scale {
        Some(scale) => legs.iter().filter_map(|leg| leg.stretched(scale)).collect(),
        None => legs,
    };
    let total_s: f64 = legs.iter().map(Plan::duration_s).sum();
    notes.push(if file.duration_s.is_some() || time_scale.is_some() {
        format!("the times are in proportion to the least within the bounds, {total_s:.4} s in all")
    } else {
        format!("the times are the least within the bounds, {total_s:.4} s in all")
    });
    Ok(FlightPlan { legs, free, notes })
}

fn check_spline(file: &PlanFile) -> Result<(), PlanError> {
    let degree = file.degree;
    check(
        (4..=7).contains(&degree),
        "degree",
        degree as f64,
        "from 4, the least with a snap, to 7, the most that is flown",
    )?;
    if let Some(spans) = file.spans {
        let fewest = fewest_spans(degree, file.rest_to_rest);
        let rest = if fewest > 1 { " (four control points at rest at each end)" } else { "" };
        let must = format!("from {fewest}{rest} to {MOST_SPANS}");
        check((fewest..=MOST_SPANS).contains(&spans), "spans", spans as f64, must)?;
    }
    if let Some(duration_s) = file.duration_s {
        let must = format!("from {} to {} s", DURATIONS_S.start(), DURATIONS_S.end());
        check(DURATIONS_S.contains(&duration_s), "duration_s", duration_s, must)?;
    }
    let reward = file.body_rate_slack_reward;
    check((0.0..=1e6).contains(&reward), "body_rate_slack_reward", reward, "from 0 (none) to 1e6")
}

/// A little more time than the least, so that a curve smoother than the fastest one meets the bounds; and as much more as the
/// heading takes.
fn roomy(legs: Vec<Plan>, budget: &Budget<'_>) -> Vec<Plan> {
    let mut roomy = Vec::with_capacity(legs.len());
    for leg in legs {
        let mut stretched = leg.clone();
        for room in ROOMS {
            let Some(next) = leg.stretched(room) else { break };
            stretched = next;
            let Ok(curve) = stretched.curve_within(budget) else { continue };
            if let Err(PlanError::HeadingRate { duration_s, .. }) = super::heading::planned(&stretched, curve, budget) {
                stretched = stretched.stretched(duration_s / stretched.duration_s()).unwrap_or(stretched);
            }
            break;
        }
        roomy.push(stretched);
    }
    roomy
}

fn bounds(entry: &BoundsEntry, over: &Overrides<'_>) -> Result<Bounds, PlanError> {
    entry.check()?;
    let named = match (&entry.vehicle, over.vehicles) {
        (Some(name), Some(find)) => {
            Some(find(name).map_err(|reason| PlanError::Vehicle { name: name.clone(), reason })?)
        }
        (Some(name), None) => {
            let reason = "no vehicles are known here; state the bounds themselves".to_owned();
            return Err(PlanError::Vehicle { name: name.clone(), reason });
        }
        (None, _) => None,
    };
    let vehicle = over.vehicle.or(named.as_ref());
    let limits = vehicle.map(Vehicle::thrust_limits_m_s2);
    let rates = vehicle.map(Vehicle::body_rates_max_rad_s);
    // A craft that cannot fall faster than it glides still may: below 0 nothing is bounded.
    let bounds = Bounds {
        speed_max_m_s: over.bounds.speed_max_m_s.or(entry.speed_max_m_s),
        acceleration_max_m_s2: over.bounds.acceleration_max_m_s2.or(entry.acceleration_max_m_s2),
        tilt_max_rad: over.bounds.tilt_max_rad.or(entry.tilt_max_deg.map(f64::to_radians)),
        thrust_min_m_s2: over.bounds.thrust_min_m_s2.or(entry.thrust_min_m_s2).or(limits.map(|[min, _]| min.max(0.0))),
        thrust_max_m_s2: over.bounds.thrust_max_m_s2.or(entry.thrust_max_m_s2).or(limits.map(|[_, max]| max)),
        body_rate_max_rad_s: over
            .bounds
            .body_rate_max_rad_s
            .or(entry.body_rate_max_deg_s.map(f64::to_radians))
            .or(rates.map(|rates| rates.x.min(rates.y))),
        heading_rate_max_rad_s: over
            .bounds
            .heading_rate_max_rad_s
            .or(entry.yaw_rate_max_deg_s.map(f64::to_radians))
            .or(rates.map(|rates| rates.z)),
    };
    if let Some([_, max]) = limits.filter(|[min, max]| *min >= GRAVITY_M_S2 || *max <= GRAVITY_M_S2) {
        return Err(PlanError::Vehicle {
            name: vehicle.map_or_else(String::new, |vehicle| vehicle.name().to_owned()),
            reason: format!("its thrust, up to {max:.2} m/s^2, does not hover"),
        });
    }
    Ok(bounds)
}
