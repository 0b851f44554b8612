//! E with the integral of the position error: weights in, gains 4 x 12 out, continuous and for a control rate.
//!
//! Columns `[x y z q1 q2 q3 vx vy vz ix iy iz]`, rows `[T p q r]`, `u = u_e - K [e; i]`. In continuous time `i' = r`.
//! At a control rate the integral is the sum the controller forms, `i+ = i + h r`, with the command computed from the
//! sum *before* the present error is added; the sum is constant between samples, so its share of an integral cost is
//! `h i' Q_i i` exactly.

use nalgebra::DMatrix;
use num_complex::Complex64;
use serde::Serialize;

use super::discretise::{Held, zero_order_hold};
use super::sampled::{CostForm, SampledCost, SampledDesign, Sampling, equilibrium_pair, optimal, sampled_cost};
use super::synthesis::{EquilibriumWeights, diagonal, without_noise};
use super::{DesignError, lqr};
use crate::analysis::eigenvalues;

/// Names of the error in the order of the columns of the gain, with their units.
pub const INTEGRAL_ERROR_NAMES: [&str; 12] = [
    "x_m",
    "y_m",
    "z_m",
    "q1",
    "q2",
    "q3",
    "vx_m_s",
    "vy_m_s",
    "vz_m_s",
    "ix_metre_seconds",
    "iy_metre_seconds",
    "iz_metre_seconds",
];

/// Diagonal weights of the LQI designs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct IntegralWeights {
    /// Weights of the error and the input.
    pub equilibrium: EquilibriumWeights,
    /// Weights of the integrals `[ix iy iz]`.
    pub integral: [f64; 3],
}

/// A continuous LQI gain.
#[derive(Debug, Clone)]
pub struct IntegralDesign {
    /// K, 4 x 12.
    pub gain: DMatrix<f64>,
    /// P, 12 x 12.
    pub p: DMatrix<f64>,
    /// Eigenvalues of the closed loop, 1/s.
    pub poles: Vec<Complex64>,
    /// Relative residual of P.
    pub relative_residual: f64,
}

/// The hover model in the order of the E error with `i' = r`: 12 x 12 and 12 x 4.
pub fn integral_pair() -> (DMatrix<f64>, DMatrix<f64>) {
    let (a, b) = equilibrium_pair();
    extended(&a, &b, 0.0, 1.0)
}

/// The continuous LQI feedback.
///
/// # Errors
/// The errors of [`lqr`] about the weights.
pub fn lqi(weights: &IntegralWeights) -> Result<IntegralDesign, DesignError> {
    let (a, b) = integral_pair();
    let state: Vec<f64> = weights.equilibrium.state.iter().chain(&weights.integral).copied().collect();
    let solution = lqr(&a, &b, &diagonal(&state), &diagonal(&weights.equilibrium.input))?;
    let gain = without_noise(&solution.gain);
    Ok(IntegralDesign {
        poles: eigenvalues(&(&a - &b * &gain))?,
        gain,
        p: solution.p,
        relative_residual: solution.relative_residual,
    })
}

/// The LQI feedback for a control rate.
///
/// # Errors
/// As [`super::sampled::sampled_lqr`].
pub fn sampled_lqi(weights: &IntegralWeights, sampling: &Sampling) -> Result<SampledDesign, DesignError> {
    let (held, cost) = sampled_integral_problem(weights, sampling)?;
    optimal(&held, &cost, sampling.delay_samples)
}

/// The pair per sample, with the sums as states, and the cost that [`sampled_lqi`] makes least.
///
/// # Errors
/// The errors of [`zero_order_hold`] and [`sampled_cost`].
pub fn sampled_integral_problem(
    weights: &IntegralWeights,
    sampling: &Sampling,
) -> Result<(Held, SampledCost), DesignError> {
    let (a, b) = equilibrium_pair();
    let (q, r) = (diagonal(&weights.equilibrium.state), diagonal(&weights.equilibrium.input));
    let h = sampling.period_s;
    let held = zero_order_hold(&a, &b, h)?;
    let (cost, share) = match sampling.cost {
        CostForm::Integral => (sampled_cost(&a, &b, &q, &r, h)?, h),
        CostForm::Sum => (SampledCost { q, s: DMatrix::zeros(9, 4), r }, 1.0),
    };
    let mut whole = DMatrix::zeros(12, 12);
    whole.view_mut((0, 0), (9, 9)).copy_from(&cost.q);
    for (i, weight) in weights.integral.iter().enumerate() {
        whole[(9 + i, 9 + i)] = share * weight;
    }
    let (a, b) = extended(&held.a, &held.b, 1.0, h);
    Ok((Held { a, b, period_s: h }, SampledCost { q: whole, s: cost.s.resize_vertically(12, 0.0), r: cost.r }))
}

/// The pair with three more states: `kept` of themselves and `fed` of the position each.
fn extended(a: &DMatrix<f64>, b: &DMatrix<f64>, kept: f64, fed: f64) -> (DMatrix<f64>, DMatrix<f64>) {
    let mut whole = a.clone().resize(12, 12, 0.0);
    for i in 0..3 {
        whole[(9 + i, i)] = fed;
        whole[(9 + i, 9 + i)] = kept;
    }
    (whole, b.clone().resize_vertically(12, 0.0))
}
