//! Eigenvalues, Jordan blocks and controllability of matrices whose structure is known by construction.

use nalgebra::{Complex, DMatrix};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use quatrack_design::analysis::{
    MatrixError, controllability_matrix, distinct_eigenvalues, eigenvalues, jordan_blocks, numerical_rank, pbh_test,
    singular_values, staircase,
};

fn matrix(rows: usize, columns: usize, entries: &[f64]) -> DMatrix<f64> {
    DMatrix::from_row_slice(rows, columns, entries)
}

/// Block diagonal of Jordan blocks `(eigenvalue, size)`.
fn jordan_form(blocks: &[(f64, usize)]) -> DMatrix<f64> {
    let n = blocks.iter().map(|block| block.1).sum();
    let mut form = DMatrix::zeros(n, n);
    let mut start = 0;
    for (value, size) in blocks {
        for i in 0..*size {
            form[(start + i, start + i)] = *value;
            if i + 1 < *size {
                form[(start + i, start + i + 1)] = 1.0;
            }
        }
        start += size;
    }
    form
}

/// `S m S^-1` with S unit triangular of small integers, so that the product is exact.
fn disguised(m: &DMatrix<f64>) -> DMatrix<f64> {
    let n = m.nrows();
    let mut result = m.clone();
    for k in 0..n - 1 {
        let row = result.row(k).into_owned();
        let mut lower = result.row_mut(k + 1);
        lower += row;
        let column = result.column(k + 1).into_owned();
        let mut left = result.column_mut(k);
        left -= column;
    }
    result
}

#[test]
fn jordan_blocks_survive_a_change_of_basis() {
    let form = jordan_form(&[(2.0, 3), (2.0, 1), (-1.0, 2), (0.0, 1)]);
    let a = disguised(&form);
    assert_ne!(a, form);
    let sizes = |value: f64| jordan_blocks(&a, Complex::new(value, 0.0)).expect("finite").block_sizes;
    assert_eq!(sizes(2.0), [3, 1]);
    assert_eq!(sizes(-1.0), [2]);
    assert_eq!(sizes(0.0), [1]);
    assert_eq!(sizes(1.0), [0; 0]);
}

#[test]
fn complex_eigenvalues_have_jordan_blocks_too() {
    // [C I; 0 C] with C = [0 2; -2 0]: one block of size 2 at each of +-2i.
    let a = matrix(4, 4, &[0.0, 2.0, 1.0, 0.0, -2.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, -2.0, 0.0]);
    for im in [2.0, -2.0] {
        assert_eq!(jordan_blocks(&a, Complex::new(0.0, im)).expect("finite").block_sizes, [2]);
    }
}

#[test]
fn a_cyclic_permutation_does_not_stall_the_iteration() {
    // Every unshifted or double-shifted sweep maps it to itself; its eigenvalues are the roots of unity.
    for n in [3_usize, 4, 7, 12] {
        let a = DMatrix::from_fn(n, n, |i, j| if i == (j + 1) % n { 1.0 } else { 0.0 });
        let values = eigenvalues(&a).expect("bounded and found");
        for value in values {
            assert!((value.norm() - 1.0).abs() < 1e-14);
            assert!((value.powu(n as u32) - Complex::new(1.0, 0.0)).norm() < 1e-13);
        }
    }
}

#[test]
fn balancing_finds_small_eigenvalues_beside_large_entries() {
    // diag(1, 2, 3) under a change of units by 2^40: exact powers of two.
    let d = [1.0, 2.0_f64.powi(40), 2.0_f64.powi(-40)];
    let plain = matrix(3, 3, &[1.0, 1.0, 0.0, 0.0, 2.0, 1.0, 0.0, 0.0, 3.0]);
    let a = DMatrix::from_fn(3, 3, |i, j| plain[(i, j)] * d[i] / d[j]);
    for (value, want) in eigenvalues(&a).expect("found").iter().zip([1.0, 2.0, 3.0]) {
        assert!((value.re - want).abs() < 1e-14 && value.im == 0.0, "{value}");
    }
}

#[test]
fn singular_values_of_a_graded_matrix_keep_their_relative_accuracy() {
    // Orthogonal columns of lengths 1, 1e-10, 1e-20: exactly the singular values.
    let a = matrix(3, 3, &[0.6, 0.8e-10, 0.0, 0.8, -0.6e-10, 0.0, 0.0, 0.0, 1e-20]);
    for (value, want) in singular_values(&a).iter().zip([1.0, 1e-10, 1e-20]) {
        assert!((value / want - 1.0).abs() < 1e-15);
    }
    assert_eq!(numerical_rank(&a).rank, 2);
    assert_eq!(numerical_rank(&DMatrix::zeros(3, 5)).rank, 0);
}

#[test]
fn the_controllability_matrix_is_equation_10() {
    let a = matrix(2, 2, &[1.0, 2.0, 3.0, 4.0]);
    let matrix_10 = controllability_matrix(&a, &matrix(2, 1, &[1.0, -1.0])).expect("fits");
    assert_eq!(matrix_10, matrix(2, 2, &[1.0, -1.0, -1.0, -1.0]));
}

