//! A plan as a cone program: a plan and the limits to relax in, objective and constraints on control points out.
//!
//! Variables, in this order: the `n` x coordinates of the control points, m, then y, then z; one `zeta`, m/s^2, for each
//! span if the body rate is bounded; one slack for each relaxed limit.

mod builder;

use super::{Limit, Plan};
use crate::trajectory::bspline::UniformBasis;
use builder::Builder;

/// A sum of variables times coefficients, and a constant.
#[derive(Clone, Debug, Default)]
pub(super) struct Affine {
    pub(super) terms: Vec<(usize, f64)>,
    pub(super) constant: f64,
}

impl Affine {
    pub(super) fn constant(constant: f64) -> Self {
        Self { terms: Vec::new(), constant }
    }

    pub(super) fn plus(mut self, constant: f64) -> Self {
        self.constant += constant;
        self
    }

    pub(super) fn plus_variable(mut self, variable: usize, coefficient: f64) -> Self {
        self.terms.push((variable, coefficient));
        self
    }

    pub(super) fn scaled(mut self, factor: f64) -> Self {
        self.constant *= factor;
        for (_, coefficient) in &mut self.terms {
            *coefficient *= factor;
        }
        self
    }
}

/// A constraint on the variable vector.
pub(super) enum Constraint {
    /// Zero.
    Zero(Affine),
    /// Zero or more.
    NonNegative(Affine),
    /// The length of the second is the first at the most.
    Cone(Affine, Vec<Affine>),
}

/// A cone program: minimise `1/2 x' P x + q' x` subject to constraints.
pub(super) struct Program {
    /// All variables.
    pub(super) variables: usize,
    /// Upper triangle of `P`, as (row, column, value); the same for each axis is repeated here.
    pub(super) quadratic: Vec<(usize, usize, f64)>,
    /// `q`.
    pub(super) linear: Vec<f64>,
    /// The constraints.
    pub(super) constraints: Vec<Constraint>,
}

impl Program {
    /// The program of the plan. With `relaxed` empty the objective is the plan's own; else every bound of those limits
    /// has a slack added, and the weighted sum of the slacks is all that is minimised.
    pub(super) fn new(plan: &Plan, relaxed: &[(Limit, f64)]) -> Self {
        let basis = plan.basis;
        let control_points = basis.control_points();
        let zetas = if plan.bounds.body_rate_max_rad_s.is_some() { plan.spans() } else { 0 };
        let first_slack = 3 * control_points + zetas;
        let variables = first_slack + relaxed.len();
        let slacks = relaxed.iter().zip(first_slack..).map(|((limit, _), variable)| (*limit, variable)).collect();
        let mut builder = Builder { plan, basis, slacks, constraints: Vec::new() };
        builder.ends();
        builder.waypoints();
        builder.speed();
        builder.acceleration();
        builder.body_rate();
        builder.corridors();

        let mut linear = vec![0.0; variables];
        let mut quadratic = Vec::new();
        if relaxed.is_empty() {
            linear[3 * control_points..].fill(-plan.body_rate_slack_reward);
            quadratic = snap(plan, &basis);
        } else {
            for (value, (_, weight)) in linear[first_slack..].iter_mut().zip(relaxed) {
                *value = *weight;
            }
        }
        Self { variables, quadratic, linear, constraints: builder.constraints }
    }
}

/// `P` of `sum_k |sigma''''(k T)|^2`: twice the Gram matrix of the sampled snap, for each axis.
fn snap(plan: &Plan, basis: &UniformBasis) -> Vec<(usize, usize, f64)> {
    let n = basis.control_points();
    let width = plan.degree() + 1;
    let mut band = vec![0.0; n * width];
    let samples = (plan.duration_s() / plan.snap_sample_period_s * (1.0 + 1e-12)).floor() as usize;
    let rows = basis.derivative_weights(4);
    for k in 0..=samples {
        let t_s = (k as f64 * plan.snap_sample_period_s).min(plan.duration_s());
        let (first, weights) = basis.derivative_by(&rows, 4, t_s);
        for (i, a) in weights.iter().enumerate() {
            for (j, b) in weights.iter().enumerate().skip(i) {
                band[(first + i) * width + j - i] += 2.0 * a * b;
            }
        }
    }
    let entries = band.iter().enumerate().filter(|(_, value)| **value != 0.0);
    let one: Vec<_> = entries.map(|(at, value)| (at / width, at / width + at % width, *value)).collect();
    (0..3).flat_map(|axis| one.iter().map(move |(i, j, value)| (axis * n + i, axis * n + j, *value))).collect()
}
