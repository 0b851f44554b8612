//! A design, solved: a validated problem in; the model, the gain in f64 and the plant it is certified on out.

use nalgebra::{DMatrix, SMatrix};
use num_complex::Complex64;
use quatrack::gains::table::{Rows, TableKind};
use quatrack_design::certify::cascade::certify_cascade;
use quatrack_design::certify::{Certificate, CertifyError, Controller, Plant, Timing, certify, certify_along};
use quatrack_design::design::actuator_aware::{
    ERRORS, PLANT_STATES, actuator_aware, hover_pair, hover_pair_with_integral,
};
use quatrack_design::design::along::{GainsAlong, gains_along};
use quatrack_design::design::cascade::{GAINS, cascade};
use quatrack_design::design::codegen::{rounded, rounded_along};
use quatrack_design::design::discretise::{Held, zero_order_hold};
use quatrack_design::design::integral::{integral_pair, sampled_integral_problem, sampled_lqi};
use quatrack_design::design::sampled::{
    SampledCost, SampledDesign, Sampling, equilibrium_pair, sampled_cost, sampled_equilibrium, sampled_flat, shaped,
};
use quatrack_design::design::synthesis::{
    EquilibriumDesign, EquilibriumWeights, FlatDesign, FlatWeights, dense_flat_chain, diagonal, lqr_equilibrium,
    lqr_flat, lyapunov_equilibrium, lyapunov_flat,
};
use quatrack_design::model::flat::reference_point;
use quatrack_design::vehicle::Vehicle;
use quatrack_plan::trajectory::Trajectory as _;

use super::GainsError;
use super::design::{Design, Method, Problem};
use super::names::{
    EQUILIBRIUM_INPUTS, EQUILIBRIUM_STATES, FLAT_INPUTS, FLAT_STATES, INTEGRAL_STATES, MOTOR_INPUTS, MOTOR_STATES,
    PART_INPUTS, PART_STATES, Signal,
};
use super::unsolved::blamed;

/// A gain with all that it came from; of gains over time model, P and poles are those of the hover at their end.
#[derive(Debug, Clone)]
pub struct Designed {
    /// The model that it was designed on.
    pub model: LinearModel,
    /// Q and R; a Lyapunov design has none.
    pub weights: Option<Weights>,
    /// The gain as designed.
    pub gains: Gains,
    /// `K_1 ... K_d` of a design that knows of a delay: of the last command, the one before, and so on.
    pub past_command_gains: Vec<DMatrix<f64>>,
    /// P, of the equation that the gain solves.
    pub p: DMatrix<f64>,
    /// Poles of the closed loop.
    pub poles: Poles,
    /// Relative residual of P.
    pub relative_residual: f64,
    /// An actuator-aware gain with forces in parts, in which it is certified.
    pub gain_in_parts: Option<DMatrix<f64>>,
    /// The object of the gain's design, where that is a vehicle with its motors and their lag, s.
    motors: Option<(Vehicle, f64)>,
    /// The problem per sample that P and the gain solve, if it is one.
    pub sampled: Option<SampledProblem>,
}

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

/// Poles, and in which time.
#[derive(Debug, Clone, PartialEq)]
pub enum Poles {
    /// 1/s.
    Continuous(Vec<Complex64>),
    /// Per sample.
    Sampled(Vec<Complex64>),
}

/// Gains by the law that flies them; each kind is one of the table format's.
#[derive(Debug, Clone, PartialEq)]
pub enum Gains {
    /// 4 x 9.
    Equilibrium(Box<SMatrix<f64, 4, 9>>),
    /// 7 x 10.
    FlatOutput(Box<SMatrix<f64, 7, 10>>),
    /// 4 x 12, with the sums of the position error.
    Integral(Box<SMatrix<f64, 4, 12>>),
    /// 4 x 19, to the motors' forces.
    ActuatorAware(Box<SMatrix<f64, 4, 19>>),
    /// 16, of the four chains.
    Cascade(Box<[f64; GAINS]>),
    /// 4 x 9 at each knot, on the grid of [`GainsAlong::on_grid`].
    Along(Box<GainsAlong>),
}

/// The entries of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum TableRows {
    /// One gain.
    Fixed(Box<Rows>),
    /// The gains of the cascade.
    Chains([f32; GAINS]),
    /// A gain at each knot.
    OverTime(Vec<[[f32; 9]; 4]>),
}

impl Gains {
    /// The kind of its table.
    pub fn kind(&self) -> TableKind {
        match self {
            Self::Equilibrium(_) => TableKind::Equilibrium,
            Self::FlatOutput(_) => TableKind::FlatOutput,
            Self::Integral(_) => TableKind::Integral,
            Self::ActuatorAware(_) => TableKind::ActuatorAware,
            Self::Cascade(_) => TableKind::Cascade,
            Self::Along(_) => TableKind::AlongTrajectory,
        }
    }

    /// As one matrix; gains over time one below the other.
    pub fn dense(&self) -> DMatrix<f64> {
        match self {
            Self::Equilibrium(gain) => DMatrix::from_column_slice(4, 9, gain.as_slice()),
            Self::FlatOutput(gain) => DMatrix::from_column_slice(7, 10, gain.as_slice()),
            Self::Integral(gain) => DMatrix::from_column_slice(4, 12, gain.as_slice()),
            Self::ActuatorAware(gain) => DMatrix::from_column_slice(4, 19, gain.as_slice()),
            Self::Cascade(gains) => DMatrix::from_row_slice(1, GAINS, &gains[..]),
            Self::Along(along) => DMatrix::from_fn(4 * along.gains.len(), 9, |i, j| along.gains[i / 4][(i % 4, j)]),
        }
    }

