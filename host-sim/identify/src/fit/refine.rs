//! Maximum a posteriori: figures and noise together, by the innovations of Kalman filters, from where regressions begin.
//!
//! Disturbances, moving air and noise of the commands are process noise, whose power and memory are parameters. So a controller that
//! answers a disturbance does not bias the figures, as it does where a balance is fitted by least squares; nor does noise of the
//! commands inflate the inertia, as it does where the output's error is.

use nalgebra::{DMatrix, DVector};

use super::bootstrap::{Block, Dice};
use super::fisher::{DIFFERENCE, State, blocks, state, total};
use super::innovations::{Balances, KINDS};
use super::layout::{JUMP, LIFT, SHARED, deviations, units};
use super::normal_equations::Believed;
use super::prior::{Base, Prior};
use super::problem::Prepared;

const ROUNDS: usize = 40;
/// Gain of the logarithm at which it is enough: a parameter that is off by a tenth of its deviation costs 0.005.
const ENOUGH: f64 = 0.03;

/// The estimate with the innovations that intervals are made of.
pub(super) struct Refined {
    /// The shared ones, then the logarithm of each flight's thrust per mass.
    pub(super) values: DVector<f64>,
    pub(super) priors: Vec<Prior>,
    pub(super) units: Vec<f64>,
    /// In units of the shared parameters.
    pub(super) blocks: Vec<Block>,
    /// By how much each flight's thrust goes with the shared parameters, a unit each.
    full_slopes: DMatrix<f64>,
}

/// Start values of the parameters and their priors.
pub(super) struct Start {
    pub(super) values: DVector<f64>,
    pub(super) priors: Vec<Prior>,
    /// Parameters that keep their values.
    pub(super) fixed: Vec<usize>,
}

/// From a start to where the posterior is highest.
pub(super) fn refine(sections: &[Prepared], base: &Base, flights: usize, start: Start) -> Option<Refined> {
    let balances = Balances::new(sections, base, flights);
    let Start { mut values, priors, fixed } = start;
    let units = units(base);
    let mut now = state(&balances, &values)?;
    let cost = |values: &DVector<f64>, state: &State, weights: &[f64; KINDS]| -> f64 {
        state.kinds.iter().zip(weights).map(|(kind, weight)| weight * kind.cost()).sum::<f64>()
            + priors.iter().zip(values.iter()).map(|(prior, value)| prior.cost(*value)).sum::<f64>()
    };
    let mut weights = [1.0; KINDS];
    let mut least = cost(&values, &now, &weights);
    let mut damping = 1e-3;
    let mut weighed = false;
    for _ in 0..ROUNDS {
        let (blocks, _) = blocks(&balances, &values, &now, &units, &fixed, &weights);
        let (mut matrix, slope) = total(&blocks);
        // A variance exp(2 x) bends the cost over x by twice its slope, which Fisher's matrix lacks.
        for j in deviations() {
            matrix[(j, j)] += 2.0 * units[j] * (-slope[j]).max(0.0);
        }
        let mut better = None;
        while damping < 1e6 {
            let believed = Believed { values: &values, priors: &priors, units: &units, fixed: &fixed };
            let step = believed.step(&matrix, &slope, damping);
            let trial = &values + step;
            let there = state(&balances, &trial);
            let there = there.map(|there| (cost(&trial, &there, &weights), there)).filter(|(cost, _)| *cost < least);
            if let Some((cost, there)) = there {
                better = Some((trial, cost, there));
                damping = (damping * 0.2).max(1e-6);
                break;
            }
            damping *= 5.0;
        }
        let gained = better.as_ref().map_or(0.0, |(_, cost, _)| least - cost);
        if let Some((trial, cost, there)) = better {
            (values, least, now) = (trial, cost, there);
        }
        if gained < ENOUGH {
            if weighed {
                break;
            }
            // Innovations should be independent from point to point; as far as they are not, they count for less.
            let (_, memory) = self::blocks(&balances, &values, &now, &units, &fixed, &[1.0; KINDS]);
            weights = memory.map(|memory| 1.0 / memory);
            least = cost(&values, &now, &weights);
            (weighed, damping) = (true, 1e-3);
        }
    }
    let (blocks, _) = blocks(&balances, &values, &now, &units, &fixed, &weights);
    let mut full_slopes = DMatrix::zeros(flights, SHARED);
    for j in (0..=LIFT).chain([JUMP]) {
        let mut there = values.clone();
        there[j] += DIFFERENCE * units[j];
        for (flight, full) in balances.full(&there, &balances.thrusts(&there)).into_iter().enumerate() {
            full_slopes[(flight, j)] = (full - now.full[flight]) / DIFFERENCE;
        }
    }
    let values = DVector::from_iterator(SHARED + flights, values.iter().copied().chain(now.full.iter().copied()));
    Some(Refined { values, priors, units, blocks, full_slopes })
}

impl Refined {
    /// Estimates again, from blocks that are drawn and priors whose centres are: one a draw.
    pub(super) fn drawn(&self, fixed: &[usize], dice: &mut Dice, weights: &[f64]) -> DVector<f64> {
        let believed = Believed { values: &self.values, priors: &self.priors, units: &self.units, fixed };
        let moved = believed.drawn(&self.blocks, weights, dice);
        let full = &self.full_slopes * &moved;
        DVector::from_fn(self.values.len(), |j, _| {
            self.values[j] + if j < SHARED { moved[j] * self.units[j] } else { full[j - SHARED] }
        })
    }
}
