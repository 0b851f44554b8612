//! Matrices and random problems of the tests of the Riccati solvers, and the bounds that they all must keep.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// From entries by rows.
pub fn matrix(rows: usize, columns: usize, entries: &[f64]) -> DMatrix<f64> {
    DMatrix::from_row_slice(rows, columns, entries)
}

/// The identity of `n` states.
pub fn identity(n: usize) -> DMatrix<f64> {
    DMatrix::identity(n, n)
}

/// The norm of the difference over the norm of the right value.
pub fn relative_error(got: &DMatrix<f64>, want: &DMatrix<f64>) -> f64 {
    (got - want).norm() / want.norm()
}

/// Random pair with entries of order 1, weights of full rank.
pub fn random_problem() -> impl Strategy<Value = (DMatrix<f64>, DMatrix<f64>, DMatrix<f64>, DMatrix<f64>)> {
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

/// A and B whose first mode, of an eigenvalue in `growth`, no input reaches, in any basis.
pub fn hidden_mode(growth: Range<f64>) -> impl Strategy<Value = (DMatrix<f64>, DMatrix<f64>)> {
    (2_usize..8, growth, prop::collection::vec(-1.0..1.0_f64, 200)).prop_map(|(n, growth, entries)| {
        // The first state drives the others and is driven by nothing; then a rotation.
        let a = DMatrix::from_fn(n, n, |i, j| match (i, j) {
            (0, 0) => growth,
            (0, _) => 0.0,
            _ => entries[8 * i + j],
        });
        let b = DMatrix::from_fn(n, 2, |i, j| if i == 0 { 0.0 } else { entries[64 + 2 * i + j] });
        let basis = DMatrix::from_fn(n, n, |i, j| entries[100 + 8 * i + j]).qr().q();
        (&basis * a * basis.transpose(), &basis * b)
    })
}

/// Whether a solver's P is the same in other units of the states, each by its power of two. `p` gives it for A, B and Q,
/// or nothing.
///
/// # Errors
/// [`TestCaseError`] where it is not.
pub fn scales_with_the_states(
    (a, b, q): (&DMatrix<f64>, &DMatrix<f64>, &DMatrix<f64>),
    exponents: &[i32],
    p: impl Fn(&DMatrix<f64>, &DMatrix<f64>, &DMatrix<f64>) -> Option<DMatrix<f64>>,
) -> Result<(), TestCaseError> {
    let diagonal =
        |sign: i32| DMatrix::from_diagonal(&DVector::from_fn(a.nrows(), |i, _| f64::from(sign * exponents[i]).exp2()));
    let (d, inverse) = (diagonal(1), diagonal(-1));
    let (plain, scaled) = (p(a, b, q), p(&(&inverse * a * &d), &(&inverse * b), &(&d * q * &d)));
    let (Some(plain), Some(scaled)) = (plain, scaled) else {
        return Err(TestCaseError::fail("a change of units decides whether there is a solution"));
    };
    // Both are exact to the last digit, and powers of two change none.
    let back = &inverse * scaled * &inverse;
    prop_assert!(relative_error(&back, &plain) <= 1e-15);
    Ok(())
}

/// The same cases on every run.
pub fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(20), failure_persistence: None, ..ProptestConfig::default() }
}
