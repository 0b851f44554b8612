//! The heading along a curve: headings at waypoints (rad) in, a B-spline over the curve's own knots out.
//!
//! It is the smoothest one: least square of its second derivative, its own and its rate's zero at both ends. Its rate is
//! bounded by the control points of the derivative, as the position's is.

use super::program::{Affine, Constraint, Program};
use super::{BSpline, Budget, Plan, PlanError, socp};

/// The curve with its heading, where the plan gives any.
pub(super) fn planned(plan: &Plan, curve: BSpline, budget: &Budget<'_>) -> Result<BSpline, PlanError> {
    if plan.waypoints.iter().all(|waypoint| waypoint.heading_rad.is_none()) {
        return Ok(curve);
    }
    let Some(points) = solve(plan, false, budget)? else {
        return Err(refused(std::slice::from_ref(plan), budget)?);
    };
    Ok(curve.with_heading(points)?)
}

/// The refusal of curves one after the other of which one turns too slowly: the least rate, and the least duration of the whole, that
/// do for all.
pub(super) fn refused(legs: &[Plan], budget: &Budget<'_>) -> Result<PlanError, PlanError> {
    let mut needed: f64 = 0.0;
    for leg in legs.iter().filter(|leg| leg.waypoints.iter().any(|waypoint| waypoint.heading_rad.is_some())) {
        // The least rate that does, as the first variable behind the points.
        let least = solve(leg, true, budget)?.and_then(|points| largest_rate(leg, &points));
        needed = needed.max(least.unwrap_or(f64::INFINITY));
    }
    let bound = legs[0].bounds.heading_rate_max_rad_s.unwrap_or_default();
    let duration_s: f64 = legs.iter().map(Plan::duration_s).sum();
    Ok(PlanError::HeadingRate {
        given_deg_s: bound.to_degrees(),
        enough_deg_s: round_up(needed.to_degrees() * (1.0 + 1e-6)),
        duration_s: round_up(duration_s * needed / bound * (1.0 + 1e-6)),
    })
}

/// To four digits, away from 0.
fn round_up(value: f64) -> f64 {
    let scale = 10_f64.powf(3.0 - value.abs().max(1e-9).log10().floor());
    (value * scale).ceil() / scale
}

/// Largest rate of a heading's control points, rad/s.
fn largest_rate(plan: &Plan, points: &[f64]) -> Option<f64> {
    let weights = plan.basis.derivative_weights(1);
    let rates =
        weights.iter().enumerate().map(|(j, row)| row.iter().zip(&points[j..]).map(|(w, p)| w * p).sum::<f64>());
    rates.map(f64::abs).max_by(f64::total_cmp)
}

/// Control points of the smoothest heading within its rate, or of the slowest one; `None` if no such rate does.
fn solve(plan: &Plan, slowest: bool, budget: &Budget<'_>) -> Result<Option<Vec<f64>>, PlanError> {
    let basis = plan.basis;
    let n = basis.control_points();
    let mut constraints = Vec::new();
    let row = |order: usize, t_s: f64| {
        let (first, weights) = basis.derivative_at(order, t_s);
        Affine { terms: weights.iter().enumerate().map(|(i, w)| (first + i, *w)).collect(), constant: 0.0 }
    };
    for waypoint in &plan.waypoints {
        if let Some(heading_rad) = waypoint.heading_rad {
            constraints.push(Constraint::Zero(row(0, waypoint.time_s).plus(-heading_rad)));
        }
    }
    for (t_s, rest) in [(0.0, plan.rest[0]), (basis.duration_s(), plan.rest[1])] {
        let orders = if rest { 1..3 } else { 1..1 };
        constraints.extend(orders.map(|order| Constraint::Zero(row(order, t_s))));
    }
    if slowest || plan.bounds.heading_rate_max_rad_s.is_some() {
        for (j, weights) in basis.derivative_weights(1).iter().enumerate() {
            for sign in [1.0, -1.0] {
                let rate = Affine {
                    terms: weights.iter().enumerate().map(|(i, w)| (j + i, sign * w)).collect(),
                    constant: 0.0,
                };
                let room = match plan.bounds.heading_rate_max_rad_s {
                    Some(bound) if !slowest => rate.plus(bound),
                    _ => rate.plus_variable(n, 1.0),
                };
                constraints.push(Constraint::NonNegative(room));
            }
        }
    }
    let mut linear = vec![0.0; n + usize::from(slowest)];
    let mut quadratic = Vec::new();
    if slowest {
        linear[n] = 1.0;
    } else {
        // The square of the second derivative at four places a span, enough for its degree of at most 5.
        let weights = basis.derivative_weights(2);
        let mut band = std::collections::BTreeMap::new();
        for k in 0..4 * basis.spans() {
            let t_s = basis.duration_s() * (k as f64 + 0.5) / (4 * basis.spans()) as f64;
            let (first, values) = basis.derivative_by(&weights, 2, t_s);
            for (i, a) in values.iter().enumerate() {
                for (j, b) in values.iter().enumerate().skip(i) {
                    *band.entry((first + i, first + j)).or_insert(0.0) += 2.0 * a * b;
                }
            }
        }
        quadratic = band.into_iter().map(|((i, j), value)| (i, j, value)).collect();
    }
    let program = Program { variables: linear.len(), quadratic, linear, constraints };
    match socp::solve(&program, socp::Accuracy::EDGE, budget) {
        socp::Outcome::Solved(mut values) => {
            values.truncate(n);
            Ok(Some(values))
        }
        socp::Outcome::Infeasible => Ok(None),
        socp::Outcome::Failed(reason) if plan.bounds.heading_rate_max_rad_s.is_none() || slowest => {
            Err(PlanError::NotConverged(format!("heading: {reason}")))
        }
        socp::Outcome::Failed(_) => Ok(None),
        socp::Outcome::OutOfTime => Err(PlanError::TimeLimit { limit_s: budget.limit_s() }),
    }
}
