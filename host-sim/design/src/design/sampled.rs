//! Gains for a control rate: a continuous pair, its weights and a sampling in; the optimal held feedback out.
//!
//! The plant is discretised exactly ([`super::discretise`]). The cost is by default the cost of the continuous weights,
//! integrated between the samples too, `int_0^h x' Q x + u' R u dt` with u held, which is
//! `x' Q_d x + 2 x' S_d u + u' R_d u` with the blocks of one exponential (Van Loan 1978); so the gain tends to the
//! continuous one as the rate grows.
//!
//! **Delay.** Where the command acts d samples late, the best feedback is the one without delay applied to the state
//! d samples ahead, which the last d commands decide: `u = -K (A^d x + A^(d-1) B u(-d) + ... + B u(-1))`. This is the
//! solution of the Riccati equation with the past commands as states, without its d m poles at 0.

use nalgebra::{DMatrix, SMatrix};
use num_complex::Complex64;

use super::discretise::{Held, precise_exponential, require_fitting, require_period, zero_order_hold};
use super::double_double::DoubleMatrix;
use super::synthesis::{ERROR_STATES, EquilibriumWeights, FlatWeights, dense_flat_chain, diagonal, without_noise};
use super::{DesignError, dlqr_with_cross, require_symmetric};
use crate::model::linear::linearise;
use crate::model::{hover_input, hover_state};

/// The meaning of weights at a rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CostForm {
    /// Weights of an integral over time: the cost between the samples counts.
    #[default]
    Integral,
    /// Weights of a sum over the samples, used as they are.
    Sum,
}

/// When commands are computed and when they act.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// Period of the control loop, s.
    pub period_s: f64,
    /// Whole samples by which a command acts late.
    pub delay_samples: usize,
    /// The meaning of the weights.
    pub cost: CostForm,
}

impl Sampling {
    /// Commands at a rate in Hz that act at once, weights of an integral.
    pub fn at_rate(rate_hz: u32) -> Self {
        Self { period_s: 1.0 / f64::from(rate_hz), delay_samples: 0, cost: CostForm::Integral }
    }
}

/// `sum x' Q x + 2 x' S u + u' R u` over the samples.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledCost {
    /// Q, n x n.
    pub q: DMatrix<f64>,
    /// S, n x m.
    pub s: DMatrix<f64>,
    /// R, m x m.
    pub r: DMatrix<f64>,
}

/// A feedback for a control rate.
#[derive(Debug, Clone)]
pub struct SampledDesign {
    /// K, m x n, for `u = -K x - sum_i K_i u(-i)`.
    pub gain: DMatrix<f64>,
    /// `K_1 ... K_d`, m x m each: of the last command, the one before, and so on. Empty without delay.
    pub past_command_gains: Vec<DMatrix<f64>>,
    /// P of the Riccati equation without delay, n x n.
    pub p: DMatrix<f64>,
    /// Poles per sample; the delay adds as many at 0 as there are past commands.
    pub poles: Vec<Complex64>,
    /// Relative residual of P, evaluated in 32 digits.
    pub relative_residual: f64,
    /// Last Newton correction over P.
    pub last_correction: f64,
}

/// The hover model in the order of the E error: `(A, B)`, 9 x 9 and 9 x 4, without q0, which no input moves.
///
/// States `[x y z q1 q2 q3 vx vy vz]`, inputs `[T p q r]`.
pub fn equilibrium_pair() -> (DMatrix<f64>, DMatrix<f64>) {
    let (a, b) = linearise(&hover_state(), &hover_input());
    (
        DMatrix::from_fn(9, 9, |i, j| a[(ERROR_STATES[i], ERROR_STATES[j])]),
        DMatrix::from_fn(9, 4, |i, j| b[(ERROR_STATES[i], j)]),
    )
}

/// The cost of a held input between two samples, for weights of an integral.
///
/// # Errors
/// [`DesignError::Matrix`] for matrices that do not fit or are not finite; [`DesignError::NotSymmetric`];
/// [`DesignError::Period`].
pub fn sampled_cost(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    q: &DMatrix<f64>,
    r: &DMatrix<f64>,
    period_s: f64,
) -> Result<SampledCost, DesignError> {
    require_fitting(a, b)?;
    require_period(period_s)?;
    let (n, m) = b.shape();
    let q = require_symmetric("Q", q, n)?;
    let r = require_symmetric("R", r, m)?;
    let size = n + m;
    let whole = precise_exponential(&motion_and_cost(a, b, &q, &r), period_s)?;
    let block = |row: usize| DoubleMatrix {
        hi: whole.hi.view((row, size), (size, size)).into_owned(),
        lo: whole.lo.view((row, size), (size, size)).into_owned(),
    };
    let cost = block(size).transposed().times(&block(0)).symmetrised().hi;
    Ok(SampledCost {
        q: cost.view((0, 0), (n, n)).into_owned(),
        s: cost.view((0, n), (n, m)).into_owned(),
        r: cost.view((n, n), (m, m)).into_owned(),
    })
}

