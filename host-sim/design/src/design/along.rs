//! Gains over time: the linear quadratic feedback along a trajectory, for a control rate.
//!
//! In flow a reference by time, weights and a sampling; out flows a table of gains 4 x 9 at evenly spaced knots, to be
//! interpolated linearly. The error is that of the equilibrium law in the reference's heading frame,
//! `e = [dr q1 q2 q3 dv]` with `dr`, `dv` turned by minus the heading and `(q1 q2 q3)` the vector part of `q_r^-1 q`; with
//! the reference's input fed forward it moves, to first order, as
//!
//! ```text
//! dr' = -psi' z x dr + dv
//! q'  = -omega_r x q + d omega / 2
//! dv' = -psi' z x dv + R_h (2 T_r q x z + z dT)        R_h: the reference's attitude seen from its heading frame
//! ```
//!
//! At hover this is (E-LTI). Over each control period the pair at its middle is held and discretised exactly, in the digits
//! of an f64: there are thousands of periods, and the gain is not solved for but run towards. The Riccati recursion
//! then runs backwards from the end, where the stationary solution for the last pair is used for the rest:
//! trajectories end at rest.

use nalgebra::{DMatrix, Matrix3, Rotation3, SMatrix, Vector3};

use super::DesignError;
use super::discretise::Held;
use super::sampled::{CostForm, SampledCost, Sampling, motion_and_cost, optimal, shaped};
use super::synthesis::{EquilibriumWeights, diagonal};
use crate::model::attitude;
use crate::model::flat::{ReferencePoint, unit};

/// A table of gains over time.
#[derive(Debug, Clone, PartialEq)]
pub struct GainsAlong {
    /// Time between two knots, s; the first one is at 0.
    pub spacing_s: f64,
    /// Control periods between two knots.
    pub steps_per_knot: usize,
    /// The control period, s.
    pub period_s: f64,
    /// K at the knots, 4 x 9, columns `[x y z q1 q2 q3 vx vy vz]`, rows `[T p q r]`.
    pub gains: Vec<SMatrix<f64, 4, 9>>,
    /// P before each control step, `x' P x` being the cost still to come; the last one is that of the hover behind them.
    pub p: Vec<SMatrix<f64, 9, 9>>,
    /// Largest distance of the interpolated gain from the gain at any control step, over the norm of that gain.
    pub interpolation_error: f64,
}

/// Steps of the grid that gains are put on from 0 to their largest entry, as a power of two: in f32 each is exact.
const GRID_BITS: i32 = 19;

impl GainsAlong {
    /// The gains on an absolute grid, some 250,000 steps from 0 to the largest entry behind the last knot: a recursion over
    /// thousands of periods ends with other last digits on another processor, and the same gains on the grid.
    #[must_use]
    pub fn on_grid(mut self) -> Self {
        let step = self.grid_step();
        for gain in &mut self.gains {
            gain.apply(|entry| *entry = (*entry / step).round() * step);
        }
        self
    }

    /// Step of that grid, a power of two.
    pub fn grid_step(&self) -> f64 {
        let largest = self.gains.last().map_or(0.0, SMatrix::amax);
        // A largest entry that is a power of two but for its last digits is on one side of it.
        f64::from((largest * (1.0 + 1e-6)).log2().ceil() as i32 - GRID_BITS).exp2()
    }

    /// The gain at a time, linear between the knots and held beyond them.
    pub fn at(&self, time_s: f64) -> SMatrix<f64, 4, 9> {
        let last = self.gains.len().saturating_sub(1);
        let position = (time_s / self.spacing_s).max(0.0).min(last as f64);
        let knot = (position as usize).min(last.saturating_sub(1));
        match (self.gains.get(knot), self.gains.get(knot + 1)) {
            (Some(before), Some(after)) => before + (after - before) * (position - knot as f64),
            (Some(only), None) => *only,
            _ => SMatrix::zeros(),
        }
    }
}

/// The error dynamics about a reference point: A 9 x 9 and B 9 x 4, errors `[dr q dv]`, inputs `[T p q r]`.
pub fn error_dynamics(point: &ReferencePoint) -> (DMatrix<f64>, DMatrix<f64>) {
    let thrust_m_s2 = point.input[0];
    let rates = Vector3::new(point.input[1], point.input[2], point.input[3]);
    let to_heading = Rotation3::from_axis_angle(&Vector3::z_axis(), -point.heading_rad);
    let attitude = (to_heading * unit(&attitude(&point.state)).to_rotation_matrix()).into_inner();
    let turning = -Vector3::new(0.0, 0.0, point.heading_rate_rad_s).cross_matrix();
    // 2 q x z: how the thrust axis tilts with the error of the attitude, in body axes.
    let tilting = -Vector3::z().cross_matrix() * 2.0;
    let mut a = DMatrix::zeros(9, 9);
    a.view_mut((0, 0), (3, 3)).copy_from(&turning);
    a.view_mut((0, 6), (3, 3)).copy_from(&Matrix3::identity());
    a.view_mut((3, 3), (3, 3)).copy_from(&-rates.cross_matrix());
    a.view_mut((6, 3), (3, 3)).copy_from(&(attitude * tilting * thrust_m_s2));
    a.view_mut((6, 6), (3, 3)).copy_from(&turning);
    let mut b = DMatrix::zeros(9, 4);
    b.view_mut((3, 1), (3, 3)).copy_from(&(Matrix3::identity() * 0.5));
    b.view_mut((6, 0), (3, 1)).copy_from(&attitude.column(2));
    (a, b)
}

