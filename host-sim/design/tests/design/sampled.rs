//! Gains for a control rate: the paper's problems in 70 digits, their limit, their cost, integrals and delays.

use nalgebra::DMatrix;
use quatrack_design::analysis::eigenvalues;
use quatrack_design::design::discretise::zero_order_hold;
use quatrack_design::design::integral::{IntegralWeights, lqi, sampled_lqi};
use quatrack_design::design::sampled::{
    CostForm, Sampling, equilibrium_pair, sampled_cost, sampled_equilibrium, sampled_flat,
};
use quatrack_design::design::synthesis::{EquilibriumWeights, FlatWeights, lqr_equilibrium};

fn matrix(rows: usize, columns: usize, entries: &[f64]) -> DMatrix<f64> {
    DMatrix::from_row_slice(rows, columns, entries)
}

fn identity(n: usize) -> DMatrix<f64> {
    DMatrix::identity(n, n)
}

/// The non-zero entries of the E gain: T of z and vz; q of x, q2, vx; r of q3.
fn chain_gains(gain: &DMatrix<f64>) -> [f64; 6] {
    [gain[(0, 2)], gain[(0, 8)], gain[(2, 0)], gain[(2, 4)], gain[(2, 6)], gain[(3, 5)]]
}

fn assert_close(got: &[f64], want: &[f64], tolerance: f64, figure: &str) {
    for (got, want) in got.iter().zip(want) {
        assert!((got - want).abs() <= tolerance * want.abs(), "{figure}: {got} is not {want}");
    }
}

#[test]
fn the_paper_s_gains_at_a_rate_are_those_of_seventy_digits() {
    // Reference: Van Loan's exponential, doubling in 70 digits (mpmath 1.4.1); rounded once more by the table.
    let weights = EquilibriumWeights::paper();
    let cases = [
        (
            100,
            CostForm::Integral,
            [
                72.263_322_274_206_32,
                52.493_052_088_836_61,
                28.208_886_657_292_244,
                43.149_401_909_606_58,
                22.846_176_208_731_62,
                9.755_106_240_018_853,
            ],
        ),
        (
            100,
            CostForm::Sum,
            [
                70.217_602_966_427_2,
                51.045_970_351_324_08,
                28.203_396_143_290_957,
                43.145_266_668_177_12,
                22.841_997_775_696_402,
                9.753_124_511_871_278,
            ],
        ),
        (
            500,
            CostForm::Integral,
            [
                93.192_715_970_776_56,
                67.296_557_021_488_62,
                30.907_186_970_659_317,
                45.249_913_201_262_01,
                24.903_625_473_062_615,
                9.950_207_503_371_584,
            ],
        ),
        (
            500,
            CostForm::Sum,
            [
                93.048_232_547_442_45,
                67.194_369_222_401,
                30.906_932_435_756_453,
                45.249_728_490_020_13,
                24.903_432_268_640_631,
                9.950_124_999_218_759,
            ],
        ),
    ];
    for (rate_hz, cost, want) in cases {
        let design = sampled_equilibrium(&weights, &Sampling { cost, ..Sampling::at_rate(rate_hz) }).expect("solvable");
        // A few ulp: K is formed once from a P good to 32 digits, but A_d, B_d and the cost are rounded before, and at
        // 500 Hz P feels that about 1 / (1 - radius^2) = 100 times.
        assert_close(&chain_gains(&design.gain), &want, 1e-13, &format!("{rate_hz} Hz {cost:?}"));
        assert!(design.relative_residual <= 1e-15, "{:e}", design.relative_residual);
        assert!(design.poles.iter().all(|pole| pole.norm() < 1.0));
        assert_eq!(design.gain.iter().filter(|entry| **entry != 0.0).count(), 9, "as sparse as the continuous gain");
    }
    let flat = sampled_flat(&FlatWeights::paper(), &Sampling::at_rate(100)).expect("solvable").gain;
    let entries = [flat[(0, 0)], flat[(0, 3)], flat[(3, 6)], flat[(6, 9)]];
    let want = [39.765_899_857_127_51, 21.791_362_912_310_656, 27.207_726_920_775_678, 18.154_334_498_411_703];
    assert_close(&entries, &want, 1e-13, "LQR-F at 100 Hz");
}

#[test]
fn the_sampled_gain_tends_to_the_continuous_one() {
    let weights = EquilibriumWeights::paper();
    let continuous = lqr_equilibrium(&weights).expect("solvable").gain;
    let distance = |rate_hz: u32| {
        let gain = sampled_equilibrium(&weights, &Sampling::at_rate(rate_hz)).expect("solvable").gain;
        (gain - DMatrix::from_column_slice(4, 9, continuous.as_slice())).norm()
    };
    let (coarse, fine) = (distance(10_000), distance(20_000));
    // First order in the period: half the period, half the distance, up to a next term of order h |A - B K| = 1 %.
    assert!((coarse / fine - 2.0).abs() < 0.02, "{coarse} {fine}");
}

