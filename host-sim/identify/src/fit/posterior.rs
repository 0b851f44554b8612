//! The choice between two posteriors, and draws of the chosen one.
//!
//! Filters that know how a craft moves take out of a log all that is in it, as long as the craft moves as they think. A real one does
//! more: its torques are explained to 0.9. There the balances below the corner, which leave out faster motions, are
//! believed.

use nalgebra::DVector;

use super::balanced;
use super::bootstrap::{Block, DRAWS, Dice, effective_count};
use super::layout::{DAMPING, SHARED};
use super::prior::{Base, Prior};
use super::problem::Prepared;
use super::refine::{Refined, Start, refine};
use crate::filter::mean;

/// Of the torques' variance below the corner, mean of both axes: less, and the filters are not believed. The flights of NanoBench have 0.915,
/// simulated crafts in gusts 0.945 and more.
pub(super) const EXPLAINED_LEAST: f64 = 0.935;
/// Parameters that the balances have.
const BALANCED: usize = DAMPING[1] + 1;

/// A posterior: its summit, and draws.
pub(super) struct Posterior {
    /// As the layout has them, then the logarithm of each flight's thrust per mass.
    pub(super) values: DVector<f64>,
    pub(super) draws: Vec<DVector<f64>>,
    /// Of each block its flight.
    pub(super) blocks: Vec<usize>,
    way: Way,
}

enum Way {
    Balances { refined: balanced::Refined, filler: DVector<f64> },
    Filters(Refined),
}

impl Posterior {
    /// By the balances.
    pub(super) fn balanced(
        sections: &[Prepared],
        base: &Base,
        start: balanced::Start,
        fixed: &[usize],
        filler: &DVector<f64>,
    ) -> Self {
        let refined = balanced::refine(sections, base, start);
        let blocks: Vec<usize> = refined.blocks.iter().map(|block| block.flight).collect();
        let wide = |values: &DVector<f64>| -> DVector<f64> {
            let count = values.len();
            let all =
                values.iter().take(BALANCED).chain(filler.iter().skip(BALANCED)).chain(values.iter().skip(BALANCED));
            DVector::from_iterator(SHARED + count - BALANCED, all.copied())
        };
        let mut dice = Dice::new();
        let draws = (0..DRAWS)
            .map(|_| {
                let weights = dice.weights(&blocks);
                wide(&refined.drawn(fixed, &mut dice, &weights))
            })
            .collect();
        let values = wide(&refined.values);
        Self { values, draws, blocks, way: Way::Balances { refined, filler: filler.clone() } }
    }

    /// By filters, from values that the balances found.
    pub(super) fn filtered(
        sections: &[Prepared],
        base: &Base,
        flights: usize,
        found: &DVector<f64>,
        priors: Vec<Prior>,
        fixed: &[usize],
    ) -> Option<Self> {
        let mut values = found.rows(0, SHARED).into_owned();
        for j in DAMPING {
            values[j] = priors[j].centre;
        }
        let refined = refine(sections, base, flights, Start { values, priors, fixed: fixed.to_vec() })?;
        Some(Self::of(refined, fixed))
    }

    fn of(refined: Refined, fixed: &[usize]) -> Self {
        let blocks: Vec<usize> = refined.blocks.iter().map(|block| block.flight).collect();
        let mut dice = Dice::new();
        let draws = (0..DRAWS)
            .map(|_| {
                let weights = dice.weights(&blocks);
                refined.drawn(fixed, &mut dice, &weights)
            })
            .collect();
        Self { values: refined.values.clone(), draws, blocks, way: Way::Filters(refined) }
    }

    fn priors_and_blocks(&self) -> (&[Prior], &[Block]) {
        match &self.way {
            Way::Balances { refined, .. } => (&refined.priors, &refined.blocks),
            Way::Filters(refined) => (&refined.priors, &refined.blocks),
        }
    }

    /// Deviation of a parameter by what the flights say of it, without what was believed before.
    pub(super) fn by_data(&self, j: usize) -> f64 {
        let (priors, _) = self.priors_and_blocks();
        let all: Vec<f64> = self.draws.iter().map(|draw| draw[j]).collect();
        let middle = mean(&all);
        let variance = mean(&all.iter().map(|value| (value - middle).powi(2)).collect::<Vec<_>>());
        let precision = 1.0 / variance.max(1e-300) - priors[j].precision(self.values[j]);
        if precision > 0.0 { precision.sqrt().recip() } else { f64::INFINITY }
    }

    /// Effective number of blocks that tell of a parameter.
    pub(super) fn effective_blocks(&self, j: usize) -> f64 {
        effective_count(self.priors_and_blocks().1, j)
    }

    /// The same way once more with other parameters kept.
    pub(super) fn again(&self, sections: &[Prepared], base: &Base, fixed: &[usize]) -> Option<Self> {
        let flights = self.values.len() - SHARED;
        match &self.way {
            Way::Balances { refined, filler } => {
                let start = balanced::Start {
                    values: refined.values.clone(),
                    priors: refined.priors.clone(),
                    fixed: fixed.to_vec(),
                };
                Some(Self::balanced(sections, base, start, fixed, filler))
            }
            Way::Filters(refined) => {
                let values = refined.values.rows(0, SHARED).into_owned();
                let start = Start { values, priors: refined.priors.clone(), fixed: fixed.to_vec() };
                refine(sections, base, flights, start).map(|refined| Self::of(refined, fixed))
            }
        }
    }
}
