//! Why no curve meets a plan: an infeasible plan in, the limits that are too tight and the least that would do out.
//!
//! Each limit in turn gets a slack, and the least slack is sought with all others kept; where there is one, that limit
//! alone explains the failure. Speed, acceleration, thrust, corridors and tolerances are linear in the slack and one solution
//! gives the least value. Tilt and body rate bound ratios, `|a_xy| / (a_z + g)` and `|jerk| / zeta`: there the largest ratio of
//! the solution is the next bound to try, which descends to the least one (Dinkelbach's method). A longer duration loosens
//! every bound; the least is found by halving. Every printed remedy has been tried with the printed digits.

use std::fmt;

use nalgebra::Vector3;
use quatrack_design::model::GRAVITY_M_S2;

use super::budget::Budget;
use super::leg::NoCurve;
use super::program::Program;
use super::socp::{self, Accuracy, Outcome};
use super::{Corridor, Plan, PlanError};
use crate::trajectory::Trajectory;
use crate::trajectory::bspline::BSpline;

/// Most descents of a ratio; it converges faster than linearly, four are usual.
const MOST_DESCENTS: usize = 12;
/// A descent by less than this part ends the search; the value is printed to four digits.
const DESCENT_END: f64 = 1e-4;
/// Parts of a value that are added until it does as printed: the solver needs some room, mostly none.
const ROOMS: [f64; 7] = [0.0, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 3e-2];
/// Longest flight that is tried, over the one that is asked for.
const LONGEST: f64 = 64.0;
/// The duration is told within this part.
const DURATION_WITHIN: f64 = 1e-3;

/// A limit exceeded by less than this part, or this many metres, is met: ten times the solver's tolerance.
const TOUCHED: f64 = 1e-6;

/// Something that bounds a flight and can be relaxed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Limit {
    /// `bounds.speed_max_m_s`.
    Speed,
    /// `bounds.acceleration_max_m_s2`.
    Acceleration,
    /// `bounds.tilt_max_deg`.
    Tilt,
    /// `bounds.thrust_min_m_s2`.
    ThrustMin,
    /// `bounds.thrust_max_m_s2`.
    ThrustMax,
    /// `bounds.body_rate_max_deg_s`.
    BodyRate,
    /// One of `[[corridors]]`, from 0.
    Corridor(usize),
    /// `tolerance_m` of every waypoint between start and end.
    Waypoints,
    /// `duration_s`.
    Duration,
}

/// A limit and the least value that would do instead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remedy {
    /// The limit.
    pub limit: Limit,
    /// Its value, SI; 0 for corridors and waypoints.
    pub given: f64,
    /// A value that would do, SI; for corridors and waypoints how many metres more on every side.
    pub enough: f64,
}

/// The limits that are too tight, as far as they can be told: every entry is one way out, and relaxes all it lists and
/// nothing else. Empty if none was found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Infeasibility {
    /// The ways out.
    pub ways_out: Vec<Vec<Remedy>>,
}

impl Remedy {
    /// Whether a plan file may say so.
    fn is_readable(&self) -> bool {
        let most = match self.limit {
            Limit::Tilt => 90_f64.to_radians() * (1.0 - 1e-9),
            Limit::BodyRate => 1e6_f64.to_radians(),
            Limit::Waypoints | Limit::Corridor(_) => 1e5,
            _ => 1e6,
        };
        self.enough >= 0.0 && self.enough <= most
    }
}

impl fmt::Display for Infeasibility {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("no curve meets the plan: ")?;
        if self.ways_out.is_empty() {
            return f.write_str(
                "no values of its bounds and no duration_s were found with which one does; move waypoints, or raise spans",
            );
        }
        let way = |remedies: &Vec<Remedy>| remedies.iter().map(ToString::to_string).collect::<Vec<_>>().join(" and ");
        write!(f, "{}; the rest kept", self.ways_out.iter().map(way).collect::<Vec<_>>().join(", or "))
    }
}

