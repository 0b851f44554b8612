//! A design's equations, solved: a validated problem in; the gain with its model, its weights, P and the poles, out.

use nalgebra::{DMatrix, SMatrix};
use quatrack_design::design::actuator_aware::{
    ERRORS, PLANT_STATES, actuator_aware, hover_pair, hover_pair_with_integral,
};
use quatrack_design::design::along::gains_along;
use quatrack_design::design::cascade::cascade;
use quatrack_design::design::integral::{sampled_integral_problem, sampled_lqi};
use quatrack_design::design::sampled::{
    SampledCost, SampledDesign, Sampling, sampled_equilibrium, sampled_flat, shaped,
};
use quatrack_design::design::synthesis::{
    EquilibriumDesign, FlatDesign, diagonal, lqr_equilibrium, lqr_flat, lyapunov_equilibrium, lyapunov_flat,
};
use quatrack_design::model::flat::reference_point;
use quatrack_plan::trajectory::Trajectory as _;

use super::{Designed, Poles};
use crate::gains::GainsError;
use crate::gains::design::{Design, Method, Problem};
use crate::gains::kinds::Gains;
use crate::gains::model::{LinearModel, SampledProblem, Weights, of_equilibrium, of_flat};
use crate::gains::names::{MOTOR_INPUTS, MOTOR_STATES, PART_INPUTS, PART_STATES};

impl Designed {
    pub(super) fn solved(design: &Design) -> Result<Self, GainsError> {
        let rate_hz = design.rate.hz();
        match &design.problem {
            Problem::Equilibrium(Method::Lyapunov { mu_1_s }) => {
                Ok(Self::equilibrium(lyapunov_equilibrium(*mu_1_s)?, None))
            }
            Problem::Equilibrium(Method::Lqr { weights }) => {
                Ok(Self::equilibrium(lqr_equilibrium(weights)?, Some(of_equilibrium(weights))))
            }
            Problem::Equilibrium(Method::SampledLqr { weights, delay_samples }) => {
                let sampling = sampling(rate_hz, *delay_samples);
                let designed = sampled_equilibrium(weights, &sampling)?;
                let gains = Gains::Equilibrium(Box::new(of_shape(&designed.gain)));
                let (model, weights) = (LinearModel::equilibrium(), of_equilibrium(weights));
                let problem = SampledProblem::new(&model, &weights, sampling.period_s)?;
                Ok(Self::sampled(designed, model, gains, weights, problem))
            }
            Problem::Integral { weights } => {
                let sampling = sampling(rate_hz, 0);
                let designed = sampled_lqi(weights, &sampling)?;
                let gains = Gains::Integral(Box::new(of_shape(&designed.gain)));
                let (held, cost) = sampled_integral_problem(weights, &sampling)?;
                let state: Vec<f64> = weights.equilibrium.state.iter().chain(&weights.integral).copied().collect();
                let weights = Weights { q: diagonal(&state), r: diagonal(&weights.equilibrium.input) };
                Ok(Self::sampled(designed, LinearModel::integral(), gains, weights, SampledProblem { held, cost }))
            }
            Problem::ActuatorAware { motor_lag_s, weights, .. } => {
                let period_s = Sampling::at_rate(rate_hz).period_s;
                let designed = actuator_aware(&design.vehicle, *motor_lag_s, weights, period_s)?;
                let (a, b) = hover_pair_with_integral(&design.vehicle, *motor_lag_s);
                let (q, r) = (diagonal(&weights.state()), diagonal(&[weights.command; 4]));
                let cost = SampledCost { q: q.clone(), s: DMatrix::zeros(ERRORS, 4), r: r.clone() };
                Ok(Self {
                    model: LinearModel { a, b, states: &MOTOR_STATES, inputs: &MOTOR_INPUTS },
                    weights: Some(Weights { q, r }),
                    gains: Gains::ActuatorAware(Box::new(of_shape(&designed.gain))),
                    past_command_gains: Vec::new(),
                    p: designed.p,
                    poles: Poles::Sampled(designed.poles),
                    relative_residual: designed.relative_residual,
                    gain_in_parts: Some(designed.gain_in_parts),
                    motors: Some((design.vehicle.clone(), *motor_lag_s)),
                    sampled: Some(SampledProblem { held: designed.held, cost }),
                })
            }
            Problem::Cascade { motor_lag_s, weights, .. } => {
                let period_s = Sampling::at_rate(rate_hz).period_s;
                let designed = cascade(&design.vehicle, *motor_lag_s, weights, period_s)?;
                let (a, b) = hover_pair(&design.vehicle, *motor_lag_s, 1.0, 1.0);
                let (q, r) = (diagonal(&weights.state()), diagonal(&[weights.command; 4]));
                let cost = SampledCost { q: q.clone(), s: DMatrix::zeros(PLANT_STATES, 4), r: r.clone() };
                Ok(Self {
                    model: LinearModel { a, b, states: &PART_STATES, inputs: &PART_INPUTS },
                    weights: Some(Weights { q, r }),
                    gains: Gains::Cascade(Box::new(designed.numbers())),
                    past_command_gains: Vec::new(),
                    p: designed.p,
                    poles: Poles::Sampled(designed.poles),
                    relative_residual: designed.relative_residual,
                    gain_in_parts: Some(designed.gain_in_parts),
                    motors: None,
                    sampled: Some(SampledProblem { held: designed.held, cost }),
                })
            }
            Problem::Along { weights, trajectory, steps_per_knot } => {
                let sampling = sampling(rate_hz, 0);
                let flown = trajectory.trajectory();
                let reference = |time_s: f64| reference_point(&flown.at(time_s));
                let steps_per_knot = usize::from(*steps_per_knot);
                let along = gains_along(reference, flown.duration_s(), weights, &sampling, steps_per_knot)?.on_grid();
                // Model, P and poles are those of the hover behind the last knot.
                let hover = sampled_equilibrium(weights, &sampling)?;
                let (model, weights) = (LinearModel::equilibrium(), of_equilibrium(weights));
                let problem = SampledProblem::new(&model, &weights, sampling.period_s)?;
                Ok(Self::sampled(hover, model, Gains::Along(Box::new(along)), weights, problem))
            }
            Problem::FlatOutput(Method::Lyapunov { mu_1_s }) => Ok(Self::flat(lyapunov_flat(*mu_1_s)?, None)),
            Problem::FlatOutput(Method::Lqr { weights }) => Ok(Self::flat(lqr_flat(weights)?, Some(of_flat(weights)))),
            Problem::FlatOutput(Method::SampledLqr { weights, delay_samples }) => {
                let sampling = sampling(rate_hz, *delay_samples);
                let designed = sampled_flat(weights, &sampling)?;
                let gains = Gains::FlatOutput(Box::new(of_shape(&designed.gain)));
                let (model, weights) = (LinearModel::flat_chain(), of_flat(weights));
                let problem = SampledProblem::new(&model, &weights, sampling.period_s)?;
                Ok(Self::sampled(designed, model, gains, weights, problem))
            }
        }
    }

