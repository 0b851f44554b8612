//! The block bootstrap: blocks of a flight, each with its share of a least-squares problem, in; repeated estimates, from
//! whose spread intervals are taken, out.

use nalgebra::{DMatrix, DVector};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

/// How often flights and blocks are drawn.
pub(super) const DRAWS: usize = 400;
/// From this many flights on, flights are drawn, and blocks in them: differences from flight to flight count.
const FLIGHTS_DRAWN_FROM: usize = 4;
const SEED: u64 = 0x5157_4944;

/// A block's share: of the matrix `G' G`, and of `G' r` at the estimate.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub(super) flight: usize,
    pub(super) matrix: DMatrix<f64>,
    pub(super) score: DVector<f64>,
}

/// Numbers that repeat.
pub(super) struct Dice(ChaCha8Rng);

impl Dice {
    pub(super) fn new() -> Self {
        Self(ChaCha8Rng::seed_from_u64(SEED))
    }

    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count - 1)
    }

    /// Gauss's, by the sum of twelve.
    pub(super) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }

    /// The number of times that each block is drawn.
    pub(super) fn weights(&mut self, flights: &[usize]) -> Vec<f64> {
        let mut weights = vec![0.0; flights.len()];
        let mut names: Vec<usize> = flights.to_vec();
        names.sort_unstable();
        names.dedup();
        if names.len() >= FLIGHTS_DRAWN_FROM {
            for _ in 0..names.len() {
                let drawn = names[self.below(names.len())];
                let own: Vec<usize> = (0..flights.len()).filter(|b| flights[*b] == drawn).collect();
                for _ in 0..own.len() {
                    weights[own[self.below(own.len())]] += 1.0;
                }
            }
        } else {
            for _ in 0..flights.len() {
                weights[self.below(flights.len())] += 1.0;
            }
        }
        weights
    }
}

/// Kish's effective number of blocks for a parameter, each weighed by its share of Fisher's information: drawing blocks shows no spread
/// of a parameter that one of them tells alone.
pub(super) fn effective_count(blocks: &[Block], j: usize) -> f64 {
    let all = || blocks.iter().map(|block| block.matrix[(j, j)]);
    all().sum::<f64>().powi(2) / all().map(|share| share * share).sum::<f64>().max(1e-300)
}

/// By how much intervals of few units are too narrow: Student's 97.5 % point over Gauss's, and the unit that the mean takes.
pub(super) fn few_units(flights: &[usize]) -> f64 {
    let mut names = flights.to_vec();
    names.sort_unstable();
    names.dedup();
    let units = if names.len() >= FLIGHTS_DRAWN_FROM { names.len() } else { flights.len() }.max(3) as f64;
    let freedom = units - 1.0;
    // Cornish and Fisher's expansion to the second order, good to 1 % from 3 on.
    let z = 1.96_f64;
    let student = z
        + (z.powi(3) + z) / (4.0 * freedom)
        + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * freedom * freedom);
    student / z * (units / freedom).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_count_by_how_much_they_tell() {
        let blocks = |shares: &[f64]| -> Vec<Block> {
            let of = |share: &f64| DMatrix::from_diagonal(&DVector::from_vec(vec![*share, 1.0]));
            shares.iter().map(|share| Block { flight: 0, matrix: of(share), score: DVector::zeros(2) }).collect()
        };
        // Equal ones count as they are; one among many that hardly tell is little more than one.
        assert!((effective_count(&blocks(&[2.0; 5]), 0) - 5.0).abs() < 1e-12);
        assert!((effective_count(&blocks(&[1.0, 0.01, 0.01, 0.01]), 0) - 1.06).abs() < 0.01);
    }
}
