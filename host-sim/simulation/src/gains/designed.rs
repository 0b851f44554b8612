//! A design, solved: a validated problem in; the model, the gain in f64 and the plant it is certified on out.

mod solved;

use nalgebra::{DMatrix, SMatrix};
use num_complex::Complex64;
use quatrack_design::certify::cascade::certify_cascade;
use quatrack_design::certify::{Certificate, CertifyError, Controller, Plant, Timing, certify, certify_along};
use quatrack_design::design::sampled::Sampling;
use quatrack_design::model::flat::reference_point;
use quatrack_design::vehicle::Vehicle;
use quatrack_plan::trajectory::Trajectory as _;

use super::GainsError;
use super::design::{Design, Problem};
use super::kinds::Gains;
use super::model::{LinearModel, SampledProblem, Weights};
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

/// Poles, and in which time.
#[derive(Debug, Clone, PartialEq)]
pub enum Poles {
    /// 1/s.
    Continuous(Vec<Complex64>),
    /// Per sample.
    Sampled(Vec<Complex64>),
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

    /// Certifies the gains as rounded to f32, on the model that the design was made for.
    ///
    /// # Errors
    /// As [`certify`] and [`certify_along`].
    pub fn certify(&self, design: &Design) -> Result<Certificate, CertifyError> {
        match (&self.gains, &design.problem) {
            (Gains::Cascade(gains), Problem::Cascade { motor_lag_s, air, .. }) => {
                let period_s = Timing::at_rate(design.rate.hz()).period_s;
                certify_cascade(&design.vehicle, **gains, *motor_lag_s, air, period_s)
            }
            (Gains::Along(along), Problem::Along { trajectory, .. }) => {
                let reference = |time_s: f64| reference_point(&trajectory.trajectory().at(time_s));
                certify_along(reference, along, design.rate_loop_gain_1_s)
            }
            _ => {
                let (plant, controller, timing) = self.hover_loop(design);
                certify(&plant, &controller, &timing, design.rate_loop_gain_1_s)
            }
        }
    }

    /// The loop at hover of every design but the cascade's; of gains over time with that behind the last knot.
    pub(super) fn hover_loop(&self, design: &Design) -> (Plant, Controller, Timing) {
        let timing = Timing::at_rate(design.rate.hz());
        if let (Some(gain), Some((vehicle, lag_s))) = (&self.gain_in_parts, &self.motors) {
            let plant = Plant::hover_with_motors(vehicle, *lag_s, 1.0, 1.0);
            return (plant, Controller::actuator_aware(gain, *lag_s, timing.period_s), timing);
        }
        let (plant, gain) = match &self.gains {
            Gains::FlatOutput(_) => (Plant::flat_chain(), self.gains.dense()),
            Gains::Integral(_) => (Plant::equilibrium_with_integral(), self.gains.dense()),
            Gains::Along(along) => {
                let last = along.gains.last().map_or_else(SMatrix::zeros, |gain| *gain);
                (Plant::equilibrium(), DMatrix::from_column_slice(4, 9, last.as_slice()))
            }
            Gains::Equilibrium(_) | Gains::ActuatorAware(_) | Gains::Cascade(_) => {
                (Plant::equilibrium(), self.gains.dense())
            }
        };
        let past_command_gains = self.past_command_gains.clone();
        let timing = Timing { delay_samples: past_command_gains.len(), ..timing };
        (plant, Controller { gain, past_command_gains, predictor: None }, timing)
    }
}