    /// As the core flies it, every entry the nearest f32.
    ///
    /// `motor_lag_s` is the lag for which gains for motor forces are flown.
    pub fn rows(&self, motor_lag_s: f32) -> TableRows {
        TableRows::Fixed(Box::new(match self {
            Self::Equilibrium(gain) => Rows::Equilibrium(rounded(gain)),
            Self::FlatOutput(gain) => Rows::FlatOutput(rounded(gain)),
            Self::Integral(gain) => Rows::Integral(rounded(gain)),
            Self::ActuatorAware(gain) => Rows::ActuatorAware { motor_lag_s, rows: rounded(gain) },
            Self::Cascade(gains) => return TableRows::Chains(gains.map(|gain| gain as f32)),
            Self::Along(along) => return TableRows::OverTime(rounded_along(along)),
        }))
    }

    /// The same, each row a list; of gains over time the rows of one knot after those of the other.
    pub fn by_rows(&self) -> Vec<Vec<f32>> {
        let rows = self.rows(0.0);
        let entries = match &rows {
            TableRows::Fixed(rows) => rows.entries(),
            TableRows::Chains(gains) => gains,
            TableRows::OverTime(knots) => knots.as_flattened().as_flattened(),
        };
        entries.chunks(usize::from(self.kind().dimensions().1)).map(<[f32]>::to_vec).collect()
    }
}

impl Designed {
    /// Computes the gain.
    ///
    /// # Errors
    /// [`GainsError::Unsolved`] with the states to blame where the equations have no solution, [`GainsError::Design`] where none can
    /// be told.
    pub fn of(design: &Design) -> Result<Self, GainsError> {
        Self::solved(design).map_err(|error| match error {
            GainsError::Design(error) => {
                let (model, weights) = LinearModel::with_weights(design);
                let period_s = Sampling::at_rate(design.rate.hz()).period_s;
                match blamed(&error, &model, weights.as_ref(), period_s) {
                    Some(blamed) => GainsError::Unsolved { error, blamed },
                    None => GainsError::Design(error),
                }
            }
            other => other,
        })
    }

    fn solved(design: &Design) -> Result<Self, GainsError> {
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

    /// Certifies the gains as rounded to f32, on the model that the design was made for.
    ///
    /// # Errors
    /// As [`certify`] and [`certify_along`].
    pub fn certify(&self, design: &Design) -> Result<Certificate, CertifyError> {
        if let (Some(gain), Some((vehicle, lag_s))) = (&self.gain_in_parts, &self.motors) {
            let timing = Timing::at_rate(design.rate.hz());
            let plant = Plant::hover_with_motors(vehicle, *lag_s, 1.0, 1.0);
            let controller = Controller::actuator_aware(gain, *lag_s, timing.period_s);
            return certify(&plant, &controller, &timing, design.rate_loop_gain_1_s);
        }
        if let (Gains::Cascade(gains), Problem::Cascade { motor_lag_s, air, .. }) = (&self.gains, &design.problem) {
            let period_s = Timing::at_rate(design.rate.hz()).period_s;
            return certify_cascade(&design.vehicle, **gains, *motor_lag_s, air, period_s);
        }
        let plant = match (&self.gains, &design.problem) {
            (Gains::Along(along), Problem::Along { trajectory, .. }) => {
                let reference = |time_s: f64| reference_point(&trajectory.trajectory().at(time_s));
                return certify_along(reference, along, design.rate_loop_gain_1_s);
            }
            (Gains::FlatOutput(_), _) => Plant::flat_chain(),
            (Gains::Integral(_), _) => Plant::equilibrium_with_integral(),
            (Gains::Equilibrium(_) | Gains::ActuatorAware(_) | Gains::Cascade(_) | Gains::Along(_), _) => {
                Plant::equilibrium()
            }
        };
        let past_command_gains = self.past_command_gains.clone();
        let timing = Timing { delay_samples: past_command_gains.len(), ..Timing::at_rate(design.rate.hz()) };
        let controller = Controller { gain: self.gains.dense(), past_command_gains, predictor: None };
        certify(&plant, &controller, &timing, design.rate_loop_gain_1_s)
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

impl LinearModel {
    /// The model that a design is solved for; of gains over time the hover at their end.
    fn with_weights(design: &Design) -> (Self, Option<Weights>) {
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
    fn new(model: &LinearModel, weights: &Weights, period_s: f64) -> Result<Self, GainsError> {
        Ok(Self {
            held: zero_order_hold(&model.a, &model.b, period_s)?,
            cost: sampled_cost(&model.a, &model.b, &weights.q, &weights.r, period_s)?,
        })
    }
}

fn sampling(rate_hz: u32, delay_samples: usize) -> Sampling {
    Sampling { delay_samples, ..Sampling::at_rate(rate_hz) }
}

fn of_equilibrium(weights: &EquilibriumWeights) -> Weights {
    Weights { q: diagonal(&weights.state), r: diagonal(&weights.input) }
}

fn of_flat(weights: &FlatWeights) -> Weights {
    Weights { q: diagonal(&weights.state), r: diagonal(&weights.input) }
}

/// A gain of the shape that its solver gives.
fn of_shape<const M: usize, const N: usize>(gain: &DMatrix<f64>) -> SMatrix<f64, M, N> {
    shaped(gain).unwrap_or_else(SMatrix::zeros)
}
