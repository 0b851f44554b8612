//! The Riccati solver on cases with a known answer, on random pairs by property, and on problems that it must refuse.

use nalgebra::DMatrix;
use proptest::prelude::*;
use quatrack_design::analysis::MatrixError;
use quatrack_design::design::{DesignError, RiccatiSolution, care, lqr, strong_care};
use quatrack_tests::design_problem::{
    cases, hidden_mode, identity, matrix, random_problem, relative_error, scales_with_the_states,
};

/// CAREX 2.2 with eps = 2^-24 and 2^-40: p11, p12, p22.
const REFERENCE_2_2_A: (i32, [f64; 3]) = (24, [74.723_329_897_026_65, 830.150_239_126_018_5, 9_222.981_792_028_486]);
const REFERENCE_2_2_B: (i32, [f64; 3]) = (40, [74.684_032_287_897_57, 829.822_154_444_812_1, 9_220.242_598_627_244]);

fn assert_stable(solution: &RiccatiSolution) {
    assert!(solution.poles.iter().all(|pole| pole.re < 0.0), "{:?}", solution.poles);
}

#[test]
fn scalar_equation_has_the_roots_of_its_quadratic() {
    // 2 a p + q - p^2 b^2 / r = 0, the larger root.
    for (a, b, q, r) in [(1.0, 2.0, 3.0, 4.0), (-7.0, 0.5, 1e-6, 1e3), (1e5, 1e-4, 1e8, 1e-8), (0.0, 1.0, 2.0, 2.0)] {
        let solution = lqr(&matrix(1, 1, &[a]), &matrix(1, 1, &[b]), &matrix(1, 1, &[q]), &matrix(1, 1, &[r]))
            .expect("controllable and observable");
        let g: f64 = b * b / r;
        let root = (a * a + g * q).sqrt();
        // The form without cancellation.
        let p = if a > 0.0 { (a + root) / g } else { q / (root - a) };
        // A handful of roundings in the closed form.
        assert!((solution.p[(0, 0)] - p).abs() <= 4.0 * f64::EPSILON * p, "{a} {b} {q} {r}");
        assert!((solution.poles[0].re + root).abs() <= 8.0 * f64::EPSILON * (a.abs() + root));
    }
}

#[test]
fn without_state_weight_a_stable_plant_is_left_alone_and_an_unstable_one_is_mirrored() {
    let b = matrix(2, 1, &[1.0, 1.0]);
    let zero = DMatrix::zeros(2, 2);
    let stable = lqr(&matrix(2, 2, &[-1.0, 5.0, 0.0, -2.0]), &b, &zero, &identity(1)).expect("stable");
    assert_eq!(stable.p, zero);
    assert_eq!(stable.relative_residual, 0.0);
    // The stabilising solution is not the trivial one: minimum energy moves 1 to -1 and leaves -3.
    let mirrored = lqr(&matrix(2, 2, &[1.0, 0.0, 0.0, -3.0]), &b, &zero, &identity(1)).expect("controllable");
    assert!((&mirrored.p - matrix(2, 2, &[2.0, 0.0, 0.0, 0.0])).amax() < 1e-15);
    assert!((mirrored.poles[0].re + 3.0).abs() < 1e-14 && (mirrored.poles[1].re + 1.0).abs() < 1e-14);
}

#[test]
fn without_state_weight_a_jordan_block_is_mirrored_by_the_inverse_of_its_gramian() {
    // P^-1 solves A Y + Y A' = B B'. For A = 2 I + N, B = e_2: y22 = 1/4, y12 = -y22/4, y11 = -y12/2.
    let a = matrix(2, 2, &[2.0, 1.0, 0.0, 2.0]);
    let solution = lqr(&a, &matrix(2, 1, &[0.0, 1.0]), &DMatrix::zeros(2, 2), &identity(1)).expect("controllable");
    let gramian = matrix(2, 2, &[1.0 / 32.0, -1.0 / 16.0, -1.0 / 16.0, 1.0 / 4.0]);
    assert!((solution.p * gramian - identity(2)).amax() < 1e-14);
}