    fn equilibrium(design: EquilibriumDesign, weights: Option<Weights>) -> Self {
        Self {
            model: LinearModel::equilibrium(),
            weights,
            gains: Gains::Equilibrium(Box::new(design.gain)),
            past_command_gains: Vec::new(),
            p: DMatrix::from_column_slice(9, 9, design.p.as_slice()),
            poles: Poles::Continuous(design.poles),
            relative_residual: design.relative_residual,
            gain_in_parts: None,
            motors: None,
            sampled: None,
        }
    }

    fn flat(design: FlatDesign, weights: Option<Weights>) -> Self {
        Self {
            model: LinearModel::flat_chain(),
            weights,
            gains: Gains::FlatOutput(Box::new(design.gain)),
            past_command_gains: Vec::new(),
            p: DMatrix::from_column_slice(10, 10, design.p.as_slice()),
            poles: Poles::Continuous(design.poles),
            relative_residual: design.relative_residual,
            gain_in_parts: None,
            motors: None,
            sampled: None,
        }
    }

    fn sampled(
        design: SampledDesign,
        model: LinearModel,
        gains: Gains,
        weights: Weights,
        problem: SampledProblem,
    ) -> Self {
        Self {
            model,
            weights: Some(weights),
            gains,
            past_command_gains: design.past_command_gains,
            p: design.p,
            poles: Poles::Sampled(design.poles),
            relative_residual: design.relative_residual,
            gain_in_parts: None,
            motors: None,
            sampled: Some(problem),
        }
    }
}

fn sampling(rate_hz: u32, delay_samples: usize) -> Sampling {
    Sampling { delay_samples, ..Sampling::at_rate(rate_hz) }
}

/// A gain of the shape that its solver gives.
fn of_shape<const M: usize, const N: usize>(gain: &DMatrix<f64>) -> SMatrix<f64, M, N> {
    shaped(gain).unwrap_or_else(SMatrix::zeros)
}
