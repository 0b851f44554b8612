//! Certificates of the project's gains: the paper's, those with a delay or sums in the loop, and those that are refused.

use nalgebra::DMatrix;
use quatrack_design::certify::{Certificate, CertifyError, Controller, Minimum, Plant, Timing, certify, require};
use quatrack_design::design::integral::{IntegralWeights, sampled_lqi};
use quatrack_design::design::sampled::{Sampling, sampled_equilibrium};
use quatrack_design::design::synthesis::{
    EquilibriumWeights, FlatWeights, PAPER_MU, lqr_flat, lyapunov_equilibrium, lyapunov_flat,
};

use super::certify::{assert_near, certified, dense, lqr_e};

#[test]
fn lqr_e_does_not_stand_fifty_milliseconds_of_motor_lag_behind_a_rate_loop() {
    // A bare first-order lag of the body rates, at a rate that is as good as continuous: Routh's criterion for
    // tau s^4 + s^3 + kq s^2/2 + g kv s + g kx gives tau < (kq/2 g kv - g kx) / (g kv)^2.
    let gain = lqr_e().gain;
    let (kx, kq, kv) = (9.81 * gain[(2, 0)], 0.5 * gain[(2, 4)], 9.81 * gain[(2, 6)]);
    let routh_s = (kq * kv - kx) / (kv * kv);
    let limit = |timing: Timing, rate_gain_1_s: f64| {
        certify(&Plant::equilibrium(), &lqr_e(), &timing, Some(rate_gain_1_s)).expect("stable")
    };
    let fast = limit(Timing::at_rate(2000), 20.0);
    // The hold is a delay of half a period, 0.25 ms, and counts about once against the lag.
    assert!((fast.lag[1].stable_to_s - routh_s).abs() < 1e-3, "{} {routh_s}", fast.lag[1].stable_to_s);
    assert!((0.086..0.088).contains(&routh_s), "{routh_s}");
    // With the motors inside a rate loop no rate gain brings it to 50 ms.
    for rate_gain_1_s in [10.0, 15.0, 20.0, 30.0, 40.0, 60.0, 100.0] {
        let found = limit(Timing::at_rate(500), rate_gain_1_s).motors_in_rate_loop.expect("asked for");
        let all = found.last().expect("all").stable_to_s;
        assert!(all < 0.05, "rate gain {rate_gain_1_s}: {all}");
    }
    // The slow Lyapunov gain tolerates it.
    let slow = dense(&lyapunov_equilibrium(PAPER_MU).expect("solvable").gain);
    let found = certify(&Plant::equilibrium(), &slow, &Timing::at_rate(500), Some(20.0)).expect("stable");
    assert!(found.motors_in_rate_loop.expect("asked for").last().expect("all").stable_to_s > 0.1);
}

#[test]
fn the_paper_s_gains_keep_their_certificates() {
    // Regression, six digits; the closed forms above and below say why they are right. Flat chains of order two are
    // s^2 + 4 s + 8, so alpha = 2 / sqrt(3) in continuous time.
    let lyapunov_f = dense(&lyapunov_flat(PAPER_MU).expect("solvable").gain);
    let lyapunov_e = dense(&lyapunov_equilibrium(PAPER_MU).expect("solvable").gain);
    let lqr_f = dense(&lqr_flat(&FlatWeights::paper()).expect("solvable").gain);
    let cases = [
        (Plant::equilibrium(), lyapunov_e, [0.996_005, 0.823_665, 0.146_894, 0.192_798]),
        (Plant::equilibrium(), lqr_e(), [0.997_175, 1.112_477, 0.020_538, 0.083_987]),
        (Plant::flat_chain(), lyapunov_f, [0.996, 1.151_614, 0.259_248, 0.497_004]),
        (Plant::flat_chain(), lqr_f, [0.995_993, 1.745_459, 0.048_687, 0.528_727]),
    ];
    for (plant, controller, [radius, alpha, delay_s, lag_s]) in cases {
        let certificate = certified(&plant, &controller, Timing::at_rate(500));
        let sampled = &certificate.sampled;
        let rounded = 1e-4;
        assert_near(sampled.spectral_radius, radius, rounded, "spectral radius");
        assert_near(sampled.margins.all.balanced.alpha, alpha, rounded, "disk margin");
        assert_near(certificate.delay.last().expect("all").stable_to_s, delay_s, rounded, "delay");
        assert_near(certificate.lag.last().expect("all").stable_to_s, lag_s, rounded, "lag");
        assert!(sampled.decrease.holds);
        // Half an ulp of an f32.
        assert!(certificate.rounding.largest_relative <= f64::from(f32::EPSILON) / 2.0);
    }
}

