//! Normal equations with priors: a step towards the most probable figures, and estimates anew of drawn blocks.

use nalgebra::{DMatrix, DVector};

use super::bootstrap::{Block, Dice};
use super::prior::Prior;

/// Stands in for certainty on the diagonal, in units of a parameter: one that is fixed does not move.
const FIXED: f64 = 1e12;
/// No further than that many units at once: neither balances nor innovations are linear in lag and delay.
const LONGEST: f64 = 10.0;

/// Parameters at their present values, and their priors.
pub(super) struct Believed<'a> {
    pub(super) values: &'a DVector<f64>,
    pub(super) priors: &'a [Prior],
    pub(super) units: &'a [f64],
    /// Parameters that keep their values.
    pub(super) fixed: &'a [usize],
}

impl Believed<'_> {
    /// Marquardt's step in the parameters' own measure, from a matrix and a slope in their units; Gauss's without damping.
    pub(super) fn step(&self, matrix: &DMatrix<f64>, slope: &DVector<f64>, damping: f64) -> DVector<f64> {
        let (mut matrix, mut slope) = (matrix.clone(), slope.clone());
        for j in 0..slope.len() {
            let (precision, away) = self.belief(j);
            matrix[(j, j)] = (matrix[(j, j)] + precision) * (1.0 + damping);
            slope[j] -= precision * away;
        }
        let step = self.solved(matrix, slope);
        let longest = step.amax();
        let step = if longest > LONGEST { step * (LONGEST / longest) } else { step };
        DVector::from_fn(step.len(), |j, _| step[j] * self.units[j])
    }

    /// Change of the estimate, in units, for one draw of the blocks and of the priors' centres; as many parameters as the blocks have.
    pub(super) fn drawn(&self, blocks: &[Block], weights: &[f64], dice: &mut Dice) -> DVector<f64> {
        let count = blocks.first().map_or(0, |block| block.score.len());
        let (mut matrix, mut slope) = (DMatrix::zeros(count, count), DVector::zeros(count));
        for (block, weight) in blocks.iter().zip(weights).filter(|(_, weight)| **weight > 0.0) {
            matrix += &block.matrix * *weight;
            slope += &block.score * *weight;
        }
        for j in 0..count {
            let (precision, away) = self.belief(j);
            matrix[(j, j)] += precision;
            if !self.fixed.contains(&j) {
                slope[j] += precision.sqrt() * dice.normal() - precision * away;
            }
        }
        self.solved(matrix, slope)
    }

    /// Precision of a prior, and how far the value is from its centre, in the parameter's unit.
    fn belief(&self, j: usize) -> (f64, f64) {
        let (value, prior, unit) = (self.values[j], &self.priors[j], self.units[j]);
        (prior.precision(value) * unit * unit, (value - prior.centre) / unit)
    }

    /// With fixed parameters left as they are; nothing where the matrix has no Cholesky factor.
    fn solved(&self, mut matrix: DMatrix<f64>, mut slope: DVector<f64>) -> DVector<f64> {
        for j in (0..slope.len()).filter(|j| self.fixed.contains(j)) {
            (matrix[(j, j)], slope[j]) = (FIXED, 0.0);
        }
        matrix.cholesky().map_or_else(|| DVector::zeros(slope.len()), |factor| factor.solve(&slope))
    }
}
