//! Maximum a posteriori below the corner: thrust by command and voltage, the torque balance, lag and delay together, from a start near by.
//! For flights whose noise is not that of the filters' model, as on a real craft: see [`super::refine`].
//!
//! The residual of the balances is process noise: its power, and its correlation time, are estimated from the flights
//! themselves, and weigh the data against the priors. The balance of torques is taken relative to the torque that is
//! commanded, since a long lag would make both small.

mod balances;
mod blocks;
mod start;

use std::collections::BTreeSet;

use nalgebra::DVector;

use super::bootstrap::{Block, Dice};
use super::normal_equations::Believed;
use super::prior::{Base, Prior};
use super::problem::Prepared;
use balances::{KINDS, Problem, Residuals, SHARED, variances};
use blocks::{merged, remembered, total};
pub(super) use start::{Start, start};

/// By how much less the balances weigh than their noise alone would let them: a power of command and voltage is not all that a
/// battery and a motor do.
const MISTRUST: [f64; KINDS] = [1.0, 1.0, 2.0];

/// The estimate with the residuals that intervals are made of.
pub(super) struct Refined {
    pub(super) values: DVector<f64>,
    pub(super) priors: Vec<Prior>,
    pub(super) units: Vec<f64>,
    /// In units of the parameters.
    pub(super) blocks: Vec<Block>,
}

/// Steps of a difference, and units of the parameters.
fn units(base: &Base, flights: usize) -> Vec<f64> {
    let damping = 0.1 * base.damping_scale();
    let mut units = vec![0.1, 0.1, 1e-3, 0.05, 0.05, 0.1, 0.02];
    units.extend([0.05, 3e-3 * base.half_arm_m.max(0.01), damping, 0.05, 3e-3 * base.half_arm_m.max(0.01), damping]);
    units.extend(std::iter::repeat_n(0.01, flights));
    units
}

/// From a start to where the posterior is highest.
pub(super) fn refine(sections: &[Prepared], base: &Base, start: Start) -> Refined {
    let problem = Problem::new(sections, base);
    let Start { mut values, priors, fixed } = start;
    let units = units(base, values.len() - SHARED);
    let mut driven = problem.driven(&values);
    let mut residuals = problem.residuals(&values, &driven);
    // How many points remember each other.
    let mut memory = [5.0; KINDS];
    let mut blocks = Vec::new();
    for round in 0..4 {
        for _ in 0..if round == 0 { 12 } else { 6 } {
            let variance = variances(&residuals);
            let weights: [f64; KINDS] = std::array::from_fn(|k| 1.0 / (variance[k] * memory[k]));
            let (matrix, slope) = total(&problem, &values, &driven, &residuals, &units, &fixed, &weights).0;
            let believed = Believed { values: &values, priors: &priors, units: &units, fixed: &fixed };
            let step = believed.step(&matrix, &slope, 0.0);
            let cost = |values: &DVector<f64>, residuals: &Residuals| cost(values, residuals, &priors, &memory);
            let before = cost(&values, &residuals);
            let mut scale = 1.0;
            let mut moved = false;
            while scale > 1e-3 {
                let trial = &values + &step * scale;
                let trial_driven = problem.driven(&trial);
                let trial_residuals = problem.residuals(&trial, &trial_driven);
                if cost(&trial, &trial_residuals) < before {
                    moved = before - cost(&trial, &trial_residuals) > 1e-3;
                    (values, driven, residuals) = (trial, trial_driven, trial_residuals);
                    break;
                }
                scale *= 0.4;
            }
            if !moved {
                break;
            }
        }
        let variance = variances(&residuals);
        let weights: [f64; KINDS] = std::array::from_fn(|k| 1.0 / variance[k]);
        let (_, by_kind) = total(&problem, &values, &driven, &residuals, &units, &fixed, &weights);
        memory = std::array::from_fn(|k| MISTRUST[k] * remembered(&by_kind[k]));
        blocks = merged(by_kind, &memory);
    }
    Refined { values, priors, units, blocks }
}

/// Minus the logarithm of the posterior, at the powers of the noises that fit best.
fn cost(values: &DVector<f64>, residuals: &Residuals, priors: &[Prior], memory: &[f64; KINDS]) -> f64 {
    let variance = variances(residuals);
    let count: usize = residuals.rows.iter().map(|rows| rows[0].len()).sum();
    let data: f64 = (0..KINDS).map(|k| 0.5 * count as f64 / memory[k] * variance[k].ln()).sum();
    data + priors.iter().zip(values.iter()).map(|(prior, value)| prior.cost(*value)).sum::<f64>()
}

impl Refined {
    /// Estimates again, from blocks that are drawn and priors whose centres are: one a draw.
    pub(super) fn drawn(&self, fixed: &[usize], dice: &mut Dice, weights: &[f64]) -> DVector<f64> {
        let believed = Believed { values: &self.values, priors: &self.priors, units: &self.units, fixed };
        let mut moved = believed.drawn(&self.blocks, weights, dice);
        let count = moved.len();
        // The thrust of a flight that was not drawn goes with that of those that were.
        let flights =
            self.blocks.iter().zip(weights).filter(|(_, weight)| **weight > 0.0).map(|(block, _)| block.flight);
        let seen: BTreeSet<usize> = flights.collect();
        let middle = seen.iter().map(|flight| moved[SHARED + flight]).sum::<f64>() / seen.len().max(1) as f64;
        for flight in (0..count - SHARED).filter(|flight| !seen.contains(flight)) {
            moved[SHARED + flight] = middle;
        }
        DVector::from_fn(count, |j, _| self.values[j] + moved[j] * self.units[j])
    }
}