#[test]
fn chains_of_integrators_have_butterworth_poles() {
    // Weight on the first state of a chain only: the poles lie on a circle, evenly, at the 2n-th roots of +-1.
    for n in [2_usize, 5, 12] {
        let a = DMatrix::from_fn(n, n, |i, j| if j == i + 1 { 1.0 } else { 0.0 });
        let b = DMatrix::from_fn(n, 1, |i, _| if i == n - 1 { 1.0 } else { 0.0 });
        let mut q = DMatrix::zeros(n, n);
        q[(0, 0)] = 1.0;
        let solution = lqr(&a, &b, &q, &identity(1)).expect("controllable");
        assert_stable(&solution);
        for pole in &solution.poles {
            // The poles of a chain of n integrators are conditioned like its polynomial: 1e-16 * 1e5 for n = 12.
            assert!((pole.norm() - 1.0).abs() < 1e-10, "n = {n}: {pole}");
        }
        // The gain's first entry is the polynomial's constant, its last one 1 / sin(pi / 2n).
        assert!((solution.gain[(0, 0)] - 1.0).abs() < 1e-14);
        let last = (std::f64::consts::FRAC_PI_2 / n as f64).sin().recip();
        assert!((solution.gain[(0, n - 1)] - last).abs() < 1e-14 * last);
    }
}

#[test]
fn the_published_exact_solutions_come_out_to_the_last_digits() {
    // CAREX 1.2, 2.1, 2.3 (Benner, Laub, Mehrmann 1995), whose exact solutions are closed forms.
    let factor = 1.0 + 2.0_f64.sqrt();
    let solution = lqr(
        &matrix(2, 2, &[4.0, 3.0, -4.5, -3.5]),
        &matrix(2, 1, &[1.0, -1.0]),
        &matrix(2, 2, &[9.0, 6.0, 6.0, 4.0]),
        &identity(1),
    )
    .expect("stabilisable, detectable");
    assert!(relative_error(&solution.p, &(matrix(2, 2, &[9.0, 6.0, 6.0, 4.0]) * factor)) < 1e-15);

    for epsilon in [1.0_f64, 1e-6, 1e-12] {
        let solution = lqr(
            &matrix(2, 2, &[1.0, 0.0, 0.0, -2.0]),
            &matrix(2, 1, &[epsilon, 0.0]),
            &DMatrix::from_element(2, 2, 1.0),
            &identity(1),
        )
        .expect("the input reaches the unstable mode, however weakly");
        let root = (1.0 + epsilon * epsilon).sqrt();
        let p12 = 1.0 / (2.0 + root);
        let p11 = (1.0 + root) / (epsilon * epsilon);
        let p22 = 0.25 * (1.0 - epsilon * epsilon * p12 * p12);
        for (i, j, want) in [(0, 0, p11), (0, 1, p12), (1, 1, p22)] {
            // Entry by entry: they differ by up to 24 orders of magnitude.
            assert!((solution.p[(i, j)] - want).abs() < 1e-15 * want, "{epsilon}: {i}{j}");
        }
    }

    for epsilon in [1e-6_f64, 1.0, 1e6, 1e12] {
        let solution =
            lqr(&matrix(2, 2, &[0.0, epsilon, 0.0, 0.0]), &matrix(2, 1, &[0.0, 1.0]), &identity(2), &identity(1))
                .expect("controllable");
        let root = (1.0 + 2.0 * epsilon).sqrt();
        for (i, j, want) in [(0, 0, root / epsilon), (0, 1, 1.0), (1, 1, root)] {
            assert!((solution.p[(i, j)] - want).abs() < 1e-15 * want, "{epsilon}: {i}{j}");
        }
    }
}

#[test]
fn an_input_weight_that_is_nearly_singular_costs_no_digits() {
    // CAREX 2.2 with eps = 2^-k, so that its R is exact in f64. Forming B R^-1 B' loses k bits.
    // Reference: sign function of the Hamiltonian in 90 digits (mpmath 1.4.1).
    let solve = |epsilon: f64| {
        care(
            &matrix(2, 2, &[-0.1, 0.0, 0.0, -0.02]),
            &matrix(2, 2, &[0.1, 0.0, 0.001, 0.01]),
            &matrix(2, 2, &[100.0, 1000.0, 1000.0, 10000.0]),
            &matrix(2, 2, &[1.0 + epsilon, 1.0, 1.0, 1.0]),
        )
        .expect("R is positive definite")
    };
    for (exponent, want) in [REFERENCE_2_2_A, REFERENCE_2_2_B] {
        let solution = solve(f64::from(-exponent).exp2());
        let want = matrix(2, 2, &[want[0], want[1], want[1], want[2]]);
        // Rounded once.
        assert!(relative_error(&solution.p, &want) < 2.0 * f64::EPSILON, "2^-{exponent}: {}", solution.p);
    }
}

