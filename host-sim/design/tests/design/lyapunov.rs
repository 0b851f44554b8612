//! The Lyapunov equation on cases with a known answer and by property.

use nalgebra::DMatrix;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use quatrack_design::design::{DesignError, decay_rate_design, lyapunov};

fn matrix(rows: usize, columns: usize, entries: &[f64]) -> DMatrix<f64> {
    DMatrix::from_row_slice(rows, columns, entries)
}

#[test]
fn a_diagonal_plant_divides_by_sums_of_its_eigenvalues() {
    let rates = [-1e-6, -1.0, -3.0, 2.0];
    let a = DMatrix::from_fn(4, 4, |i, j| if i == j { rates[i] } else { 0.0 });
    let q = DMatrix::from_fn(4, 4, |i, j| 1.0 + (i + j) as f64);
    let solution = lyapunov(&a, &q).expect("no two rates add up to zero");
    for i in 0..4 {
        for j in 0..4 {
            let want = -q[(i, j)] / (rates[i] + rates[j]);
            assert!((solution.x[(i, j)] - want).abs() <= 2.0 * f64::EPSILON * want.abs(), "{i}{j}");
        }
    }
}

#[test]
fn a_damped_oscillator_has_its_textbook_energy() {
    // x'' + 2 d w x' + w^2 x = 0 with Q = I: p12 = 1/(2 w^2), p22 = (1 + 2 p12)/(4 d w), p11 = w^2 p22 + 2 d w p12.
    for (w, d) in [(1.0_f64, 0.5), (1e4, 1e-3), (1e-3, 2.0)] {
        let solution =
            lyapunov(&matrix(2, 2, &[0.0, 1.0, -w * w, -2.0 * d * w]), &DMatrix::identity(2, 2)).expect("stable");
        let p12 = 0.5 / (w * w);
        let p22 = (1.0 + 2.0 * p12) / (4.0 * d * w);
        let p11 = w * w * p22 + 2.0 * d * w * p12;
        for (i, j, want) in [(0, 0, p11), (0, 1, p12), (1, 1, p22)] {
            // w^2 and 2 d w are rounded before the solver sees them: some 4 eps.
            assert!((solution.x[(i, j)] - want).abs() <= 2e-15 * want, "w = {w}, d = {d}: {i}{j}");
        }
    }
}

#[test]
fn opposite_eigenvalues_are_refused_by_name() {
    let error = lyapunov(&matrix(2, 2, &[3.0, 1.0, 0.0, -3.0]), &DMatrix::identity(2, 2)).expect_err("3 - 3 = 0");
    let DesignError::OppositeEigenvalues { first, second } = error else { panic!("{error}") };
    assert_eq!(first.re + second.re, 0.0);
    assert_eq!(first.re.abs(), 3.0);
    // An oscillator: +i and -i.
    let error = lyapunov(&matrix(2, 2, &[0.0, 1.0, -1.0, 0.0]), &DMatrix::identity(2, 2)).expect_err("i - i = 0");
    assert!(matches!(error, DesignError::OppositeEigenvalues { .. }), "{error}");
    let error = lyapunov(&DMatrix::zeros(1, 1), &DMatrix::identity(1, 1)).expect_err("0 + 0 = 0");
    assert!(matches!(error, DesignError::OppositeEigenvalues { .. }), "{error}");
}

#[test]
fn one_input_of_a_chain_places_every_pole_at_the_rate() {
    // (s + mu)^n has coefficients mu^n binomial(n, k) only if all poles are real; here only the real part is given, so
    // that is checked, and the sum of the poles, trace(A - B K) = -n mu.
    for n in [1_usize, 3, 6] {
        let a = DMatrix::from_fn(n, n, |i, j| if j == i + 1 { 1.0 } else { 0.0 });
        let b = DMatrix::from_fn(n, 1, |i, _| if i == n - 1 { 1.0 } else { 0.0 });
        let design = decay_rate_design(&a, &b, 1.5).expect("controllable");
        assert!((design.gain[(0, n - 1)] - 1.5 * n as f64).abs() < 1e-13 * n as f64);
        for pole in &design.poles {
            // Sensitivity of the poles of a chain of six, 1e4, times eps.
            assert!((pole.re + 1.5).abs() < 1e-11, "n = {n}: {pole}");
        }
        assert!(design.p.cholesky().is_some());
    }
}

/// The same cases on every run.
fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(20), failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn a_solution_made_up_beforehand_comes_back(
        n in 1_usize..8, entries in prop::collection::vec(-3_i32..4, 128), shift in 10_i32..40,
    ) {
        // Integers: Q = -(A' X + X A) is exact, so that X is the exact answer.
        let a = DMatrix::from_fn(n, n, |i, j| f64::from(entries[8 * i + j]) - if i == j { f64::from(shift) } else { 0.0 });
        let x = DMatrix::from_fn(n, n, |i, j| f64::from(entries[64 + 8 * i.min(j) + i.max(j)]));
        let q = -(a.transpose() * &x + &x * &a);
        match lyapunov(&a, &q) {
            // Refined in 32 digits: rounded once.
            Ok(solution) => prop_assert!((solution.x - &x).amax() <= f64::EPSILON * x.amax()),
            Err(error) => prop_assert!(matches!(error, DesignError::OppositeEigenvalues { .. }), "{error}"),
        }
    }

    #[test]
    fn every_pole_of_the_paper_s_design_has_the_same_real_part(
        n in 1_usize..6, entries in prop::collection::vec(-1.0..1.0_f64, 128), mu in 0.5..4.0_f64,
    ) {
        let a = DMatrix::from_fn(n, n, |i, j| entries[8 * i + j] + if i == j { 5.0 } else { 0.0 });
        let b = DMatrix::from_fn(n, n, |i, j| entries[64 + 8 * i + j] + if i == j { 4.0 } else { 0.0 });
        let design = decay_rate_design(&a, &b, mu).expect("B has full rank, A is antistable");
        for pole in &design.poles {
            prop_assert!((pole.re + mu).abs() <= 1e-11 * (a.norm() + mu), "{}", pole);
        }
    }
}