/// `[-M' W; 0 M]` with M the motion of `[x u]` under a held input and W its weights. Its exponential over a period is
/// `[. G; 0 E]`, where `E' G` is the cost of `[x u]` over the period (Van Loan 1978).
pub(super) fn motion_and_cost(a: &DMatrix<f64>, b: &DMatrix<f64>, q: &DMatrix<f64>, r: &DMatrix<f64>) -> DMatrix<f64> {
    let (n, m) = b.shape();
    let size = n + m;
    let mut motion = DMatrix::zeros(size, size);
    motion.view_mut((0, 0), (n, n)).copy_from(a);
    motion.view_mut((0, n), (n, m)).copy_from(b);
    let mut doubled = DMatrix::zeros(2 * size, 2 * size);
    doubled.view_mut((0, 0), (size, size)).copy_from(&-motion.transpose());
    doubled.view_mut((size, size), (size, size)).copy_from(&motion);
    doubled.view_mut((0, size), (n, n)).copy_from(q);
    doubled.view_mut((n, size + n), (m, m)).copy_from(r);
    doubled
}

/// The optimal held feedback for a continuous pair and weights Q >= 0, R > 0.
///
/// # Errors
/// The errors of [`zero_order_hold`], [`sampled_cost`] and [`dlqr_with_cross`].
pub fn sampled_lqr(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    q: &DMatrix<f64>,
    r: &DMatrix<f64>,
    sampling: &Sampling,
) -> Result<SampledDesign, DesignError> {
    let held = zero_order_hold(a, b, sampling.period_s)?;
    let cost = match sampling.cost {
        CostForm::Integral => sampled_cost(a, b, q, r, sampling.period_s)?,
        CostForm::Sum => SampledCost { q: q.clone(), s: DMatrix::zeros(b.nrows(), b.ncols()), r: r.clone() },
    };
    optimal(&held, &cost, sampling.delay_samples)
}

/// The optimal feedback of a sampled plant whose commands act `delay_samples` late.
pub(super) fn optimal(held: &Held, cost: &SampledCost, delay_samples: usize) -> Result<SampledDesign, DesignError> {
    let solution = dlqr_with_cross(&held.a, &held.b, &cost.q, &cost.r, &cost.s)?;
    let mut ahead = solution.gain.clone();
    let mut past_command_gains = Vec::with_capacity(delay_samples);
    for _ in 0..delay_samples {
        past_command_gains.push(without_noise(&(&ahead * &held.b)));
        ahead *= &held.a;
    }
    Ok(SampledDesign {
        gain: without_noise(&ahead),
        past_command_gains,
        p: solution.p,
        poles: solution.poles,
        relative_residual: solution.relative_residual,
        last_correction: solution.last_correction,
    })
}

/// (LQR-E) for a control rate: gain 4 x 9, columns `[x y z q1 q2 q3 vx vy vz]`, rows `[T p q r]`.
///
/// # Errors
/// As [`sampled_lqr`].
pub fn sampled_equilibrium(weights: &EquilibriumWeights, sampling: &Sampling) -> Result<SampledDesign, DesignError> {
    let (a, b) = equilibrium_pair();
    sampled_lqr(&a, &b, &diagonal(&weights.state), &diagonal(&weights.input), sampling)
}

/// (LQR-F) for a control rate: gain 7 x 10, columns `[r v a q3]`, rows `[a j q3']`.
///
/// # Errors
/// As [`sampled_lqr`].
pub fn sampled_flat(weights: &FlatWeights, sampling: &Sampling) -> Result<SampledDesign, DesignError> {
    let (a, b) = dense_flat_chain();
    sampled_lqr(&a, &b, &diagonal(&weights.state), &diagonal(&weights.input), sampling)
}

/// A dense gain of known shape as a matrix of that shape; nothing if the shape is another.
pub fn shaped<const M: usize, const N: usize>(gain: &DMatrix<f64>) -> Option<SMatrix<f64, M, N>> {
    (gain.shape() == (M, N)).then(|| SMatrix::from_iterator(gain.iter().copied()))
}