#[test]
fn a_mode_twelve_orders_slower_than_the_rest_is_stabilised() {
    // Q and B B' of rank 1 see one mode only; the other one lives on A = 2^-40 [1 2; 3 -1] alone, below the rounding of
    // the Hamiltonian's square. Reference: sign function of the Hamiltonian in 120 digits (mpmath 1.4.1).
    let a = matrix(2, 2, &[1.0, 2.0, 3.0, -1.0]) * f64::from(-40).exp2();
    let q = matrix(2, 2, &[9.0, 3.0, 3.0, 1.0]);
    let solution = lqr(&a, &matrix(2, 1, &[1.0, 2.0]), &q, &identity(1)).expect("controllable, observable");
    let want = [1.800_000_000_000_335_6, 0.600_000_000_000_377_9, 0.200_000_000_000_265_8];
    for (i, j, want) in [(0, 0, want[0]), (0, 1, want[1]), (1, 1, want[2])] {
        assert!((solution.p[(i, j)] - want).abs() <= 2.0 * f64::EPSILON * want, "{i}{j}: {}", solution.p[(i, j)]);
    }
    // Poles of the rounded closed loop: the slow one to eps of the fast one.
    assert!((solution.poles[0].re + 5.0).abs() < 1e-14);
    assert!((solution.poles[1].re + 2.910_383_045_673_37e-12).abs() < 1e-15);
}

#[test]
fn poles_on_the_axis_are_refused_and_accepted_as_a_strong_solution() {
    // CAREX 2.5 (Laub 1992) at eps = 0: P = [2 1; 1 1] leaves the poles +-i.
    let (a, b) = (matrix(2, 2, &[3.0, 1.0, 4.0, 2.0]), matrix(2, 1, &[1.0, 1.0]));
    let q = matrix(2, 2, &[-11.0, -5.0, -5.0, -2.0]);
    let error = care(&a, &b, &q, &identity(1)).expect_err("no stabilising solution");
    let DesignError::HamiltonianOnAxis { eigenvalue } = error else { panic!("{error}") };
    assert!((eigenvalue.im - 1.0).abs() < 1e-7 && eigenvalue.re == 0.0);
    let solution = strong_care(&a, &b, &q, &identity(1)).expect("the limit of stabilising solutions");
    // SciPy 1.17.1 reaches 1e-8; the steps halve the error down to the rounding of the closed loop.
    assert!(relative_error(&solution.p, &matrix(2, 2, &[2.0, 1.0, 1.0, 1.0])) < 1e-13);
    assert!(
        matches!(lqr(&a, &b, &q, &identity(1)), Err(DesignError::NotPositiveSemidefinite { eigenvalue }) if eigenvalue < -13.0)
    );
}

#[test]
fn modes_out_of_reach_or_out_of_sight_are_named() {
    // A rotation by a rational angle hides the structure from the solver.
    let rotation = matrix(3, 3, &[0.6, -0.8, 0.0, 0.48, 0.36, -0.8, 0.64, 0.48, 0.6]);
    let rotate = |m: &DMatrix<f64>| &rotation * m * rotation.transpose();
    let a = rotate(&matrix(3, 3, &[2.0, 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 3.0, 4.0]));
    let b = &rotation * matrix(3, 1, &[0.0, 1.0, 1.0]);
    let error = lqr(&a, &b, &identity(3), &identity(1)).expect_err("2 is out of reach");
    assert!(
        matches!(error, DesignError::NotStabilisable { eigenvalue } if (eigenvalue.re - 2.0).abs() < 1e-12),
        "{error}"
    );

    // A Jordan block at 0 whose end is out of reach: its computed eigenvalues scatter by 1e-5, the verdict does not.
    let a = rotate(&matrix(3, 3, &[0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]));
    let b = &rotation * matrix(3, 1, &[0.0, 1.0, 0.0]);
    let error = lqr(&a, &b, &identity(3), &identity(1)).expect_err("the end of the chain is out of reach");
    assert!(matches!(error, DesignError::NotStabilisable { eigenvalue } if eigenvalue.norm() < 1e-12), "{error}");

    // A stable mode out of reach does no harm.
    let a = rotate(&matrix(3, 3, &[-2.0, 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 3.0, 4.0]));
    let b = &rotation * matrix(3, 1, &[0.0, 1.0, 1.0]);
    assert_stable(&lqr(&a, &b, &identity(3), &identity(1)).expect("stabilisable"));

    // An oscillator at 3 rad/s that Q does not see.
    let a = rotate(&matrix(3, 3, &[0.0, 3.0, 0.0, -3.0, 0.0, 0.0, 0.0, 0.0, 1.0]));
    let q = rotate(&matrix(3, 3, &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]));
    let error = lqr(&a, &matrix(3, 1, &[1.0, 0.5, 2.0]), &q, &identity(1)).expect_err("out of sight");
    let DesignError::NotDetectable { eigenvalue } = error else { panic!("{error}") };
    assert!((eigenvalue.im.abs() - 3.0).abs() < 1e-12);

    // A position without weight: the optimum never brings it back.
    let double_integrator = matrix(2, 2, &[0.0, 1.0, 0.0, 0.0]);
    let q = matrix(2, 2, &[0.0, 0.0, 0.0, 1.0]);
    let error = lqr(&double_integrator, &matrix(2, 1, &[0.0, 1.0]), &q, &identity(1)).expect_err("no weight");
    assert!(matches!(error, DesignError::NotDetectable { .. }), "{error}");
}