#[test]
fn pbh_names_the_eigenvalue_that_the_input_does_not_move() {
    let a = disguised(&jordan_form(&[(3.0, 1), (-1.0, 2)]));
    // The input enters the second block only, at its end, in the same change of basis.
    let mut b = matrix(3, 1, &[0.0, 1.0, 1.0]);
    for k in 0..2 {
        b[k + 1] += b[k];
    }
    let three = pbh_test(&a, &b, Complex::new(3.0, 0.0)).expect("fits");
    assert!(!three.controllable && three.unstable && three.rank == 2, "{three:?}");
    let stable = pbh_test(&a, &b, Complex::new(-1.0, 0.0)).expect("fits");
    assert!(stable.controllable && !stable.unstable, "{stable:?}");
    let stairs = staircase(&a, &b).expect("fits");
    assert_eq!((stairs.uncontrollable, stairs.steps.as_slice()), (1, &[1, 1][..]));
    assert!((stairs.uncontrollable_a()[(0, 0)] - 3.0).abs() < 1e-13);
}

#[test]
fn matrices_that_cannot_be_analysed_are_named() {
    assert_eq!(eigenvalues(&DMatrix::zeros(2, 3)).expect_err("not square").to_string(), "A is 2x3; it must be square");
    let infinite = matrix(1, 1, &[f64::INFINITY]);
    assert!(matches!(jordan_blocks(&infinite, Complex::new(0.0, 0.0)), Err(MatrixError::NotFinite { row: 0, .. })));
    let error = staircase(&DMatrix::zeros(2, 2), &DMatrix::zeros(3, 1)).expect_err("does not fit");
    assert_eq!(error.to_string(), "B is 3x1; it must be 2x1 to fit A");
    assert_eq!(singular_values(&DMatrix::zeros(0, 0)), [0.0; 0]);
}

#[test]
fn scattered_eigenvalues_of_a_block_are_one_group_with_an_accurate_mean() {
    let values: Vec<_> = (0..3)
        .map(|k| Complex::new(1.0, 0.0) + Complex::from_polar(1e-5, f64::from(k) * 2.0 * std::f64::consts::FRAC_PI_3))
        .chain([Complex::new(-4.0, 0.0)])
        .collect();
    let groups = distinct_eigenvalues(&values, 1e-4);
    assert_eq!(groups.len(), 2);
    assert_eq!((groups[0].1, groups[1].1), (1, 3));
    // Ten orders of magnitude nearer than its members.
    assert!((groups[1].0 - Complex::new(1.0, 0.0)).norm() < 1e-15);
}

/// The same cases on every run.
fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(20), failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn eigenvalues_satisfy_trace_and_determinant(n in 1_usize..9, entries in prop::collection::vec(-1.0..1.0_f64, 64)) {
        let a = DMatrix::from_fn(n, n, |i, j| entries[8 * i + j]);
        let values = eigenvalues(&a).expect("bounded and found");
        let sum: Complex<f64> = values.iter().sum();
        let product: Complex<f64> = values.iter().product();
        // n^2 eps of the norm, here at most 8; exact pairs make both real.
        prop_assert!((sum - Complex::new(a.trace(), 0.0)).norm() < 1e-13);
        prop_assert!((product - Complex::new(a.determinant(), 0.0)).norm() < 1e-11);
        prop_assert!(values.iter().all(|value| values.contains(&value.conj())));
    }

    #[test]
    fn the_staircase_splits_a_hidden_uncontrollable_part(
        n in 2_usize..8, hidden in 1_usize..3, entries in prop::collection::vec(-1.0..1.0_f64, 200),
    ) {
        prop_assume!(hidden < n);
        // Block triangular with no input on the first part, then rotated by the orthogonal factor of a random matrix.
        let a = DMatrix::from_fn(n, n, |i, j| if i < hidden && j >= hidden { 0.0 } else { entries[8 * i + j] });
        let b = DMatrix::from_fn(n, 2, |i, j| if i < hidden { 0.0 } else { entries[64 + 2 * i + j] });
        let q = DMatrix::from_fn(n, n, |i, j| entries[100 + 8 * i + j]).qr().q();
        let (rotated_a, rotated_b) = (&q * &a * q.transpose(), &q * b);
        let stairs = staircase(&rotated_a, &rotated_b).expect("fits");
        let t = &stairs.transformation;
        prop_assert!((t * t.transpose() - DMatrix::identity(n, n)).norm() < 1e-13);
        prop_assert!(stairs.b.rows(0, stairs.uncontrollable).norm() < 1e-13);
        prop_assert!(stairs.a.view((0, stairs.uncontrollable), (stairs.uncontrollable, n - stairs.uncontrollable)).norm() < 1e-13);
        let hidden_modes = eigenvalues(&a.view((0, 0), (hidden, hidden)).into_owned()).expect("found");
        for value in &hidden_modes {
            // A pair of nearly equal eigenvalues is known to the root of the rounding.
            let test = pbh_test(&rotated_a, &rotated_b, *value).expect("fits");
            prop_assert!(test.smallest_singular_value < 1e-7, "{test:?}");
        }
        // Random entries may hide more; they may also make a step hang on so weak a coupling that less is found.
        if stairs.uncontrollable == hidden {
            let mut found = eigenvalues(&stairs.uncontrollable_a()).expect("found");
            for value in hidden_modes {
                let distance = |i: &usize| (found[*i] - value).norm();
                let nearest = (0..hidden).min_by(|i, j| distance(i).total_cmp(&distance(j))).unwrap_or(0);
                let error = distance(&nearest);
                prop_assert!(error < 1e-6, "{value} is off by {error:e}");
                found[nearest] = Complex::new(f64::MAX, 0.0);
            }
        }
    }
}