impl fmt::Display for Remedy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (key, [given, enough]) = match self.limit {
            Limit::Speed => ("speed_max_m_s", [self.given, self.enough]),
            Limit::Acceleration => ("acceleration_max_m_s2", [self.given, self.enough]),
            Limit::Duration => {
                let [given, enough] = [self.given, self.enough].map(|value| (value * 1e9).round() / 1e9);
                return write!(f, "duration_s = {given} is too short (duration_s = {enough} would do)");
            }
            Limit::Tilt => ("tilt_max_deg", [self.given, self.enough].map(f64::to_degrees)),
            Limit::ThrustMin => ("thrust_min_m_s2", [self.given, self.enough]),
            Limit::ThrustMax => ("thrust_max_m_s2", [self.given, self.enough]),
            Limit::BodyRate => ("body_rate_max_deg_s", [self.given, self.enough].map(f64::to_degrees)),
            Limit::Corridor(index) => {
                return write!(
                    f,
                    "corridor {} is too tight (every side {} m further out would do)",
                    index + 1,
                    self.enough
                );
            }
            Limit::Waypoints => {
                return write!(f, "the waypoints' tolerance_m is too tight ({} m more for each would do)", self.enough);
            }
        };
        // Degrees from radians are a rounding off.
        let [given, enough] = [given, enough].map(|value| (value * 1e9).round() / 1e9);
        write!(f, "{key} = {given} is too tight ({enough} would do)")
    }
}

/// A value to four digits, rounded away from 0.
fn outwards(value: f64) -> f64 {
    let digits = 3.0 - value.abs().max(1e-9).log10().floor();
    let scale = 10_f64.powf(digits);
    // A value of four digits is not moved by its own rounding.
    (value.abs() * scale * (1.0 - 1e-12)).ceil() / scale * value.signum()
}

/// The diagnosis of curves one after the other of which one has `reason` not to be: the limits that are too tight, first
/// each limit alone; if that leaves only the waypoints to give way, all bounds and corridors together, at last
/// everything; and how much longer it would have to be.
pub(super) fn diagnose(legs: &[Plan], reason: &NoCurve, budget: &Budget<'_>) -> PlanError {
    let mut ways_out: Vec<Vec<Remedy>> = Vec::new();
    if *reason != NoCurve::OutOfTime {
        let duration = longer(legs, budget);
        // The limits are those of all; each leg may have corridors and waypoints of its own.
        let limits: Vec<Limit> = legs[0].limits();
        for &limit in &limits {
            budget.say(&format!("looking for limits that are too tight: {limit:?}"));
            ways_out.extend(tried(legs, &[limit], budget));
        }
        let bounds: Vec<Limit> = limits.iter().copied().filter(|limit| *limit != Limit::Waypoints).collect();
        if !ways_out.iter().flatten().any(|remedy| remedy.limit != Limit::Waypoints) {
            ways_out.splice(0..0, tried(legs, &bounds, budget));
        }
        if ways_out.is_empty() {
            ways_out.extend(tried(legs, &limits, budget));
        }
        ways_out.extend(duration.map(|remedy| vec![remedy]));
    }
    match reason {
        _ if !ways_out.is_empty() => PlanError::Infeasible(Infeasibility { ways_out }),
        _ if budget.is_over() => PlanError::TimeLimit { limit_s: budget.limit_s() },
        NoCurve::Failed(reason) => PlanError::NotConverged(reason.clone()),
        NoCurve::Infeasible | NoCurve::OutOfTime => PlanError::Infeasible(Infeasibility { ways_out }),
    }
}

/// Whether every leg has a curve.
fn all_solve(legs: &[Plan], budget: &Budget<'_>) -> bool {
    legs.iter().all(|leg| leg.curve_within(budget).is_ok())
}

