//! A plan and a curve in; each limit of the plan beside the one that the curve would need out.

use nalgebra::Vector3;
use quatrack_design::model::GRAVITY_M_S2;

use super::remedy::{Limit, Remedy, outwards};
use crate::plan::{Corridor, Plan};
use crate::trajectory::Trajectory;
use crate::trajectory::bspline::BSpline;

/// A limit exceeded by less than this part, or this many metres, is met: ten times the solver's tolerance.
const TOUCHED: f64 = 1e-6;

impl Plan {
    /// Every limit of the plan.
    pub(super) fn limits(&self) -> Vec<Limit> {
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
    pub(in crate::plan) fn kept_by(&self, curve: &BSpline) -> bool {
        let kept = |limit| self.needed(limit, curve).is_some_and(|needed| !self.is_too_tight(limit, needed));
        self.limits().into_iter().all(kept)
    }

    /// Whether more is needed of a limit than is given.
    fn is_too_tight(&self, limit: Limit, needed: f64) -> bool {
        let given = self.given(limit);
        if limit == Limit::ThrustMin { needed < given - TOUCHED } else { needed > given * (1.0 + TOUCHED) + TOUCHED }
    }

    /// A limit and the value that it needs, with room and as it is printed; `None` if it is not too tight at all.
    pub(super) fn remedy(&self, limit: Limit, needed: f64, room: f64) -> Option<Remedy> {
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
    pub(super) fn with(&self, remedies: &[Remedy]) -> Self {
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
    pub(super) fn slack_scale(&self, limit: Limit) -> f64 {
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
    pub(in crate::plan) fn needed(&self, limit: Limit, curve: &BSpline) -> Option<f64> {
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

pub(super) fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::NEG_INFINITY, f64::max)
}
