//! Why no curve meets a plan: an infeasible plan in, the limits that are too tight and what would do out.
//!
//! Each limit in turn gets a slack, and the least slack is sought with all others kept; where there is one, that limit
//! alone explains the failure. Speed, thrust, corridors and tolerances are linear in the slack and one solution gives
//! the least value. Tilt and body rate bound ratios, `|a_xy| / (a_z + g)` and `|jerk| / zeta`: there the largest ratio of
//! the solution is the next bound to try, which descends to the least one (Dinkelbach's method).

use std::fmt;

use nalgebra::Vector3;
use quatrack_design::model::GRAVITY_M_S2;

use super::program::Program;
use super::socp::{self, Accuracy, Outcome};
use super::{Corridor, Plan};
use crate::trajectory::Trajectory;
use crate::trajectory::bspline::BSpline;

/// Most descents of a ratio; it converges faster than linearly, four are usual.
const MOST_DESCENTS: usize = 12;
/// A descent by less than this part ends the search; the value is printed to three digits.
const DESCENT_END: f64 = 1e-3;
/// Added to a value that would do, so that it does with room for the solver.
const ROOM: f64 = 1e-3;

/// A limit exceeded by less than this part, or this many metres, is met: ten times what the solver is asked to leave.
const TOUCHED: f64 = 1e-6;

/// Something that bounds a flight and can be relaxed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// `bounds.speed_max_m_s`.
    Speed,
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
}

/// A limit and what would do instead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remedy {
    /// Which one.
    pub limit: Limit,
    /// Its value, SI; 0 for corridors and waypoints.
    pub given: f64,
    /// A value that would do, SI; for corridors and waypoints how many metres more on every side.
    pub enough: f64,
}

/// What is too tight, as far as it can be told: every entry is one way out, and relaxes all it lists and nothing else.
/// Empty if none was found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Infeasibility {
    /// The ways out.
    pub ways_out: Vec<Vec<Remedy>>,
}

impl fmt::Display for Infeasibility {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("no curve meets the plan: ")?;
        if self.ways_out.is_empty() {
            return f.write_str(
                "no values of its bounds were found with which one does; allow a longer duration_s, or move waypoints",
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
            Limit::Tilt => ("tilt_max_deg", [self.given, self.enough].map(f64::to_degrees)),
            Limit::ThrustMin => ("thrust_min_m_s2", [self.given, self.enough]),
            Limit::ThrustMax => ("thrust_max_m_s2", [self.given, self.enough]),
            Limit::BodyRate => ("body_rate_max_deg_s", [self.given, self.enough].map(f64::to_degrees)),
            Limit::Corridor(index) => {
                let enough = outwards(self.enough);
                return write!(f, "corridor {} is too tight (every side {enough} m further out would do)", index + 1);
            }
            Limit::Waypoints => {
                let enough = outwards(self.enough);
                return write!(f, "the waypoints' tolerance_m is too tight ({enough} m more for each would do)");
            }
        };
        // Of a thrust, what counts is its distance to hover.
        let hover = if matches!(self.limit, Limit::ThrustMin | Limit::ThrustMax) { GRAVITY_M_S2 } else { 0.0 };
        // Sums with g and degrees from radians are a rounding off.
        let [given, enough] = [given, hover + outwards(enough - hover)].map(|value| (value * 1e9).round() / 1e9);
        write!(f, "{key} = {given} is too tight ({enough} would do)")
    }
}

/// A value to three digits, rounded away from 0.
fn outwards(value: f64) -> f64 {
    let digits = 2.0 - value.abs().max(1e-9).log10().floor();
    let scale = 10_f64.powf(digits);
    (value.abs() * scale).ceil() / scale * value.signum()
}

/// Finds what is too tight in a plan that no curve meets: first each limit alone; then, if that leaves only the
/// waypoints to give way, all bounds and corridors together; at last everything.
pub(super) fn diagnose(plan: &Plan) -> Infeasibility {
    let limits = plan.limits();
    let alone = limits.iter().filter_map(|&limit| plan.remedy(limit, enough(plan, limit)?));
    let mut ways_out: Vec<Vec<Remedy>> = alone.map(|remedy| vec![remedy]).collect();
    let bounds: Vec<Limit> = limits.iter().copied().filter(|limit| *limit != Limit::Waypoints).collect();
    if !ways_out.iter().flatten().any(|remedy| remedy.limit != Limit::Waypoints) {
        ways_out.splice(0..0, together(plan, &bounds));
    }
    if ways_out.is_empty() {
        ways_out.extend(together(plan, &limits));
    }
    Infeasibility { ways_out }
}

