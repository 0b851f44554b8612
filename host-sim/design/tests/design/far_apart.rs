//! Riccati equations whose states count for costs that are farther apart than 16 digits: chains of 40 integrators, and a
//! mode that the input hardly reaches. The references are doubling in 100 and 150 digits for these f64 matrices (gmpy2 2.3.2).

use nalgebra::DMatrix;
use quatrack_design::design::{DesignError, care, dare, dlqr};
use quatrack_tests::design_problem::{identity, matrix};

/// Entry (i, j) of P or K, and its reference.
type Entry = (usize, usize, f64);

/// Each reference is the nearest f64, and so is the entry unless it lies in the middle between two of them.
fn assert_entries(name: &str, found: &DMatrix<f64>, entries: &[Entry]) {
    for (i, j, want) in entries {
        let error = (found[(*i, *j)] - want).abs() / want.abs();
        assert!(error <= f64::EPSILON, "{name}[{i}, {j}]: {} instead of {want}", found[(*i, *j)]);
    }
}

/// The pair of a chain of 40 integrators whose last one is driven.
fn chain() -> (DMatrix<f64>, DMatrix<f64>) {
    (
        DMatrix::from_fn(40, 40, |i, j| f64::from(u8::from(j == i + 1))),
        DMatrix::from_fn(40, 1, |i, _| f64::from(u8::from(i == 39))),
    )
}

#[test]
fn a_continuous_chain_of_forty_integrators_is_solved_to_the_last_digit() {
    let (a, b) = chain();
    let solution = care(&a, &b, &identity(40), &identity(1)).expect("controllable and observable");
    // The largest entry of P is 1e18 times the smallest. SciPy 1.17.1 finds no finite solution.
    let p = [(0, 0, 26.088_638_715_381_67), (19, 20, 1.791_095_129_706_671e18), (39, 39, 26.088_638_715_381_67)];
    assert_entries("P", &solution.p, &p);
    // By the first and the last column of the equation: K_0 = sqrt(q / r), and K_39 = P_39,39.
    let gain = [(0, 0, 1.0), (0, 19, 1_821_509_817.643_378_3), (0, 39, 26.088_638_715_381_67)];
    assert_entries("K", &solution.gain, &gain);
    assert!(solution.last_correction <= 1e-17, "{:e}", solution.last_correction);
    // The loop of the rounded gain, in 80 digits (mpmath 1.3.0): -0.076549263. Eigenvalues of a companion matrix of 40 whose entries
    // go to 1e11 are found to a few 1e-7.
    assert!((solution.poles[39].re + 0.076_549_26).abs() < 1e-6, "{}", solution.poles[39]);
}

#[test]
fn a_sampled_chain_of_forty_integrators_is_solved_to_the_last_digit() {
    let (shift, input) = chain();
    let (a, b) = (identity(40) + shift * 0.1, input * 0.1);
    let solution = dare(&a, &b, &identity(40), &identity(1)).expect("controllable and observable");
    // SciPy 1.17.1's P is off by its whole size.
    let p = [
        (0, 0, 281.212_562_861_015_1),
        (0, 39, 36.862_604_561_460_68),
        (19, 20, 1.270_177_613_721_247_6e20),
        (39, 39, 1_258.851_615_054_621_8),
    ];
    assert_entries("P", &solution.p, &p);
    let gain = [(0, 0, 0.271_277_629_971_237_94), (0, 19, 1_307_104_462.174_915_8), (0, 39, 26.027_807_028_069_844)];
    assert_entries("K", &solution.gain, &gain);
    assert!(solution.last_correction <= 1e-17, "{:e}", solution.last_correction);
    // The loop of the rounded gain, in 50 digits: 0.99236484.
    let slowest = solution.poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    assert!((slowest - 0.992_364_8).abs() < 1e-6, "{slowest}");
}

