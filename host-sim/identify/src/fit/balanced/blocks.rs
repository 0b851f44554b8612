//! Normal equations of the balances, by kind and by block of time, of which intervals are made.

use nalgebra::{DMatrix, DVector};

use super::balances::{KINDS, Problem, Residuals, STRIDE};
use crate::filter::mean;
use crate::fit::BLOCK_S;
use crate::fit::bootstrap::Block;
use crate::fit::layout::VOLTAGE_POWER;
use crate::fit::problem::Driven;
use crate::flight::RATE_HZ;

type Normal = (DMatrix<f64>, DVector<f64>);

/// Normal equations in units of the parameters, of all, and by kind and block.
pub(super) fn total(
    problem: &Problem<'_>,
    values: &DVector<f64>,
    driven: &[Driven],
    residuals: &Residuals,
    units: &[f64],
    fixed: &[usize],
    weights: &[f64; KINDS],
) -> (Normal, [Vec<Block>; KINDS]) {
    let count = values.len();
    let changed: Vec<Option<Residuals>> = (0..count)
        .map(|j| {
            if fixed.contains(&j) {
                return None;
            }
            let mut there = values.clone();
            there[j] += 0.02 * units[j];
            let redriven = (j <= VOLTAGE_POWER).then(|| problem.driven(&there));
            Some(problem.residuals(&there, redriven.as_deref().unwrap_or(driven)))
        })
        .collect();
    let (mut matrix, mut slope) = (DMatrix::zeros(count, count), DVector::zeros(count));
    let mut by_kind: [Vec<Block>; KINDS] = std::array::from_fn(|_| Vec::new());
    let span = ((BLOCK_S * RATE_HZ) as usize / STRIDE).max(1);
    for (s, one) in problem.sections.iter().enumerate() {
        for k in 0..KINDS {
            let rows = &residuals.rows[s][k];
            let active: Vec<usize> =
                (0..count).filter(|j| changed[*j].as_ref().is_some_and(|there| there.rows[s][k] != *rows)).collect();
            let mut from = 0;
            while from < rows.len() {
                // The last block takes a rest that is too short for one of its own.
                let to = if from + 2 * span > rows.len() { rows.len() } else { from + span };
                let mut own =
                    Block { flight: one.flight, matrix: DMatrix::zeros(count, count), score: DVector::zeros(count) };
                let mut line = vec![0.0; active.len()];
                for (i, row) in rows.iter().enumerate().take(to).skip(from) {
                    for (line, j) in line.iter_mut().zip(&active) {
                        *line = changed[*j].as_ref().map_or(0.0, |there| (there.rows[s][k][i] - row) / 0.02);
                    }
                    for (a, j) in active.iter().enumerate() {
                        own.score[*j] -= weights[k] * line[a] * row;
                        for (b, l) in active.iter().enumerate().take(a + 1) {
                            own.matrix[(*j, *l)] += weights[k] * line[a] * line[b];
                        }
                    }
                }
                own.matrix.fill_upper_triangle_with_lower_triangle();
                matrix += &own.matrix;
                slope += &own.score;
                by_kind[k].push(own);
                from = to;
            }
        }
    }
    ((matrix, slope), by_kind)
}

/// How much more the blocks' slopes vary than they would if every point were news.
pub(super) fn remembered(blocks: &[Block]) -> f64 {
    let count = blocks.first().map_or(0, |block| block.score.len());
    let mut ratios = Vec::new();
    for j in 0..count {
        let matrix: f64 = blocks.iter().map(|block| block.matrix[(j, j)]).sum();
        let mean = blocks.iter().map(|block| block.score[j]).sum::<f64>() / blocks.len().max(1) as f64;
        let varies: f64 = blocks.iter().map(|block| (block.score[j] - mean).powi(2)).sum();
        if matrix > 0.0 {
            ratios.push(varies / matrix);
        }
    }
    mean(&ratios).max(1.5)
}

/// Blocks of all kinds in one, each weighed by how many points remember each other.
pub(super) fn merged(by_kind: [Vec<Block>; KINDS], memory: &[f64; KINDS]) -> Vec<Block> {
    let mut merged: Vec<Block> = Vec::new();
    for (k, blocks) in by_kind.into_iter().enumerate() {
        for (b, mut block) in blocks.into_iter().enumerate() {
            block.matrix /= memory[k];
            block.score /= memory[k];
            match merged.get_mut(b) {
                Some(sum) if k > 0 => {
                    sum.matrix += &block.matrix;
                    sum.score += &block.score;
                }
                _ => merged.push(block),
            }
        }
    }
    merged
}
