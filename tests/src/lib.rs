//! Shared parts of the tests that cross crates; the tests are in `tests/`.

pub mod cases;
pub mod core_step;
pub mod design_problem;

/// The README's example is compiled and run.
#[doc = include_str!("../../README.md")]
#[cfg(doctest)]
pub struct Readme;

/// So is that of the core's.
#[doc = include_str!("../../core/README.md")]
#[cfg(doctest)]
pub struct CoreReadme;

/// And the examples of the page on gain tables.
#[doc = include_str!("../../docs/gain-tables.md")]
#[cfg(doctest)]
pub struct GainTablesPage;

/// And of the page on designs of one's own.
#[doc = include_str!("../../docs/own-gains.md")]
#[cfg(doctest)]
pub struct OwnGainsPage;

/// Point `index` of the Halton sequence in `N` dimensions, each coordinate in (0, 1): random enough to cover a box
/// evenly, and the same on every machine.
pub fn halton<const N: usize>(index: u32) -> [f64; N] {
    const PRIMES: [u32; 24] =
        [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89];
    std::array::from_fn(|dimension| {
        let base = PRIMES[dimension];
        let (mut remaining, mut weight, mut value) = (index + 1, 1.0, 0.0);
        while remaining > 0 {
            weight /= f64::from(base);
            value += weight * f64::from(remaining % base);
            remaining /= base;
        }
        value
    })
}

/// The value below which a share of the sorted numbers lies.
pub fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * share) as usize]
}