/// The values that several limits need at once, as they are printed and tried.
fn tried(legs: &[Plan], limits: &[Limit], budget: &Budget<'_>) -> Option<Vec<Remedy>> {
    // Of a leg that has a curve nothing is needed.
    let needed: Vec<Vec<f64>> = legs.iter().filter_map(|leg| least(leg, limits, budget)).collect();
    if needed.is_empty() {
        return None;
    }
    let of_all = |index: usize| {
        let values = needed.iter().map(|values| values[index]);
        if limits[index] == Limit::ThrustMin { values.fold(f64::INFINITY, f64::min) } else { largest(values) }
    };
    ROOMS.iter().find_map(|room| {
        let remedies: Vec<Remedy> = limits
            .iter()
            .enumerate()
            .filter_map(|(index, &limit)| legs[0].remedy(limit, of_all(index), *room))
            .collect();
        let readable = !remedies.is_empty() && remedies.iter().all(Remedy::is_readable);
        let relaxed: Vec<Plan> = legs.iter().map(|leg| leg.with(&remedies)).collect();
        (readable && !budget.is_over() && all_solve(&relaxed, budget)).then_some(remedies)
    })
}

/// The least values of limits with which a leg has a curve.
fn least(leg: &Plan, limits: &[Limit], budget: &Budget<'_>) -> Option<Vec<f64>> {
    match limits {
        [limit] => Some(vec![enough(leg, *limit, budget)?]),
        limits => {
            let curve = relaxed(leg, limits, budget)?;
            limits.iter().map(|&limit| leg.needed(limit, &curve)).collect()
        }
    }
}

/// The least duration with which all have a curve, as it is printed and tried.
fn longer(legs: &[Plan], budget: &Budget<'_>) -> Option<Remedy> {
    let given: f64 = legs.iter().map(Plan::duration_s).sum();
    let does = |enough: f64| {
        let stretched: Option<Vec<Plan>> = legs.iter().map(|leg| leg.stretched(enough / given)).collect();
        !budget.is_over() && stretched.is_some_and(|legs| all_solve(&legs, budget))
    };
    budget.say("looking for a longer duration");
    let (mut short, mut long) = (given, 1.02 * given);
    while !does(long) {
        if long > LONGEST * given || budget.is_over() {
            return None;
        }
        (short, long) = (long, given + 2.0 * (long - given));
    }
    while long > short * (1.0 + DURATION_WITHIN) {
        let middle = 0.5 * (short + long);
        if does(middle) { long = middle } else { short = middle }
    }
    let candidates = ROOMS.iter().map(|room| outwards(long * (1.0 + room)));
    let enough = candidates.into_iter().find(|enough| does(*enough))?;
    Some(Remedy { limit: Limit::Duration, given, enough })
}

/// The least value of one limit with which a curve exists, all others kept.
fn enough(plan: &Plan, limit: Limit, budget: &Budget<'_>) -> Option<f64> {
    let mut least = plan.needed(limit, &relaxed(plan, &[limit], budget)?)?;
    let ratio = matches!(limit, Limit::Tilt | Limit::BodyRate);
    for _ in 0..if ratio { MOST_DESCENTS } else { 0 } {
        let mut trial = plan.clone();
        match limit {
            Limit::Tilt => trial.bounds.tilt_max_rad = Some(least),
            _ => trial.bounds.body_rate_max_rad_s = Some(least),
        }
        let Some(next) = relaxed(&trial, &[limit], budget).and_then(|curve| plan.needed(limit, &curve)) else { break };
        if next > least * (1.0 - DESCENT_END) {
            break;
        }
        least = next;
    }
    Some(least)
}

/// The curve with the least slack in the limits given, each slack over the size of its limit.
fn relaxed(plan: &Plan, limits: &[Limit], budget: &Budget<'_>) -> Option<BSpline> {
    let origin_m = plan.waypoints().first()?.position_m;
    if origin_m != Vector3::zeros() {
        let curve = relaxed(&plan.moved(&-origin_m), limits, budget)?;
        let points = curve.control_points_m().iter().map(|point| point + origin_m).collect();
        return BSpline::new(plan.degree(), plan.duration_s(), points).ok();
    }
    let weighted: Vec<(Limit, f64)> = limits.iter().map(|&limit| (limit, 1.0 / plan.slack_scale(limit))).collect();
    match socp::solve(&Program::new(plan, &weighted), Accuracy::THREE_DIGITS, budget) {
        Outcome::Solved(values) => plan.curve(&values).ok(),
        Outcome::Infeasible | Outcome::Failed(_) | Outcome::OutOfTime => None,
    }
}

