//! The linear model that a gain is designed on, its weights, and the problem per sample that they make.

use nalgebra::DMatrix;
use quatrack_design::design::actuator_aware::{hover_pair, hover_pair_with_integral};
use quatrack_design::design::discretise::{Held, zero_order_hold};
use quatrack_design::design::integral::integral_pair;
use quatrack_design::design::sampled::{SampledCost, equilibrium_pair, sampled_cost};
use quatrack_design::design::synthesis::{EquilibriumWeights, FlatWeights, dense_flat_chain, diagonal};

use super::GainsError;
use super::design::{Design, Method, Problem};
use super::names::{
    EQUILIBRIUM_INPUTS, EQUILIBRIUM_STATES, FLAT_INPUTS, FLAT_STATES, INTEGRAL_STATES, MOTOR_INPUTS, MOTOR_STATES,
    PART_INPUTS, PART_STATES, Signal,
};

/// A pair under held commands and its cost.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledProblem {
    /// `x+ = A_d x + B_d u`, and the period.
    pub held: Held,
    /// The cost between the samples.
    pub cost: SampledCost,
}

/// `x' = A x + B u`.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearModel {
    /// A, n x n, 1/s.
    pub a: DMatrix<f64>,
    /// B, n x m.
    pub b: DMatrix<f64>,
    /// The states in order.
    pub states: &'static [Signal],
    /// The inputs in order.
    pub inputs: &'static [Signal],
}

/// Weights of the cost in continuous time.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    /// Q, n x n.
    pub q: DMatrix<f64>,
    /// R, m x m.
    pub r: DMatrix<f64>,
}

impl LinearModel {
    /// The model that a design is solved for; of gains over time the hover at their end.
    pub(super) fn with_weights(design: &Design) -> (Self, Option<Weights>) {
        match &design.problem {
            Problem::Equilibrium(Method::Lyapunov { .. }) => (Self::equilibrium(), None),
            Problem::Equilibrium(Method::Lqr { weights } | Method::SampledLqr { weights, .. })
            | Problem::Along { weights, .. } => (Self::equilibrium(), Some(of_equilibrium(weights))),
            Problem::FlatOutput(Method::Lyapunov { .. }) => (Self::flat_chain(), None),
            Problem::FlatOutput(Method::Lqr { weights } | Method::SampledLqr { weights, .. }) => {
                (Self::flat_chain(), Some(of_flat(weights)))
            }
            Problem::Integral { weights } => {
                let state: Vec<f64> = weights.equilibrium.state.iter().chain(&weights.integral).copied().collect();
                let weights = Weights { q: diagonal(&state), r: diagonal(&weights.equilibrium.input) };
                (Self::integral(), Some(weights))
            }
            Problem::ActuatorAware { motor_lag_s, weights, .. } => {
                let (a, b) = hover_pair_with_integral(&design.vehicle, *motor_lag_s);
                let weights = Weights { q: diagonal(&weights.state()), r: diagonal(&[weights.command; 4]) };
                (Self { a, b, states: &MOTOR_STATES, inputs: &MOTOR_INPUTS }, Some(weights))
            }
            Problem::Cascade { motor_lag_s, weights, .. } => {
                let (a, b) = hover_pair(&design.vehicle, *motor_lag_s, 1.0, 1.0);
                let weights = Weights { q: diagonal(&weights.state()), r: diagonal(&[weights.command; 4]) };
                (Self { a, b, states: &PART_STATES, inputs: &PART_INPUTS }, Some(weights))
            }
        }
    }

    /// Hover, without q0, which no input moves.
    pub fn equilibrium() -> Self {
        let (a, b) = equilibrium_pair();
        Self { a, b, states: &EQUILIBRIUM_STATES, inputs: &EQUILIBRIUM_INPUTS }
    }

    /// Hover with the integrals of the position error.
    pub fn integral() -> Self {
        let (a, b) = integral_pair();
        Self { a, b, states: &INTEGRAL_STATES, inputs: &EQUILIBRIUM_INPUTS }
    }

    /// The flat chain.
    pub fn flat_chain() -> Self {
        let (a, b) = dense_flat_chain();
        Self { a, b, states: &FLAT_STATES, inputs: &FLAT_INPUTS }
    }
}

impl SampledProblem {
    pub(super) fn new(model: &LinearModel, weights: &Weights, period_s: f64) -> Result<Self, GainsError> {
        Ok(Self {
            held: zero_order_hold(&model.a, &model.b, period_s)?,
            cost: sampled_cost(&model.a, &model.b, &weights.q, &weights.r, period_s)?,
        })
    }
}

pub(super) fn of_equilibrium(weights: &EquilibriumWeights) -> Weights {
    Weights { q: diagonal(&weights.state), r: diagonal(&weights.input) }
}

pub(super) fn of_flat(weights: &FlatWeights) -> Weights {
    Weights { q: diagonal(&weights.state), r: diagonal(&weights.input) }
}
