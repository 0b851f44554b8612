//! Matrices and random problems of the tests of the Riccati solvers.

use nalgebra::DMatrix;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

pub(crate) fn matrix(rows: usize, columns: usize, entries: &[f64]) -> DMatrix<f64> {
    DMatrix::from_row_slice(rows, columns, entries)
}

pub(crate) fn identity(n: usize) -> DMatrix<f64> {
    DMatrix::identity(n, n)
}

/// The norm of the difference over the norm of what is right.
pub(crate) fn relative_error(got: &DMatrix<f64>, want: &DMatrix<f64>) -> f64 {
    (got - want).norm() / want.norm()
}

/// Random pair with entries of order 1, weights of full rank.
pub(crate) fn random_problem() -> impl Strategy<Value = (DMatrix<f64>, DMatrix<f64>, DMatrix<f64>, DMatrix<f64>)> {
    (1_usize..8, 1_usize..4).prop_flat_map(|(n, m)| {
        let entries = |count| prop::collection::vec(-2.0..2.0_f64, count);
        (entries(n * n), entries(n * m), entries(n * n), entries(m * m)).prop_map(move |(a, b, c, d)| {
            let (c, d) = (DMatrix::from_vec(n, n, c), DMatrix::from_vec(m, m, d));
            let q = c.transpose() * &c + identity(n) * 1e-3;
            let r = d.transpose() * &d + identity(m) * 1e-3;
            let symmetric = |m: DMatrix<f64>| (&m + m.transpose()) * 0.5;
            (DMatrix::from_vec(n, n, a), DMatrix::from_vec(n, m, b), symmetric(q), symmetric(r))
        })
    })
}

/// The same cases on every run.
pub(crate) fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(20), failure_persistence: None, ..ProptestConfig::default() }
}