/// What is needed of several limits at once for their weighted sum to be least.
fn together(plan: &Plan, limits: &[Limit]) -> Option<Vec<Remedy>> {
    let curve = relaxed(plan, limits)?;
    let needed: Option<Vec<_>> = limits.iter().map(|&limit| Some((limit, plan.needed(limit, &curve)?))).collect();
    let remedies: Vec<_> = needed?.into_iter().filter_map(|(limit, needed)| plan.remedy(limit, needed)).collect();
    (!remedies.is_empty()).then_some(remedies)
}

/// The least value of one limit with which a curve exists, all others kept.
fn enough(plan: &Plan, limit: Limit) -> Option<f64> {
    let mut least = plan.needed(limit, &relaxed(plan, &[limit])?)?;
    let ratio = matches!(limit, Limit::Tilt | Limit::BodyRate);
    for _ in 0..if ratio { MOST_DESCENTS } else { 0 } {
        let mut trial = plan.clone();
        match limit {
            Limit::Tilt => trial.bounds.tilt_max_rad = Some(least),
            _ => trial.bounds.body_rate_max_rad_s = Some(least),
        }
        let Some(next) = relaxed(&trial, &[limit]).and_then(|curve| plan.needed(limit, &curve)) else { break };
        if next > least * (1.0 - DESCENT_END) {
            break;
        }
        least = next;
    }
    Some(least)
}

/// The curve with the least slack in the limits given, which are weighed by their size.
fn relaxed(plan: &Plan, limits: &[Limit]) -> Option<BSpline> {
    let weighted: Vec<(Limit, f64)> = limits.iter().map(|&limit| (limit, 1.0 / plan.slack_scale(limit))).collect();
    match socp::solve(&Program::new(plan, &weighted), Accuracy::THREE_DIGITS) {
        Outcome::Solved(values) => plan.curve(&values).ok(),
        Outcome::Infeasible | Outcome::Failed(_) => None,
    }
}

impl Plan {
    /// Every limit of the plan.
    fn limits(&self) -> Vec<Limit> {
        let bounds = &self.bounds;
        let bounded = [
            (Limit::Speed, bounds.speed_max_m_s),
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
        let kept = |limit| self.needed(limit, curve).is_some_and(|needed| self.remedy(limit, needed).is_none());
        self.limits().into_iter().all(kept)
    }

    /// A limit and what is needed of it, with room; `None` if it is not too tight at all.
    fn remedy(&self, limit: Limit, needed: f64) -> Option<Remedy> {
        let given = self.given(limit);
        let too_tight = if limit == Limit::ThrustMin {
            needed < given - TOUCHED
        } else {
            needed > given * (1.0 + TOUCHED) + TOUCHED
        };
        // Room is a part of the value, but for thrust of its distance to hover.
        let hover = if matches!(limit, Limit::ThrustMin | Limit::ThrustMax) { GRAVITY_M_S2 } else { 0.0 };
        too_tight.then_some(Remedy { limit, given, enough: needed + ROOM * (needed - hover) })
    }

    /// Value of a limit, SI; 0 where none is given, and for corridors and waypoints, which count what is added.
    fn given(&self, limit: Limit) -> f64 {
        let bounds = &self.bounds;
        let bound = match limit {
            Limit::Speed => bounds.speed_max_m_s,
            Limit::Tilt => bounds.tilt_max_rad,
            Limit::ThrustMin => bounds.thrust_min_m_s2,
            Limit::ThrustMax => bounds.thrust_max_m_s2,
            Limit::BodyRate => bounds.body_rate_max_rad_s,
            Limit::Corridor(_) | Limit::Waypoints => None,
        };
        bound.unwrap_or(0.0)
    }

    /// Size of the slack of a limit that counts as much as one of another.
    fn slack_scale(&self, limit: Limit) -> f64 {
        let given = self.given(limit);
        match limit {
            Limit::Speed => given,
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