#[test]
fn a_design_for_a_delay_keeps_the_poles_that_the_delay_free_one_has() {
    let weights = EquilibriumWeights::paper();
    let late = Sampling { delay_samples: 2, ..Sampling::at_rate(100) };
    let plain = sampled_equilibrium(&weights, &Sampling::at_rate(100)).expect("solvable");
    let delayed = sampled_equilibrium(&weights, &late).expect("solvable");
    let timing = Timing { delay_samples: 2, ..Timing::at_rate(100) };
    let for_delay = certified(&Plant::equilibrium(), &Controller::from(&delayed), timing);
    let without = certified(&Plant::equilibrium(), &Controller::from(&plain), Timing::at_rate(100));
    assert_near(for_delay.sampled.spectral_radius, without.sampled.spectral_radius, 1e-6, "f32 gains");
    assert!(for_delay.continuous.is_none() && for_delay.delay_samples == 2);
    // The plain gain meets the same delay unprepared.
    let unprepared = certified(&Plant::equilibrium(), &Controller::from(&plain), timing);
    let alpha = |certificate: &Certificate| certificate.sampled.margins.all.balanced.alpha;
    assert!(alpha(&unprepared) < alpha(&for_delay), "{} {}", alpha(&unprepared), alpha(&for_delay));
    // The rest of its delay limit is the whole limit less the two samples.
    let (left_s, had_s) = (unprepared.delay.last().expect("all"), without.delay.last().expect("all"));
    assert!((left_s.stable_to_s + 0.02 - had_s.stable_to_s).abs() < 1e-8, "{left_s:?} {had_s:?}");
}

#[test]
fn integral_gains_are_certified_with_the_sums_in_the_loop() {
    let weights = IntegralWeights { equilibrium: EquilibriumWeights::paper(), integral: [50.0; 3] };
    let design = sampled_lqi(&weights, &Sampling::at_rate(100)).expect("solvable");
    let certificate = certified(&Plant::equilibrium_with_integral(), &Controller::from(&design), Timing::at_rate(100));
    assert_eq!(certificate.sampled.poles.len(), 12);
    let radius = design.poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    assert_near(certificate.sampled.spectral_radius, radius, 1e-6, "f32 gains");
    let error = certify(&Plant::equilibrium(), &Controller::from(&design), &Timing::at_rate(100), None);
    assert_eq!(error.expect_err("12 columns").to_string(), "K is 4x12; it must be 4x9 to fit the plant");
}

#[test]
fn a_design_below_its_own_minimum_is_refused_with_the_figure() {
    let certificate = certified(&Plant::equilibrium(), &lqr_e(), Timing::at_rate(100));
    let enough = Minimum {
        disk_each: Some(0.9),
        disk_all: Some(0.9),
        gain_factor_all: Some(2.0),
        phase_all_rad: Some(0.8),
        delay_s: Some(0.015),
        lag_s: Some(0.05),
        decay_1_s: Some(1.4),
        ..Minimum::default()
    };
    require(&certificate, &enough).expect("meets it");
    let refused = require(&certificate, &Minimum { delay_s: Some(0.02), ..enough }).expect_err("17 ms");
    assert_eq!(refused.asked, 0.02);
    assert!((refused.found - 0.017_091).abs() < 1e-6);
    let told = refused.to_string();
    assert!(told.starts_with("largest delay of all channels at once is 17.09"), "{told}");
    assert!(told.ends_with(" ms; the design asks for at least 20 ms"), "{told}");
    let refused = require(&certificate, &Minimum { disk_each: Some(1.0), ..enough }).expect_err("thrust");
    assert_eq!(refused.figure, "disk margin of thrust_m_s2");
    assert!(require(&certificate, &Minimum { lag_s: Some(f64::NAN), ..enough }).is_err(), "NaN is not met");
}

#[test]
fn loops_that_cannot_be_certified_are_refused_by_name() {
    let plant = Plant::equilibrium();
    let refuse = |gain: DMatrix<f64>, timing: Timing| {
        let error = certify(&plant, &Controller::memoryless(gain), &timing, None).expect_err("unusable");
        assert!(!error.to_string().contains('\n'), "{error}");
        error
    };
    let gain = lqr_e().gain;
    // At 10 Hz the thrust alone has k h = 7.
    let error = refuse(gain.clone(), Timing::at_rate(10));
    assert!(matches!(error, CertifyError::Unstable { spectral_radius, .. } if spectral_radius > 1.0), "{error}");
    assert!(matches!(refuse(DMatrix::zeros(4, 9), Timing::at_rate(100)), CertifyError::Unstable { .. }), "marginal");
    assert_eq!(
        refuse(DMatrix::zeros(4, 8), Timing::at_rate(100)).to_string(),
        "K is 4x8; it must be 4x9 to fit the plant"
    );
    let mut broken = gain.clone();
    broken[(1, 3)] = f64::NAN;
    assert_eq!(refuse(broken.clone(), Timing::at_rate(100)).to_string(), "K[1,3] is NaN; every entry must be finite");
    broken[(1, 3)] = 1e39;
    assert!(matches!(refuse(broken, Timing::at_rate(100)), CertifyError::NotSinglePrecision { row: 1, column: 3, .. }));
    let error = refuse(gain.clone(), Timing { period_s: 0.0, delay_samples: 0 });
    assert_eq!(error.to_string(), "the control period is 0 s; certificates are made for periods from 1e-5 s to 10 s");
    assert!(matches!(
        refuse(gain.clone(), Timing { period_s: f64::NAN, delay_samples: 0 }),
        CertifyError::Period { .. }
    ));
    let error = refuse(gain, Timing { period_s: 0.01, delay_samples: 1_000_000 });
    assert!(matches!(error, CertifyError::DelaySamples { delay_samples: 1_000_000 }));
    let error = certify(&plant, &lqr_e(), &Timing::at_rate(100), Some(-1.0)).expect_err("rate gain");
    assert!(matches!(error, CertifyError::RateGain { .. }));
}