impl Plan {
    /// Every limit of the plan.
    fn limits(&self) -> Vec<Limit> {
        let bounds = &self.bounds;
        let bounded = [
            (Limit::Speed, bounds.speed_max_m_s),
            (Limit::Acceleration, bounds.acceleration_max_m_s2),
            (Limit::Tilt, bounds.tilt_max_rad),
            (Limit::ThrustMin, bounds.thrust_min_m_s2),
            (Limit::ThrustMax, bounds.thrust_max_m_s2),
            (Limit::BodyRate, bounds.body_rate_max_rad_s),
        ];
        let bounded = bounded.into_iter().filter(|(_, bound)| bound.is_some()).map(|(limit, _)| limit);
        let corridors = (0..self.corridors.len()).map(Limit::Corridor);
        let waypoints = (!self.inner_waypoints().is_empty()).then_some(Limit::Waypoints);
        bounded.chain(corridors).chain(waypoints).collect()
    }

    /// Whether a curve keeps to every limit, by its control points and at the waypoints.
    pub(super) fn kept_by(&self, curve: &BSpline) -> bool {
        let kept = |limit| self.needed(limit, curve).is_some_and(|needed| !self.is_too_tight(limit, needed));
        self.limits().into_iter().all(kept)
    }

    /// Whether more is needed of a limit than is given.
    fn is_too_tight(&self, limit: Limit, needed: f64) -> bool {
        let given = self.given(limit);
        if limit == Limit::ThrustMin { needed < given - TOUCHED } else { needed > given * (1.0 + TOUCHED) + TOUCHED }
    }

    /// A limit and the value that it needs, with room and as it is printed; `None` if it is not too tight at all.
    fn remedy(&self, limit: Limit, needed: f64, room: f64) -> Option<Remedy> {
        let given = self.given(limit);
        // Of a thrust, its distance to hover counts.
        let hover = if matches!(limit, Limit::ThrustMin | Limit::ThrustMax) { GRAVITY_M_S2 } else { 0.0 };
        let with_room = needed + room * (needed - hover);
        let enough = match limit {
            Limit::Tilt | Limit::BodyRate => outwards(with_room.to_degrees()).to_radians(),
            // Sums with g are a rounding off.
            _ => ((hover + outwards(with_room - hover)) * 1e9).round() / 1e9,
        };
        self.is_too_tight(limit, needed).then_some(Remedy { limit, given, enough })
    }

    /// The plan with remedies taken.
    fn with(&self, remedies: &[Remedy]) -> Self {
        let mut plan = self.clone();
        for Remedy { limit, enough, .. } in remedies {
            let bounds = &mut plan.bounds;
            match *limit {
                Limit::Speed => bounds.speed_max_m_s = Some(*enough),
                Limit::Acceleration => bounds.acceleration_max_m_s2 = Some(*enough),
                Limit::Tilt => bounds.tilt_max_rad = Some(*enough),
                Limit::ThrustMin => bounds.thrust_min_m_s2 = Some(*enough),
                Limit::ThrustMax => bounds.thrust_max_m_s2 = Some(*enough),
                Limit::BodyRate => bounds.body_rate_max_rad_s = Some(*enough),
                Limit::Corridor(index) => {
                    if let Some(corridor) = plan.corridors.get_mut(index) {
                        corridor.min_m.add_scalar_mut(-enough);
                        corridor.max_m.add_scalar_mut(*enough);
                    }
                }
                Limit::Waypoints => {
                    let last = plan.waypoints.len().saturating_sub(1);
                    plan.waypoints.iter_mut().take(last).skip(1).for_each(|waypoint| waypoint.tolerance_m += enough);
                }
                Limit::Duration => {}
            }
        }
        plan
    }