#[test]
fn a_mode_that_is_hardly_reached_costs_what_it_costs() {
    let a = matrix(4, 4, &[1.75, 0.0, 0.0, 0.0, 0.0, 1.5, 0.0, 0.0, 0.0, 0.0, 1.25, 0.0, 0.0, 0.0, 0.0, 0.5]);
    let b = matrix(4, 1, &[1e-10, -1.0, 1.5, 0.5]);
    let solution = dare(&a, &b, &identity(4), &identity(1)).expect("1e-10 is far more than rounding");
    // The eigenvalues of P go from 1.2 to 4e23. SciPy 1.17.1 finds no finite solution.
    let p = [
        (0, 0, 4.212_182_658_737_390_6e23),
        (0, 1, 53_564_804_216_451.62),
        (0, 2, 9_834_963_186_008.324),
        (0, 3, -11_437_133_887.802_94),
        (1, 1, 6_975.973_249_509_720_5),
        (1, 2, 1_337.303_674_816_904_5),
        (1, 3, -0.572_952_928_604_743),
        (2, 2, 277.340_986_668_933_97),
        (2, 3, -0.051_250_859_641_726_41),
        (3, 3, 1.333_330_196_495_842_6),
    ];
    assert_entries("P", &solution.p, &p);
    assert_entries("K", &solution.gain, &[(0, 0, 150_264_404_472.864_14), (0, 3, 0.000_247_276_121_145_845_63)]);
}

/// Modes far outside the unit circle, all driven by one input with the same strength.
fn fast_modes(factor: f64) -> Result<f64, DesignError> {
    let a = DMatrix::from_diagonal(&nalgebra::dvector![1.0, 2.0, 3.0]) * factor;
    let b = matrix(3, 1, &[1.0, 1.0, 1.0]);
    let solution = dlqr(&a, &b, &identity(3), &identity(1))?;
    Ok(solution.poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max))
}

#[test]
fn poles_are_those_of_the_gain_as_it_is_rounded() {
    // The best gain mirrors the modes at the unit circle: a radius of 1e-4. Its entries are about 1e5 and known to 1e-11 each, which
    // moves three poles that are nearly one by the cube root of 1e-11 times the squares of the modes, 1e-3.
    let radius = fast_modes(1e4).expect("stable with its rounded gain");
    assert!((0.01..1.0).contains(&radius), "{radius}");
    // Ten times as fast, and the rounded gain is unstable, with 2.2 in NumPy 2.4.6, though the equation was solved.
    match fast_modes(1e5) {
        Err(DesignError::RoundedGain { pole, .. }) => assert!(pole.norm() > 1.0, "{pole}"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_size_that_hides_the_answer_is_named() {
    let (a, b, one) = (matrix(2, 2, &[0.0, 1.0, 0.0, 0.0]), matrix(2, 1, &[0.0, 1.0]), identity(1));
    for factor in [1e-250, 1e250] {
        let errors = [
            care(&(&a * factor), &(&b * factor), &identity(2), &one).map(|_| ()),
            care(&(&a * factor), &b, &identity(2), &one).map(|_| ()),
        ];
        for error in errors {
            let error = error.expect_err("squares leave the range of f64");
            assert!(matches!(error, DesignError::Size { name: "A", largest, .. } if largest == factor), "{error}");
        }
    }
    let error = dare(&(a.clone() * 1e250), &b, &identity(2), &one).map(|_| ()).expect_err("likewise");
    assert!(matches!(error, DesignError::Size { name: "A", .. }), "{error}");
    // A common factor of A and B is another unit of time: within 1e150 the gain stays what it is.
    for factor in [1e-150, 1e150] {
        let gain =
            care(&(&a * factor), &(&b * factor), &(identity(2) * factor), &(&one * factor)).expect("another unit").gain;
        assert!((gain - matrix(1, 2, &[1.0, 3.0_f64.sqrt()])).norm() < 1e-15, "{factor:e}");
    }
    // What is out of reach is out of reach at any size in range.
    let error = care(&(&a * 1e19), &(&b * 0.0), &identity(2), &one).expect_err("no input");
    assert!(matches!(error, DesignError::NotStabilisable { .. }), "{error}");
}
