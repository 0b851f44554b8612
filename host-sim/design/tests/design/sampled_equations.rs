//! Held inputs and the discrete Riccati and Lyapunov equations: closed forms, DAREX, properties, refusals.

use nalgebra::DMatrix;
use proptest::prelude::*;
use quatrack_design::analysis::eigenvalues;
use quatrack_design::design::discretise::{exponential, zero_order_hold, zero_order_hold_late};
use quatrack_design::design::sampled::{CostForm, Sampling, sampled_lqr};
use quatrack_design::design::{DesignError, dare, dlqr, dlqr_with_cross, stein};
use quatrack_tests::design_problem::{
    cases, hidden_mode, identity, matrix, random_problem, relative_error, scales_with_the_states,
};

#[test]
fn exponentials_are_right_to_the_last_digit() {
    // Reference: mpmath 1.4.1, 60 digits. The first one is Moler and Van Loan's catastrophe for Taylor's series.
    let cases = [
        (
            matrix(2, 2, &[-49.0, 24.0, -64.0, 31.0]),
            matrix(
                2,
                2,
                &[-0.735_758_758_144_753_1, 0.551_819_099_658_097_7, -1.471_517_599_088_260_5, 1.103_638_240_715_572_6],
            ),
        ),
        (
            matrix(3, 3, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0]),
            matrix(
                3,
                3,
                &[
                    1_892_793.801_966_453_2,
                    2_319_804.348_433_813,
                    2_921_688.794_284_884,
                    4_267_596.877_957_069,
                    5_230_361.132_647_13,
                    6_587_401.226_390_882,
                    7_065_281.732_605_101,
                    8_659_197.695_550_991,
                    10_905_868.064_094_81,
                ],
            ),
        ),
        (
            matrix(2, 2, &[-500.0, 400.0, 0.0, -1.0]),
            matrix(2, 2, &[7.124_576_406_741_286e-218, 0.294_893_339_616_386_6, 0.0, 0.367_879_441_171_442_3]),
        ),
    ];
    for (m, want) in cases {
        // One rounding of the result, one of the reference as written.
        assert!(relative_error(&exponential(&m).expect("finite"), &want) <= 2.0 * f64::EPSILON, "{m}");
    }
    assert!(exponential(&matrix(1, 1, &[1e3])).is_err(), "e^1000 is no f64");
    assert_eq!(exponential(&DMatrix::zeros(3, 3)).expect("finite"), identity(3));
}