#[test]
fn unusable_matrices_are_named_with_the_offending_entry() {
    let (a, b, q, r) = (identity(2), DMatrix::from_element(2, 1, 1.0), identity(2), identity(1));
    let refuse = |a: &DMatrix<f64>, b: &DMatrix<f64>, q: &DMatrix<f64>, r: &DMatrix<f64>| {
        let error = lqr(a, b, q, r).expect_err("unusable").to_string();
        assert!(!error.contains('\n'), "{error}");
        error
    };
    assert_eq!(refuse(&DMatrix::zeros(2, 3), &b, &q, &r), "A is 2x3; it must be square");
    assert_eq!(refuse(&a, &DMatrix::zeros(3, 1), &q, &r), "B is 3x1; it must be 2x1 to fit A");
    assert_eq!(refuse(&a, &b, &identity(3), &r), "Q is 3x3; it must be 2x2 to fit A");
    assert_eq!(refuse(&a, &b, &q, &identity(2)), "R is 2x2; it must be 1x1 to fit the columns of B");
    assert_eq!(refuse(&a, &DMatrix::zeros(2, 0), &q, &r), "B is empty; it needs at least one row and one column");
    let with_nan = matrix(2, 2, &[1.0, 0.0, f64::NAN, 1.0]);
    assert_eq!(refuse(&with_nan, &b, &q, &r), "A[1,0] is NaN; every entry must be finite");
    let asymmetric = matrix(2, 2, &[1.0, 0.5, 0.25, 1.0]);
    assert!(refuse(&a, &b, &asymmetric, &r).starts_with("Q[0,1] is 0.5 but Q[1,0] is 0.25"));
    let indefinite = matrix(2, 2, &[1.0, 2.0, 2.0, 1.0]);
    assert!(refuse(&a, &b, &indefinite, &r).starts_with("Q has the eigenvalue -1.000e0"));
    for weight in [0.0, -1.0] {
        assert!(refuse(&a, &b, &q, &matrix(1, 1, &[weight])).starts_with("R is not positive definite: pivot 0"));
    }
    let singular = DMatrix::from_element(2, 2, 1.0);
    assert!(refuse(&a, &identity(2), &q, &singular).starts_with("R is not positive definite: pivot 1"));
    let error = care(&with_nan, &b, &q, &r).expect_err("NaN");
    assert!(matches!(error, DesignError::Matrix(MatrixError::NotFinite { name: "A", row: 1, column: 0, .. })));
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn random_pairs_are_solved_and_the_solution_is_the_stabilising_one((a, b, q, r) in random_problem()) {
        let solution = match lqr(&a, &b, &q, &r) {
            Ok(solution) => solution,
            // Entries drawn at random may leave a mode out of reach, but only if the input is all but zero.
            Err(error) => { prop_assert!(b.norm() < 1e-6, "{error}"); return Ok(()); }
        };
        prop_assert!(solution.poles.iter().all(|pole| pole.re < 0.0));
        prop_assert!(solution.last_correction < 1e-15);
        prop_assert!(solution.p.clone().cholesky().is_some(), "P > 0 for Q > 0");
        // The residual in plain arithmetic, against the size of its terms: their roundings, n eps each.
        let pa = &solution.p * &a;
        let quadratic = solution.gain.transpose() * &r * &solution.gain;
        let residual = &pa + pa.transpose() + &q - &quadratic;
        let terms = solution.p.norm() * a.norm() + q.norm() + solution.gain.norm().powi(2) * r.norm();
        prop_assert!(residual.norm() <= 1e-13 * terms, "{:e}", residual.norm() / terms);
    }

    #[test]
    fn scaling_the_states_scales_the_solution(
        (a, b, q, r) in random_problem(), exponents in prop::collection::vec(-30..30_i32, 8),
    ) {
        prop_assume!(b.norm() > 1e-3);
        scales_with_the_states((&a, &b, &q), &exponents, |a, b, q| Some(lqr(a, b, q, &r).ok()?.p))?;
    }

    #[test]
    fn a_hidden_unstable_mode_is_found_in_any_basis((a, b) in hidden_mode(0.1..2.0_f64)) {
        let result = lqr(&a, &b, &identity(a.nrows()), &identity(2));
        prop_assert!(
            matches!(result, Err(DesignError::NotStabilisable { eigenvalue }) if eigenvalue.re >= 0.0),
            "{:?}", result
        );
    }
}
