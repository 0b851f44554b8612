//! Random numbers of one run: the campaign's seed, the run and a name in; a stream of its own out.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};
use rand_distr::{Distribution as _, StandardNormal};

/// The numbers of one name in one run: ChaCha with eight rounds, whose key is the seed, whose nonce is the run, and whose
/// counter begins at a place that the name gives. A figure that is added leaves the others unchanged.
pub struct Draws(ChaCha8Rng);

impl Draws {
    /// From the beginning.
    pub fn new(seed: u64, run: u64, name: &str) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(run);
        // 2^32 words for each name: no draw comes near them.
        generator.set_word_pos(u128::from(place(name)) << 32);
        Self(generator)
    }

    /// From 0 up to, but not including, 1: 53 bits.
    pub fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Mean 0, deviation 1.
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// A whole number of 53 bits, which every reader of tables keeps.
    pub fn seed(&mut self) -> u64 {
        self.0.next_u64() >> 11
    }
}

/// FNV-1a of 32 bits (draft-eastlake-fnv).
pub(crate) fn place(name: &str) -> u32 {
    name.bytes().fold(0x811C_9DC5, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_hashed_as_published() {
        // Test vectors of the draft.
        assert_eq!((place(""), place("a"), place("foobar")), (0x811C_9DC5, 0xE40C_292C, 0xBF9C_F968));
    }

    #[test]
    fn seed_run_and_name_each_have_numbers_of_their_own() {
        let first = |seed, run, name| Draws::new(seed, run, name).uniform();
        let one = first(1, 7, "errors.lag_ms");
        assert_eq!(one, first(1, 7, "errors.lag_ms"));
        for other in [first(2, 7, "errors.lag_ms"), first(1, 8, "errors.lag_ms"), first(1, 7, "errors.delay_ms")] {
            assert_ne!(one, other);
        }
    }

    #[test]
    fn numbers_have_their_moments() {
        let count = 40_000_u32;
        let mean = |of: &dyn Fn(u64) -> f64| (0..u64::from(count)).map(of).sum::<f64>() / f64::from(count);
        // Four deviations of a mean of 40,000: 4 sqrt(1/12/n), 4/sqrt(n), 4 sqrt(2/n).
        let uniform = mean(&|run| Draws::new(3, run, "x").uniform());
        assert!((uniform - 0.5).abs() < 0.0058, "{uniform}");
        let normal = mean(&|run| Draws::new(3, run, "y").normal());
        assert!(normal.abs() < 0.02, "{normal}");
        let variance = mean(&|run| Draws::new(3, run, "y").normal().powi(2));
        assert!((variance - 1.0).abs() < 0.029, "{variance}");
        // Runs beside each other are not correlated: deviation of the product's mean 1/sqrt(n).
        let beside = mean(&|run| Draws::new(3, run, "y").normal() * Draws::new(3, run + 1, "y").normal());
        assert!(beside.abs() < 0.02, "{beside}");
    }
}
