//! Why no curve meets a plan: an infeasible plan in, the limits that are too tight and the least that would do out.
//!
//! Each limit in turn gets a slack, and the least slack is sought with all others kept; where there is one, that limit
//! alone explains the failure. Speed, acceleration, thrust, corridors and tolerances are linear in the slack and one solution
//! gives the least value. Tilt and body rate bound ratios, `|a_xy| / (a_z + g)` and `|jerk| / zeta`: there the largest ratio of
//! the solution is the next bound to try, which descends to the least one (Dinkelbach's method). A longer duration loosens
//! every bound; the least is found by halving. Every printed remedy has been tried with the printed digits.

mod needed;
mod remedy;

use nalgebra::Vector3;

use super::budget::Budget;
use super::leg::NoCurve;
use super::program::Program;
use super::socp::{self, Accuracy, Outcome};
use super::{Plan, PlanError};
use crate::trajectory::bspline::BSpline;
use needed::largest;
use remedy::outwards;
pub use remedy::{Infeasibility, Limit, Remedy};

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