#[test]
fn the_sampled_cost_is_the_integral_along_the_motion() {
    // x' = u from x = 3 with u = -2 over 0.5 s: int (3 - 2 t)^2 * 4 + 0.5 * 4 dt = 4 (27 - 8) / 6 + 1.
    let cost = sampled_cost(&matrix(1, 1, &[0.0]), &identity(1), &matrix(1, 1, &[4.0]), &matrix(1, 1, &[0.5]), 0.5)
        .expect("ok");
    let (x, u) = (3.0, -2.0);
    let total = cost.q[(0, 0)] * x * x + 2.0 * cost.s[(0, 0)] * x * u + cost.r[(0, 0)] * u * u;
    assert!((total - (4.0 * 19.0 / 6.0 + 1.0)).abs() < 1e-14, "{total}");
}

#[test]
fn integral_gains_at_a_rate_are_those_of_seventy_digits() {
    let weights = IntegralWeights { equilibrium: EquilibriumWeights::paper(), integral: [50.0; 3] };
    // Reference as above, with the sum i+ = i + h r in the plant and h Q_i in the cost.
    for (rate_hz, want) in [
        (
            100,
            [
                103.135_205_968_628_6,
                52.924_436_166_811_02,
                41.920_076_137_436_21,
                44.195_024_697_905_13,
                24.080_922_300_559_456,
                9.755_106_240_018_853,
                50.948_449_442_808_89,
                19.888_373_556_407_39,
            ],
        ),
        (
            500,
            [
                132.771_452_912_649_27,
                67.842_732_783_353_68,
                45.859_739_256_051_64,
                46.394_432_733_684_37,
                26.256_347_942_957_543,
                9.950_207_503_371_584,
                65.858_613_105_201_77,
                21.841_886_522_051_592,
            ],
        ),
    ] {
        let design = sampled_lqi(&weights, &Sampling::at_rate(rate_hz)).expect("solvable");
        let got: Vec<f64> =
            chain_gains(&design.gain).into_iter().chain([design.gain[(0, 11)], design.gain[(2, 9)]]).collect();
        // As for LQR-E; the slow mode of the integral costs another digit.
        assert_close(&got, &want, 1e-12, &format!("{rate_hz} Hz"));
        assert!(design.poles.iter().all(|pole| pole.norm() < 1.0));
    }
    let continuous = lqi(&weights).expect("solvable");
    assert!(continuous.relative_residual <= 1e-14 && continuous.poles.iter().all(|pole| pole.re < 0.0));
    // The constant of the closed loop's polynomial for z: sqrt(50 / 0.01) by the symmetric root locus.
    assert!((continuous.gain[(0, 11)] - 5000.0_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn a_delay_is_met_with_the_past_commands() {
    let sampling = Sampling { delay_samples: 2, ..Sampling::at_rate(100) };
    let design = sampled_equilibrium(&EquilibriumWeights::paper(), &sampling).expect("solvable");
    // Reference: value iteration on the plant with the two past commands as states (NumPy 2.4.6), 1e-8 accurate.
    assert_close(
        &chain_gains(&design.gain),
        &[72.263_322_274, 53.938_318_534, 28.208_886_660, 52.224_933_096, 23.410_353_942, 9.755_106_240],
        1e-8,
        "of the state",
    );
    let (last, before) = (&design.past_command_gains[0], &design.past_command_gains[1]);
    let diagonal = |gain: &DMatrix<f64>| [gain[(0, 0)], gain[(1, 1)], gain[(2, 2)], gain[(3, 3)]];
    assert_close(&diagonal(last), &[0.528_543_687, 0.226_999_18, 0.226_999_18, 0.048_775_531_2], 1e-7, "last");
    assert_close(&diagonal(before), &[0.535_770_019, 0.249_688_008, 0.249_688_008, 0.048_775_531_2], 1e-7, "before");
    // The loop with the delay has the poles without it, and the rest at 0.
    let (a, b) = equilibrium_pair();
    let held = zero_order_hold(&a, &b, sampling.period_s).expect("finite");
    let mut whole = DMatrix::zeros(17, 17);
    whole.view_mut((0, 0), (9, 9)).copy_from(&held.a);
    whole.view_mut((0, 13), (9, 4)).copy_from(&held.b);
    whole.view_mut((9, 0), (4, 9)).copy_from(&-&design.gain);
    whole.view_mut((9, 9), (4, 4)).copy_from(&-last);
    whole.view_mut((9, 13), (4, 4)).copy_from(&-before);
    whole.view_mut((13, 9), (4, 4)).copy_from(&identity(4));
    let mut moduli: Vec<f64> = eigenvalues(&whole).expect("found").iter().map(|value| value.norm()).collect();
    let mut want: Vec<f64> = design.poles.iter().map(|pole| pole.norm()).collect();
    moduli.sort_by(f64::total_cmp);
    want.sort_by(f64::total_cmp);
    // Zero in blocks of size 2 comes out at the root of the rounding.
    assert!(moduli[..8].iter().all(|modulus| *modulus < 1e-6), "{moduli:?}");
    assert_close(&moduli[8..], &want, 1e-9, "poles");
}