/// The table of gains along a reference of `duration_s`, with a knot every `steps_per_knot` control periods (at least 1).
///
/// # Errors
/// The errors of [`super::sampled::sampled_lqr`] about weights and sampling, and [`DesignError::Delay`] for a sampling with
/// a delay: the table has no place for past commands.
pub fn gains_along(
    reference: impl Fn(f64) -> ReferencePoint,
    duration_s: f64,
    weights: &EquilibriumWeights,
    sampling: &Sampling,
    steps_per_knot: usize,
) -> Result<GainsAlong, DesignError> {
    let h = sampling.period_s;
    super::discretise::require_period(h)?;
    super::discretise::require_period(duration_s)?;
    if sampling.delay_samples > 0 {
        return Err(DesignError::Delay { delay_s: sampling.delay_samples as f64 * h });
    }
    let (q, r) = (diagonal(&weights.state), diagonal(&weights.input));
    let steps_per_knot = steps_per_knot.max(1);
    // Whole knots, so that the last one is not before the end.
    let steps = ((duration_s / h).ceil() as usize).div_ceil(steps_per_knot) * steps_per_knot;
    let discretised = |time_s: f64| {
        let (a, b) = error_dynamics(&reference(time_s.min(duration_s)));
        let (held, cost) = held_with_cost(&a, &b, &q, &r, h);
        match sampling.cost {
            CostForm::Integral => (held, cost),
            CostForm::Sum => (held, SampledCost { q: q.clone(), s: DMatrix::zeros(9, 4), r: r.clone() }),
        }
    };
    let (held, cost) = discretised(duration_s);
    let end = optimal(&held, &cost, 0)?;
    let mut p = end.p;
    let mut backwards = vec![fixed(&end.gain)];
    let mut costs = vec![shaped(&p).unwrap_or_else(SMatrix::zeros)];
    for step in (0..steps).rev() {
        let (held, cost) = discretised((step as f64 + 0.5) * h);
        let pb = &p * &held.b;
        let middle = &cost.r + held.b.transpose() * &pb;
        let driven = pb.transpose() * &held.a + cost.s.transpose();
        let inverse = middle.cholesky().ok_or(DesignError::NotPositiveDefinite { row: 0, pivot: 0.0 })?;
        let gain = inverse.solve(&driven);
        // The cost of the closed loop as a sum of squares: P stays positive under any rounding (Joseph's form).
        let closed = &held.a - &held.b * &gain;
        let crossed = &cost.s * &gain;
        let stage = &cost.q - &crossed - crossed.transpose() + gain.transpose() * &cost.r * &gain;
        let next = closed.transpose() * &p * &closed + stage;
        p = (&next + next.transpose()) * 0.5;
        backwards.push(fixed(&gain));
        costs.push(shaped(&p).unwrap_or_else(SMatrix::zeros));
    }
    backwards.reverse();
    costs.reverse();
    let gains = backwards.iter().copied().step_by(steps_per_knot).collect();
    let mut table = GainsAlong {
        spacing_s: h * steps_per_knot as f64,
        steps_per_knot,
        period_s: h,
        gains,
        p: costs,
        interpolation_error: 0.0,
    };
    table.interpolation_error = backwards
        .iter()
        .enumerate()
        .map(|(step, gain)| (table.at(step as f64 * h) - gain).norm() / gain.norm())
        .fold(0.0, f64::max);
    Ok(table)
}

/// The pair under held inputs and its cost between two samples, as [`super::discretise::zero_order_hold`] and
/// [`super::sampled::sampled_cost`] have them, from one exponential.
fn held_with_cost(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    q: &DMatrix<f64>,
    r: &DMatrix<f64>,
    period_s: f64,
) -> (Held, SampledCost) {
    let (n, m) = b.shape();
    let size = n + m;
    let whole = (motion_and_cost(a, b, q, r) * period_s).exp();
    let moved = whole.view((size, size), (size, size));
    let cost = moved.transpose() * whole.view((0, size), (size, size));
    let cost = (&cost + cost.transpose()) * 0.5;
    let block =
        |row: usize, column: usize, rows: usize, columns: usize| cost.view((row, column), (rows, columns)).into_owned();
    (
        Held { a: moved.view((0, 0), (n, n)).into_owned(), b: moved.view((0, n), (n, m)).into_owned(), period_s },
        SampledCost { q: block(0, 0, n, n), s: block(0, n, n, m), r: block(n, n, m, m) },
    )
}

/// A gain of the recursion, which is 4 x 9 by construction.
fn fixed(gain: &DMatrix<f64>) -> SMatrix<f64, 4, 9> {
    shaped(gain).unwrap_or_else(SMatrix::zeros)
}