#[test]
fn a_held_chain_has_its_polynomials() {
    let h = 0.125; // A power of two: h^2/2 and h^3/6 are then exact but for the division by 6.
    let a = matrix(3, 3, &[0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    let b = matrix(3, 1, &[0.0, 0.0, 1.0]);
    let held = zero_order_hold(&a, &b, h).expect("a chain");
    assert_eq!(held.a, matrix(3, 3, &[1.0, h, h * h / 2.0, 0.0, 1.0, h, 0.0, 0.0, 1.0]));
    assert_eq!(held.b, matrix(3, 1, &[h * h * h / 6.0, h * h / 2.0, h]));
}

#[test]
fn a_late_hold_splits_into_two_plain_holds() {
    let a = matrix(2, 2, &[-0.5, 2.0, -3.0, 0.25]);
    let b = matrix(2, 2, &[1.0, 0.0, 0.5, -2.0]);
    let (h, late) = (0.01, 0.004);
    let split = zero_order_hold_late(&a, &b, h, 3.0 * h + late).expect("finite");
    let first = zero_order_hold(&a, &b, late).expect("finite");
    let second = zero_order_hold(&a, &b, h - late).expect("finite");
    assert_eq!(split.whole_samples, 3);
    // A handful of roundings of products of order 1; 3 h + late is itself rounded.
    assert!((&split.b_previous - &second.a * &first.b).amax() < 1e-15);
    assert!((&split.b_recent - &second.b).amax() < 1e-15);
    let plain = zero_order_hold(&a, &b, h).expect("finite");
    assert!((&split.b_recent + &split.b_previous - &plain.b).amax() < 1e-16, "a constant input knows no delay");
    assert!((&split.a - &plain.a).amax() < 1e-15);
    assert_eq!(zero_order_hold_late(&a, &b, h, 0.0).expect("finite").b_recent, plain.b);
    assert!(matches!(zero_order_hold(&a, &b, 0.0), Err(DesignError::Period { .. })));
    assert!(matches!(zero_order_hold_late(&a, &b, h, -1.0), Err(DesignError::Delay { .. })));
    assert!(matches!(zero_order_hold_late(&a, &b, h, f64::NAN), Err(DesignError::Delay { .. })));
}

#[test]
fn the_stein_equation_is_solved_to_the_last_digit_or_refused() {
    let a = matrix(3, 3, &[0.5, 0.25, 0.0, -0.75, 0.5, 0.125, 0.0, 0.25, -0.875]);
    let q = matrix(3, 3, &[2.0, 1.0, 0.0, 1.0, 3.0, -1.0, 0.0, -1.0, 1.0]);
    // Reference: the 9 x 9 linear system in 60 digits (mpmath 1.4.1).
    let (x11, x12, x13) = (5.817_627_579_517_81, 0.196_082_617_298_045_77, -0.861_635_477_418_771_3);
    let (x22, x23, x33) = (4.462_724_706_865_584, -1.268_534_432_155_372_4, 5.748_147_117_136_053);
    let want = matrix(3, 3, &[x11, x12, x13, x12, x22, x23, x13, x23, x33]);
    let solution = stein(&a, &q).expect("stable");
    // Each entry is the nearest f64; the norm may round.
    assert!(relative_error(&solution.x, &want) <= f64::EPSILON);
    assert!(solution.relative_residual <= 1e-16, "{:e}", solution.relative_residual);
    // Two reciprocal eigenvalues: no unique solution. Unstable but regular: one.
    let reciprocal = matrix(2, 2, &[2.0, 0.0, 1.0, 0.5]);
    assert!(matches!(stein(&reciprocal, &identity(2)), Err(DesignError::ReciprocalEigenvalues { .. })));
    assert!((stein(&matrix(1, 1, &[3.0]), &identity(1)).expect("regular").x[(0, 0)] + 0.125).abs() < 1e-16);
}

#[test]
fn the_scalar_riccati_equation_has_the_root_of_its_quadratic() {
    for (a, b, q, r) in
        [(1.0_f64, 2.0_f64, 3.0_f64, 4.0_f64), (0.99, 0.01, 1e-3, 1e2), (-5.0, 1e-3, 1.0, 1e-6), (0.0, 1.0, 2.0, 2.0)]
    {
        let solution = dlqr(&matrix(1, 1, &[a]), &matrix(1, 1, &[b]), &matrix(1, 1, &[q]), &matrix(1, 1, &[r]))
            .expect("controllable and observable");
        // b^2 p^2 + (r - a^2 r - q b^2) p - q r = 0, in the form without cancellation.
        let (b2, linear) = (b * b, r * (1.0 - a * a) - q * b * b);
        let root = (linear * linear + 4.0 * b2 * q * r).sqrt();
        let p = if linear > 0.0 { 2.0 * q * r / (linear + root) } else { (root - linear) / (2.0 * b2) };
        // A handful of roundings in the closed form.
        assert!((solution.p[(0, 0)] - p).abs() <= 8.0 * f64::EPSILON * p, "{a} {b} {q} {r}");
        let gain = a * b * p / (r + b2 * p);
        assert!((solution.gain[(0, 0)] - gain).abs() <= 16.0 * f64::EPSILON * gain.abs());
    }
}

#[test]
fn darex_cases_come_out_to_the_last_digits() {
    // DAREX (Benner, Laub, Mehrmann 1995) as SLICOT's BB02AD gives it (ctrlsys 1.1.1); reference for these f64
    // matrices by doubling in 90 digits (mpmath 1.4.1). SciPy 1.17.1's own errors: 2e-16, 1e-8, -, 1e-13, 9e-8.
    let root5 = 5.0_f64.sqrt();
    let cases = [
        (
            "1.3",
            matrix(2, 2, &[0.0, 1.0, 0.0, 0.0]),
            matrix(2, 1, &[0.0, 1.0]),
            matrix(2, 2, &[1.0, 2.0, 2.0, 4.0]),
            identity(1),
            matrix(2, 2, &[1.0, 2.0, 2.0, 2.0 + root5]),
        ),
        (
            "2.1",
            matrix(2, 2, &[4.0, 3.0, -4.5, -3.5]),
            matrix(2, 1, &[1.0, -1.0]),
            matrix(2, 2, &[9.0, 6.0, 6.0, 4.0]),
            matrix(1, 1, &[1e7]),
            matrix(2, 2, &[28_464.999_297_271_65, 18_976.666_198_181_1, 18_976.666_198_181_1, 12_651.110_798_787_4]),
        ),
        (
            "2.2",
            matrix(2, 2, &[0.9512, 0.0, 0.0, 0.9048]),
            matrix(2, 2, &[4.877, 4.877, -1.1895, 3.569]),
            matrix(2, 2, &[0.005, 0.0, 0.0, 0.02]),
            matrix(2, 2, &[3.333_333_333_333_333_4e-8, 0.0, 0.0, 3e7]),
            matrix(
                2,
                2,
                &[
                    0.010_213_495_207_995_157,
                    0.020_332_835_578_128_87,
                    0.020_332_835_578_128_87,
                    0.099_298_874_690_366_09,
                ],
            ),
        ),
        (
            "2.3",
            matrix(2, 2, &[0.0, 1e7, 0.0, 0.0]),
            matrix(2, 1, &[0.0, 1.0]),
            identity(2),
            identity(1),
            matrix(2, 2, &[1.0, 0.0, 0.0, 1e14 + 1.0]),
        ),
        (
            "2.5",
            matrix(4, 4, &[0.999_999_999, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]),
            matrix(4, 1, &[1e-9, 0.0, 0.0, 0.0]),
            DMatrix::from_fn(4, 4, |i, j| f64::from(u8::from(i == 3 && j == 3))),
            matrix(1, 1, &[0.25]),
            DMatrix::from_diagonal(&nalgebra::dvector![309_016_998.628_905_8, 1.0, 1.0, 1.0]),
        ),
    ];
    for (name, a, b, q, r, want) in cases {
        let solution = dlqr(&a, &b, &q, &r).unwrap_or_else(|error| panic!("{name}: {error}"));
        // Rounded once; the reference as written, too.
        let error = relative_error(&solution.p, &want);
        assert!(error <= 2.0 * f64::EPSILON, "{name}: {error:e}");
        assert!(solution.relative_residual <= 1e-14, "{name}: {:e}", solution.relative_residual);
    }
}

#[test]
fn a_shift_register_of_a_hundred_samples_counts_them() {
    // DAREX 4.1: P = diag(1, ..., n).
    let n = 100;
    let a = DMatrix::from_fn(n, n, |i, j| f64::from(u8::from(j == i + 1)));
    let b = DMatrix::from_fn(n, 1, |i, _| f64::from(u8::from(i == n - 1)));
    let solution = dlqr(&a, &b, &identity(n), &identity(1)).expect("controllable");
    let want = DMatrix::from_fn(n, n, |i, j| if i == j { (i + 1) as f64 } else { 0.0 });
    // SciPy 1.17.1: 4e-13.
    assert!(relative_error(&solution.p, &want) <= 1e-15);
}

#[test]
fn an_unstable_mode_that_the_weight_does_not_see_is_mirrored_in_the_circle() {
    // Minimum energy: 2 goes to 1/2, 0.3 stays; doubling alone would leave P = 0 and the plant unstable.
    let solution =
        dare(&matrix(2, 2, &[2.0, 0.0, 0.0, 0.3]), &matrix(2, 1, &[1.0, 1.0]), &DMatrix::zeros(2, 2), &identity(1))
            .expect("controllable");
    assert!((solution.poles[0].re - 0.3).abs() < 1e-14 && (solution.poles[1].re - 0.5).abs() < 1e-14);
    assert!((solution.p - matrix(2, 2, &[3.0, 0.0, 0.0, 0.0])).amax() < 1e-14);
}

#[test]
fn equations_without_an_answer_are_refused_by_name() {
    let (a, b, q, r) = (matrix(2, 2, &[1.0, 0.1, 0.0, 1.0]), matrix(2, 1, &[0.0, 0.1]), identity(2), identity(1));
    let refuse = |a: &DMatrix<f64>, b: &DMatrix<f64>, q: &DMatrix<f64>, r: &DMatrix<f64>| {
        let error = dlqr(a, b, q, r).expect_err("unusable");
        assert!(!error.to_string().contains('\n'), "{error}");
        error
    };
    assert_eq!(refuse(&DMatrix::zeros(2, 3), &b, &q, &r).to_string(), "A is 2x3; it must be square");
    assert_eq!(refuse(&a, &identity(3), &q, &r).to_string(), "B is 3x3; it must be 2x3 to fit A");
    assert!(refuse(&(&a * f64::NAN), &b, &q, &r).to_string().starts_with("A[0,0] is NaN"));
    assert!(refuse(&a, &b, &matrix(2, 2, &[1.0, 2.0, 2.0, 1.0]), &r).to_string().starts_with("Q has the eigenvalue"));
    assert!(refuse(&a, &b, &q, &-&r).to_string().starts_with("R is not positive definite"));
    let indefinite = matrix(2, 2, &[1.0, 2.0, 2.0, 1.0]);
    assert!(matches!(refuse(&a, &identity(2), &q, &indefinite), DesignError::NotPositiveDefinite { row: 1, .. }));
    // Out of reach on the circle and outside; inside it does no harm.
    for mode in [1.0, -1.0, 1.5] {
        let error = refuse(&matrix(2, 2, &[mode, 0.0, 0.3, 0.5]), &matrix(2, 1, &[0.0, 1.0]), &q, &r);
        assert!(matches!(error, DesignError::NotStabilisable { eigenvalue } if (eigenvalue.re - mode).abs() < 1e-12));
    }
    assert!(dlqr(&matrix(2, 2, &[0.9, 0.0, 0.3, 0.5]), &matrix(2, 1, &[0.0, 1.0]), &q, &r).is_ok());
    // Out of sight on the circle: a position without weight; an oscillator.
    let error = refuse(&a, &b, &matrix(2, 2, &[0.0, 0.0, 0.0, 1.0]), &r);
    assert!(matches!(error, DesignError::NotDetectableSampled { .. }), "{error}");
    let turning = matrix(2, 2, &[0.6, -0.8, 0.8, 0.6]);
    let error = refuse(&turning, &b, &DMatrix::zeros(2, 2), &r);
    assert!(
        matches!(error, DesignError::NotDetectableSampled { eigenvalue } if (eigenvalue.im.abs() - 0.8).abs() < 1e-12),
        "{error}"
    );
    let cross = dlqr_with_cross(&a, &b, &q, &r, &matrix(2, 1, &[5.0, 0.0])).expect_err("25 > 1");
    assert!(matches!(cross, DesignError::CrossWeight { eigenvalue } if eigenvalue < -23.0), "{cross}");
    assert!(dlqr_with_cross(&a, &b, &q, &r, &matrix(1, 1, &[0.0])).is_err(), "S must have the shape of B");
}

proptest! {
    #![proptest_config(cases(150))]

    #[test]
    fn random_pairs_are_solved_and_the_solution_is_the_stabilising_one((a, b, q, r) in random_problem()) {
        let solution = match dlqr(&a, &b, &q, &r) {
            Ok(solution) => solution,
            // Entries drawn at random may leave a mode out of reach, but only if the input is all but zero.
            Err(error) => { prop_assert!(b.norm() < 1e-6, "{error}"); return Ok(()); }
        };
        prop_assert!(solution.poles.iter().all(|pole| pole.norm() < 1.0));
        prop_assert!(solution.last_correction < 1e-14);
        prop_assert!(solution.relative_residual < 1e-14, "{:e}", solution.relative_residual);
        prop_assert!(solution.p.clone().cholesky().is_some(), "P > 0 for Q > 0");
        // The cost of the closed loop, by Stein: another equation, the same P.
        let closed_loop = &a - &b * &solution.gain;
        let stage = &q + solution.gain.transpose() * &r * &solution.gain;
        let cost = stein(&closed_loop, &((&stage + stage.transpose()) * 0.5)).expect("stable");
        let error = relative_error(&cost.x, &solution.p);
        // The gain is rounded, and the loop may be slow: its time constant squared times the rounding.
        prop_assert!(error <= 1e-9, "{error:e}");
    }

    #[test]
    fn a_sampled_gain_is_optimal_for_its_own_cost((a, b, q, r) in random_problem(), period_s in 0.001..0.2_f64) {
        prop_assume!(b.norm() > 1e-2);
        let Ok(design) = sampled_lqr(&a, &b, &q, &r, &Sampling { period_s, delay_samples: 0, cost: CostForm::Integral })
        else { return Err(TestCaseError::fail("random pairs are stabilisable")) };
        let held = zero_order_hold(&a, &b, period_s).expect("finite");
        let poles = eigenvalues(&(&held.a - &held.b * &design.gain)).expect("found");
        prop_assert!(poles.iter().all(|pole| pole.norm() < 1.0), "{:?}", poles);
    }

    #[test]
    fn scaling_the_states_scales_the_solution(
        (a, b, q, r) in random_problem(), exponents in prop::collection::vec(-30..30_i32, 8),
    ) {
        prop_assume!(b.norm() > 1e-3);
        scales_with_the_states((&a, &b, &q), &exponents, |a, b, q| Some(dlqr(a, b, q, &r).ok()?.p))?;
    }

    #[test]
    fn a_hidden_unstable_mode_is_found_in_any_basis((a, b) in hidden_mode(1.05..2.0_f64)) {
        let result = dlqr(&a, &b, &identity(a.nrows()), &identity(2));
        prop_assert!(
            matches!(result, Err(DesignError::NotStabilisable { eigenvalue }) if eigenvalue.norm() >= 1.0),
            "{:?}", result
        );
    }
}