    /// Value of a limit, SI; 0 where none is given, and for corridors and waypoints, which count the addition.
    fn given(&self, limit: Limit) -> f64 {
        let bounds = &self.bounds;
        let bound = match limit {
            Limit::Speed => bounds.speed_max_m_s,
            Limit::Acceleration => bounds.acceleration_max_m_s2,
            Limit::Tilt => bounds.tilt_max_rad,
            Limit::ThrustMin => bounds.thrust_min_m_s2,
            Limit::ThrustMax => bounds.thrust_max_m_s2,
            Limit::BodyRate => bounds.body_rate_max_rad_s,
            Limit::Corridor(_) | Limit::Waypoints | Limit::Duration => None,
        };
        bound.unwrap_or(0.0)
    }

    /// Size of the slack of a limit that counts as much as one of another.
    fn slack_scale(&self, limit: Limit) -> f64 {
        let given = self.given(limit);
        match limit {
            Limit::Speed | Limit::Acceleration | Limit::Duration => given,
            Limit::Tilt => given.tan() * GRAVITY_M_S2,
            Limit::ThrustMin | Limit::ThrustMax => (given - GRAVITY_M_S2).abs(),
            Limit::BodyRate => given * GRAVITY_M_S2,
            Limit::Corridor(_) | Limit::Waypoints => {
                let legs = self.waypoints.windows(2).map(|pair| (pair[1].position_m - pair[0].position_m).norm());
                0.1 * legs.fold(1e-2, f64::max)
            }
        }
    }

    /// The value of a limit that a curve needs so that the bound can be proved by control points; `None` if none can be.
    pub(super) fn needed(&self, limit: Limit, curve: &BSpline) -> Option<f64> {
        let gravity = Vector3::new(0.0, 0.0, GRAVITY_M_S2);
        let thrusts = || curve.derivative_control_points(2).into_iter().map(|acceleration| acceleration + gravity);
        match limit {
            Limit::Speed => Some(largest(curve.derivative_control_points(1).iter().map(Vector3::norm))),
            Limit::Acceleration => Some(largest(curve.derivative_control_points(2).iter().map(Vector3::norm))),
            Limit::Duration => None,
            Limit::Tilt => {
                let tilt_rad = largest(thrusts().map(|thrust| thrust.xy().norm().atan2(thrust.z)));
                (tilt_rad < std::f64::consts::FRAC_PI_2).then_some(tilt_rad)
            }
            Limit::ThrustMin => Some(-largest(thrusts().map(|thrust| -thrust.z))).filter(|least| *least >= 0.0),
            Limit::ThrustMax => Some(largest(thrusts().map(|thrust| thrust.norm()))),
            Limit::BodyRate => {
                let lifts: Vec<f64> = thrusts().map(|thrust| thrust.z).collect();
                let jerks = curve.derivative_control_points(3);
                let rate = |span: usize| {
                    let lift = -largest(lifts[span..span + self.degree() - 1].iter().map(|lift| -lift));
                    let jerk = largest(jerks[span..span + self.degree() - 2].iter().map(Vector3::norm));
                    (lift > 0.0).then_some(jerk / lift)
                };
                let rates: Option<Vec<f64>> = (0..self.spans()).map(rate).collect();
                Some(largest(rates?.into_iter()))
            }
            Limit::Corridor(index) => self.corridors.get(index).map(|corridor| self.widening_m(corridor, curve)),
            Limit::Waypoints => {
                let misses = self.inner_waypoints().iter();
                Some(largest(misses.map(|w| (curve.at(w.time_s).position_m - w.position_m).norm() - w.tolerance_m)))
            }
        }
    }

    /// How far control points are outside a corridor, m; 0 if they do not.
    fn widening_m(&self, corridor: &Corridor, curve: &BSpline) -> f64 {
        let points = &curve.control_points_m()[self.points_of(corridor)];
        largest(points.iter().map(|p| (corridor.min_m - p).max().max((p - corridor.max_m).max()))).max(0.0)
    }
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::NEG_INFINITY, f64::max)
}
