//! Plan files: TOML, or rows of waypoints, in; a [`FlightPlan`] whose numbers are all in range out.

mod entries;
mod timing;

use nalgebra::Vector3;
use quatrack_design::model::GRAVITY_M_S2;
use quatrack_design::vehicle::Vehicle;

use super::error::{PlanError, WaypointName};
use super::{Bounds, Budget, Corridor, FlightPlan, MOST_SPANS, Plan, Waypoint};
use crate::trajectory::bspline::UniformBasis;
use crate::trajectory::transform::Transform;
use crate::trajectory::waypoints::{self, WaypointRow};
use entries::{BoundsEntry, CorridorEntry, PlanFile, WaypointEntry, check, check_point};

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
    let file = if waypoints::recognises(text) {
        PlanFile::of_rows(&waypoints::parse(text).map_err(PlanError::Rows)?)
    } else {
        PlanFile::parse(text)?
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
        file.duration_s = Some(duration_s);
    }
    check_spline(&file)?;
    let mut waypoints = waypoints(&file)?;
    let bounds = bounds(&file.bounds, over)?;
    let mut notes = Vec::new();
    let stops = stops(&file, &waypoints, &mut notes)?;
    let mut corridors = file.corridors.clone();
    transform(&over.transform, &mut file, &mut waypoints, &mut corridors)?;
    let stops: Vec<bool> = if over.transform.reverse { stops.into_iter().rev().collect() } else { stops };
    let free = timing::times(&file, &mut waypoints, &bounds, &corridors, &stops, budget, &mut notes)?;
    headings(&mut waypoints, &stops);
    let legs = legs(&file, &waypoints, &bounds, &corridors, &stops, free)?;
    let legs = if free && file.duration_s.is_none() { roomy(legs, budget) } else { legs };
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

fn fewest_spans(degree: usize, rest: bool) -> usize {
    if rest { 8_usize.saturating_sub(degree).max(1) } else { 1 }
}

/// Waypoints with the times that are written, and not a number where there are none.
fn waypoints(file: &PlanFile) -> Result<Vec<Waypoint>, PlanError> {
    let count = file.waypoints.len();
    if count < 2 {
        return Err(PlanError::TooFewWaypoints(count));
    }
    let velocities = file.waypoints.iter().filter(|entry| entry.velocity_m_s.is_some()).count();
    if !file.rest_to_rest && count + velocities < 4 {
        return Err(PlanError::Undetermined(count));
    }
    let largest = entries::LARGEST_COORDINATE_M;
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
fn stops(file: &PlanFile, waypoints: &[Waypoint], notes: &mut Vec<String>) -> Result<Vec<bool>, PlanError> {
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

/// Moves, turns, scales and reverses the file's waypoints, before anything is planned.
fn transform(
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
    let end_s = file.duration_s.unwrap_or(written_s);
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

/// Headings at the start and at stops, where there are any at all: 0 at the start unless one is given there, and in between
/// in proportion to time; behind the last one it stays.
fn headings(waypoints: &mut [Waypoint], stops: &[bool]) {
    if waypoints.iter().all(|waypoint| waypoint.heading_rad.is_none()) {
        return;
    }
    waypoints[0].heading_rad.get_or_insert(0.0);
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

/// One plan from stop to stop.
fn legs(
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
fn free_spans(segments: usize) -> usize {
    (16 * segments).clamp(60, MOST_SPANS)
}

/// Eight spans a segment, and at least four in the shortest, so that each waypoint has control points of its own.
fn default_spans(waypoints: &[Waypoint]) -> usize {
    let segments = waypoints.windows(2).map(|pair| pair[1].time_s - pair[0].time_s);
    let duration_s: f64 = segments.clone().sum();
    let shortest_s = segments.fold(f64::INFINITY, f64::min);
    let of_shortest = (4.0 * duration_s / shortest_s).ceil().min(MOST_SPANS as f64) as usize;
    (8 * (waypoints.len() - 1)).max(of_shortest).clamp(24, MOST_SPANS)
}

/// With fewer samples than the snap has coefficients in a span, a curve could wiggle between them for nothing.
/// The period of a file is that of a whole flight.
fn snap_sample_period_s(file: &PlanFile, duration_s: f64, spans: usize, whole: bool) -> Result<f64, PlanError> {
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

fn corridors_of(entries: &[CorridorEntry], duration_s: f64) -> Result<Vec<Corridor>, PlanError> {
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
