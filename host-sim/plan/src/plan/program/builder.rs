//! The constraints of a plan on control points: where it starts and ends, its waypoints, and its bounds, each with the
//! slack of a relaxed limit.

use quatrack_design::model::GRAVITY_M_S2;

use super::{Affine, Constraint};
use crate::plan::{Limit, Plan, Waypoint};
use crate::trajectory::bspline::UniformBasis;

/// Writes down the constraints of a plan.
pub(super) struct Builder<'a> {
    pub(super) plan: &'a Plan,
    pub(super) basis: UniformBasis,
    pub(super) slacks: Vec<(Limit, usize)>,
    pub(super) constraints: Vec<Constraint>,
}

impl Builder<'_> {
    /// `bound`, with the slack of its limit if that one is relaxed.
    fn relaxed(&self, limit: Limit, bound: Affine) -> Affine {
        match self.slacks.iter().find(|(relaxed, _)| *relaxed == limit) {
            Some((_, variable)) => bound.plus_variable(*variable, 1.0),
            None => bound,
        }
    }

    /// Coordinate `axis` of control point `j` of the derivative whose weights are given.
    fn point(&self, weights: &[Vec<f64>], j: usize, axis: usize) -> Affine {
        let first = axis * self.basis.control_points() + j;
        Affine { terms: weights[j].iter().enumerate().map(|(i, weight)| (first + i, *weight)).collect(), constant: 0.0 }
    }

    /// All three coordinates of it.
    fn vector(&self, weights: &[Vec<f64>], j: usize) -> Vec<Affine> {
        (0..3).map(|axis| self.point(weights, j, axis)).collect()
    }

    /// Where the flight starts and ends; with rest, four control points each, so that velocity, acceleration and jerk
    /// are zero there; else the velocity if one is given.
    pub(super) fn ends(&mut self) {
        let n = self.basis.control_points();
        let (Some(start), Some(end)) = (self.plan.waypoints.first(), self.plan.waypoints.last()) else { return };
        let [at_start, at_end] = self.plan.points_at_the_ends();
        for axis in 0..3 {
            let start_points = (0..at_start).map(|i| (i, start));
            let end_points = (0..at_end).map(|i| (n - 1 - i, end));
            for (j, waypoint) in start_points.chain(end_points) {
                let coordinate = Affine::constant(-waypoint.position_m[axis]);
                self.constraints.push(Constraint::Zero(coordinate.plus_variable(axis * n + j, 1.0)));
            }
        }
        for waypoint in [start, end] {
            self.velocity(waypoint);
        }
    }

    /// The derivative of an order at a time.
    fn derivative_at(&self, order: usize, t_s: f64) -> [Affine; 3] {
        let n = self.basis.control_points();
        let (first, weights) = self.basis.derivative_at(order, t_s);
        std::array::from_fn(|axis| Affine {
            terms: weights.iter().enumerate().map(|(i, weight)| (axis * n + first + i, *weight)).collect(),
            constant: 0.0,
        })
    }

    /// The velocity of a waypoint, where it has one.
    fn velocity(&mut self, waypoint: &Waypoint) {
        let Some(velocity_m_s) = waypoint.velocity_m_s else { return };
        let flown = self.derivative_at(1, waypoint.time_s).into_iter().zip(velocity_m_s.iter());
        self.constraints.extend(flown.map(|(flown, asked)| Constraint::Zero(flown.plus(-asked))));
    }

    pub(super) fn waypoints(&mut self) {
        let relaxed = self.slacks.iter().any(|(limit, _)| *limit == Limit::Waypoints);
        for waypoint in self.plan.inner_waypoints() {
            let flown = self.derivative_at(0, waypoint.time_s).into_iter().zip(waypoint.position_m.iter());
            let miss = flown.map(|(flown, asked)| flown.plus(-asked));
            if waypoint.tolerance_m == 0.0 && !relaxed {
                self.constraints.extend(miss.map(Constraint::Zero));
            } else {
                let miss = miss.collect();
                let tolerance = self.relaxed(Limit::Waypoints, Affine::constant(waypoint.tolerance_m));
                self.constraints.push(Constraint::Cone(tolerance, miss));
            }
            self.velocity(waypoint);
        }
    }

    pub(super) fn speed(&mut self) {
        let Some(bound) = self.plan.bounds.speed_max_m_s else { return };
        let weights = self.basis.derivative_weights(1);
        for j in 0..weights.len() {
            let head = self.relaxed(Limit::Speed, Affine::constant(bound));
            self.constraints.push(Constraint::Cone(head, self.vector(&weights, j)));
        }
    }

    pub(super) fn acceleration(&mut self) {
        let weights = self.basis.derivative_weights(2);
        let bounds = self.plan.bounds;
        for j in 0..weights.len() {
            let acceleration = self.vector(&weights, j);
            let lift = acceleration[2].clone().plus(GRAVITY_M_S2);
            if let Some(bound) = bounds.acceleration_max_m_s2 {
                let head = self.relaxed(Limit::Acceleration, Affine::constant(bound));
                self.constraints.push(Constraint::Cone(head, acceleration.clone()));
            }
            if let Some(tilt_rad) = bounds.tilt_max_rad {
                let head = self.relaxed(Limit::Tilt, lift.clone().scaled(tilt_rad.tan()));
                self.constraints.push(Constraint::Cone(head, acceleration[..2].to_vec()));
            }
            if let Some(bound) = bounds.thrust_max_m_s2 {
                let head = self.relaxed(Limit::ThrustMax, Affine::constant(bound));
                let thrust = vec![acceleration[0].clone(), acceleration[1].clone(), lift.clone()];
                self.constraints.push(Constraint::Cone(head, thrust));
            }
            if let Some(bound) = bounds.thrust_min_m_s2 {
                self.constraints.push(Constraint::NonNegative(self.relaxed(Limit::ThrustMin, lift.plus(-bound))));
            }
        }
    }

    pub(super) fn body_rate(&mut self) {
        let Some(bound) = self.plan.bounds.body_rate_max_rad_s else { return };
        let acceleration = self.basis.derivative_weights(2);
        let jerk = self.basis.derivative_weights(3);
        let degree = self.plan.degree();
        for span in 0..self.plan.spans() {
            let zeta = 3 * self.basis.control_points() + span;
            self.constraints.push(Constraint::NonNegative(Affine::default().plus_variable(zeta, 1.0)));
            for j in span..=span + degree - 2 {
                let lift = self.point(&acceleration, j, 2).plus(GRAVITY_M_S2);
                self.constraints.push(Constraint::NonNegative(lift.plus_variable(zeta, -1.0)));
            }
            for j in span..=span + degree - 3 {
                let head = self.relaxed(Limit::BodyRate, Affine::default().plus_variable(zeta, bound));
                self.constraints.push(Constraint::Cone(head, self.vector(&jerk, j)));
            }
        }
    }

    pub(super) fn corridors(&mut self) {
        let n = self.basis.control_points();
        for (index, corridor) in self.plan.corridors.iter().enumerate() {
            for j in self.plan.points_of(corridor) {
                for axis in 0..3 {
                    let above = Affine::constant(-corridor.min_m[axis]).plus_variable(axis * n + j, 1.0);
                    let below = Affine::constant(corridor.max_m[axis]).plus_variable(axis * n + j, -1.0);
                    for bound in [above, below] {
                        let bound = self.relaxed(Limit::Corridor(index), bound);
                        self.constraints.push(Constraint::NonNegative(bound));
                    }
                }
            }
        }
    }
}
