//! Linear regressions by themselves, with their blocks for intervals: drag (1/s) from the accelerometer, and others of
//! the same form.

use nalgebra::{DMatrix, DVector};

use super::BLOCK_S;
use super::bootstrap::{Block, Dice};
use super::problem::Prepared;
use crate::flight::RATE_HZ;

/// A regression whose columns have had their means taken off, section by section.
pub(super) struct Regression {
    pub(super) values: DVector<f64>,
    pub(super) blocks: Vec<Block>,
    /// Share of the left side's variance that is explained.
    pub(super) explained: f64,
}

impl Regression {
    /// Least squares of `columns(section)`, the last of which is the left side.
    pub(super) fn of(sections: &[Prepared], count: usize, columns: impl Fn(&Prepared) -> Vec<Vec<f64>>) -> Self {
        let all: Vec<Vec<Vec<f64>>> = sections.iter().map(&columns).collect();
        let scale: Vec<f64> = (0..count)
            .map(|j| {
                let sum: f64 = all.iter().flat_map(|section| section[j].iter()).map(|v| v * v).sum();
                let rows: usize = all.iter().map(|section| section[j].len()).sum();
                (sum / rows.max(1) as f64).sqrt().max(1e-300)
            })
            .collect();
        let row = |section: &[Vec<f64>], i: usize| DVector::from_fn(count, |j, _| section[j][i] / scale[j]);
        let (mut matrix, mut right, mut whole) = (DMatrix::zeros(count, count), DVector::zeros(count), 0.0);
        for section in &all {
            for i in 0..section[count].len() {
                let (row, left) = (row(section, i), section[count][i]);
                matrix.ger(1.0, &row, &row, 1.0);
                right.axpy(left, &row, 1.0);
                whole += left * left;
            }
        }
        for j in 0..count {
            matrix[(j, j)] += 1e-9 * matrix[(j, j)].max(1e-12);
        }
        let solution = matrix.clone().cholesky().map_or_else(|| DVector::zeros(count), |factor| factor.solve(&right));
        let mut blocks = Vec::new();
        let span = (BLOCK_S * RATE_HZ) as usize;
        for (one, section) in sections.iter().zip(&all) {
            let rows = section[count].len();
            let mut from = 0;
            while from < rows {
                let to = if from + 2 * span > rows { rows } else { from + span };
                let mut block =
                    Block { flight: one.flight, matrix: DMatrix::zeros(count, count), score: DVector::zeros(count) };
                for i in from..to {
                    let row = row(section, i);
                    let rest = section[count][i] - row.dot(&solution);
                    block.matrix.ger(1.0, &row, &row, 1.0);
                    block.score.axpy(rest, &row, 1.0);
                }
                blocks.push(block);
                from = to;
            }
        }
        // In the columns' own measure.
        for block in &mut blocks {
            for j in 0..count {
                block.score[j] *= scale[j];
                for l in 0..count {
                    block.matrix[(j, l)] *= scale[j] * scale[l];
                }
            }
        }
        let explained = right.dot(&solution) / whole.max(1e-300);
        Self { values: DVector::from_fn(count, |j, _| solution[j] / scale[j]), blocks, explained }
    }

    /// Once more, of blocks that are drawn.
    pub(super) fn drawn(&self, weights: &[f64]) -> DVector<f64> {
        let count = self.values.len();
        let (mut matrix, mut slope) = (DMatrix::zeros(count, count), DVector::zeros(count));
        for (block, weight) in self.blocks.iter().zip(weights) {
            matrix += &block.matrix * *weight;
            slope += &block.score * *weight;
        }
        let scale: Vec<f64> = (0..count).map(|j| matrix[(j, j)].sqrt().max(1e-300)).collect();
        let scaled = DMatrix::from_fn(count, count, |j, l| matrix[(j, l)] / (scale[j] * scale[l]));
        let right = DVector::from_fn(count, |j, _| slope[j] / scale[j]);
        let moved = scaled.cholesky().map_or_else(|| DVector::zeros(count), |factor| factor.solve(&right));
        DVector::from_fn(count, |j, _| self.values[j] + moved[j] / scale[j])
    }

    /// All draws.
    pub(super) fn draws(&self) -> Vec<DVector<f64>> {
        let flights: Vec<usize> = self.blocks.iter().map(|block| block.flight).collect();
        let mut dice = Dice::new();
        (0..super::bootstrap::DRAWS).map(|_| self.drawn(&dice.weights(&flights))).collect()
    }
}

/// Along body x or y: `a = -D v + l w'`, the second since the accelerometer is not in the centre of mass.
pub(super) fn drag(sections: &[Prepared], axis: usize) -> Regression {
    Regression::of(sections, 2, |one| {
        let velocity = one.centred(&one.velocity[axis]).into_iter().map(|v| -v).collect();
        vec![velocity, one.centred(&one.angular[1 - axis]), one.centred(&one.force[axis])]
    })
}
