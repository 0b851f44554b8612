//! Certificates against closed forms, another tool's margins and the motion itself.

use nalgebra::{Complex, DMatrix, DVector, SMatrix};
use quatrack_design::certify::{
    Certificate, CertifyError, Controller, Minimum, Plant, Timing, certify, require, structured_bounds,
};
use quatrack_design::design::integral::{IntegralWeights, sampled_lqi};
use quatrack_design::design::sampled::{Sampling, sampled_equilibrium};
use quatrack_design::design::synthesis::{
    EquilibriumWeights, FlatWeights, PAPER_MU, lqr_equilibrium, lqr_flat, lyapunov_equilibrium, lyapunov_flat,
};

fn matrix(rows: usize, columns: usize, entries: &[f64]) -> DMatrix<f64> {
    DMatrix::from_row_slice(rows, columns, entries)
}

fn dense<const M: usize, const N: usize>(gain: &SMatrix<f64, M, N>) -> Controller {
    Controller::memoryless(DMatrix::from_column_slice(M, N, gain.as_slice()))
}

fn lqr_e() -> Controller {
    dense(&lqr_equilibrium(&EquilibriumWeights::paper()).expect("solvable").gain)
}

fn certified(plant: &Plant, controller: &Controller, timing: Timing) -> Certificate {
    certify(plant, controller, &timing, None).expect("stable")
}

fn assert_near(got: f64, want: f64, tolerance: f64, figure: &str) {
    assert!((got - want).abs() <= tolerance * want.abs(), "{figure}: {got} is not {want}");
}

#[test]
fn one_integrator_has_the_margins_of_its_closed_form() {
    // x' = u, u = -12 x at 8 Hz: z = 1 - k h, S = (z - 1) / (z - 1 + k h), worst at z = -1.
    let plant = Plant::new(matrix(1, 1, &[0.0]), matrix(1, 1, &[1.0])).expect("a pair");
    let timing = Timing { period_s: 0.125, delay_samples: 0 };
    let (k, kh) = (12.0, 1.5);
    let certificate = certified(&plant, &Controller::memoryless(matrix(1, 1, &[k])), timing);
    // Sums of a few exact numbers.
    assert_near(certificate.sampled.spectral_radius, kh - 1.0, 1e-14, "|1 - k h|");
    let margins = &certificate.sampled.margins.each[0];
    assert_near(margins.sensitivity.alpha, (2.0 - kh) / 2.0, 1e-12, "1 / |S(-1)|");
    assert_near(margins.balanced.alpha, 2.0 * (2.0 - kh) / (2.0 + kh), 1e-12, "1 / |S(-1) - 1/2|");
    // The classical gain margin, 2 / (k h), is at z = -1 too: there the disk touches it.
    assert_near(margins.sensitivity.gain_max.expect("bounded"), 2.0 / kh, 1e-12, "gain margin");
    assert_near(margins.balanced.gain_max.expect("bounded"), 2.0 / kh, 1e-12, "gain margin");
    assert_near(margins.balanced.critical_rad_s.expect("Nyquist"), std::f64::consts::PI / 0.125, 1e-12, "Nyquist");
    // A delay phi below h: z^2 - (1 - k (h - phi)) z + k phi, stable while k phi < 1.
    let delay = &certificate.delay[0];
    assert_near(delay.stable_to_s, 1.0 / k, 1e-8, "1 / k");
    assert!(delay.resolution_s.expect("found") < 1e-9);
    // In continuous time the loop is a first-order lag: any gain, 90 degrees.
    let continuous = &certificate.continuous.as_ref().expect("no delay").margins.as_ref().expect("stable").each[0];
    assert!(continuous.balanced.gain_max.is_none() && continuous.balanced.gain_min == 0.0);
    assert_near(continuous.balanced.phase_rad, std::f64::consts::FRAC_PI_2, 1e-9, "90 degrees");
    assert_eq!(continuous.balanced.critical_rad_s, None, "no frequency is critical");
    // 12 is an f32.
    assert_eq!(certificate.rounding.largest_absolute, 0.0);
    assert!(certificate.sampled.decrease.holds);
}

#[test]
fn linear_quadratic_loops_stand_half_to_any_gain_and_sixty_degrees() {
    // |1 + L| >= 1 at every frequency for a weight of the input that is diagonal (Kalman 1964; Safonov and Athans 1977).
    let flat = dense(&lqr_flat(&FlatWeights::paper()).expect("solvable").gain);
    for (plant, controller) in [(Plant::equilibrium(), lqr_e()), (Plant::flat_chain(), flat)] {
        let certificate = certified(&plant, &controller, Timing::at_rate(500));
        let continuous = certificate.continuous.expect("no delay");
        assert!(continuous.decrease.expect("stable").holds);
        for margins in continuous.margins.expect("stable").each {
            // The gain was rounded to 6e-8 of itself.
            let disk = margins.sensitivity;
            assert_near(disk.alpha, 1.0, 1e-6, &margins.channel);
            assert_near(disk.gain_min, 0.5, 1e-6, &margins.channel);
            assert!(disk.gain_max.is_none_or(|gain| gain > 1e5), "{}: {:?}", margins.channel, disk.gain_max);
            assert_near(disk.phase_rad, std::f64::consts::FRAC_PI_3, 1e-6, &margins.channel);
        }
    }
}

#[test]
fn the_spinning_satellite_is_robust_loop_by_loop_and_fragile_at_once() {
    // Doyle's example (Zhou, Doyle and Glover 1996, section 9.6): A = [0 a; -a 0], B = I, K = [1 a; -a 1], a = 10.
    let a = 10.0_f64;
    let plant = Plant::new(matrix(2, 2, &[0.0, a, -a, 0.0]), DMatrix::identity(2, 2)).expect("a pair");
    let controller = Controller::memoryless(matrix(2, 2, &[1.0, a, -a, 1.0]));
    let certificate = certified(&plant, &controller, Timing::at_rate(10_000));
    let margins = certificate.continuous.expect("no delay").margins.expect("stable");
    for channel in &margins.each {
        // One loop opened with the other closed: S = s / (s + 1).
        assert_near(channel.balanced.alpha, 2.0, 1e-9, "no limit of gain");
        assert_near(channel.balanced.phase_rad, std::f64::consts::FRAC_PI_2, 1e-9, "90 degrees");
    }
    // S - I/2 is normal with the eigenvalues ((s - 1)/2 +- j a) / (s + 1), largest where w^2 + 2 a w = 1.
    let frequency = (a * a + 1.0).sqrt() - a;
    let peak = ((0.25 + (0.5 * frequency + a).powi(2)) / (1.0 + frequency * frequency)).sqrt();
    assert_near(margins.all.balanced.alpha, 1.0 / peak, 1e-9, "both at once");
    assert_near(margins.all.balanced.critical_rad_s.expect("finite"), frequency, 1e-5, "where");
    // Two channels: the bounds meet.
    assert_near(margins.all.alpha_at_most, 1.0 / peak, 1e-9, "lower bound of mu");
}

#[test]
fn structured_bounds_are_those_of_slicot() {
    let m = DMatrix::from_row_slice(
        4,
        4,
        &[
            Complex::new(1.0, 2.0),
            Complex::new(0.5, -1.0),
            Complex::new(0.0, 0.25),
            Complex::new(-0.75, 0.0),
            Complex::new(2.0, -0.5),
            Complex::new(-1.0, 1.0),
            Complex::new(0.5, 0.0),
            Complex::new(0.0, 1.5),
            Complex::new(-0.25, 0.25),
            Complex::new(3.0, 0.0),
            Complex::new(0.5, -2.0),
            Complex::new(1.0, 0.0),
            Complex::new(0.0, 0.1),
            Complex::new(-1.0, -1.0),
            Complex::new(2.0, 0.0),
            Complex::new(0.75, 0.5),
        ],
    );
    // AB13MD (slycot 0.7.1), which stops at about 1e-4.
    for (size, slicot) in [(4, 4.441_136_6), (3, 3.654_613_3)] {
        let bounds = structured_bounds(&m.view((0, 0), (size, size)).into_owned()).expect("finite");
        assert_near(bounds.upper, slicot, 2e-4, "upper");
        assert!(bounds.lower <= bounds.upper, "{bounds:?}");
        // Up to three channels the best scaling closes the gap; with four it does here.
        assert_near(bounds.lower, bounds.upper, 1e-4, "gap");
    }
    assert!(structured_bounds(&m.rows(0, 2).into_owned()).is_none(), "not square");
}

#[test]
fn margins_of_a_coupled_plant_are_those_of_python_control() {
    let plant = Plant::new(
        matrix(4, 4, &[0.0, 1.0, 0.0, 0.5, -2.0, -0.5, 1.0, 0.0, 0.25, 0.0, 0.5, 1.0, 0.0, -1.0, 0.0, -1.5]),
        matrix(4, 3, &[0.0, 0.5, 0.0, 1.0, 0.0, 0.25, 0.0, 1.0, 0.0, 0.5, 0.0, 1.0]),
    )
    .expect("a pair");
    let gain = matrix(
        3,
        4,
        &[
            0.703_125, 1.109_375, -0.25, 0.0625, 0.953_125, -0.140_625, 2.531_25, 0.6875, 0.203_125, 0.0625, 0.0625,
            0.203_125,
        ],
    );
    let certificate = certified(&plant, &Controller::memoryless(gain), Timing { period_s: 0.05, delay_samples: 0 });
    // python-control 0.10.2, disk_margins on 20,001 frequencies; it sweeps a grid and reads mu from AB13MD.
    let tolerance = 3e-4;
    let continuous = certificate.continuous.expect("no delay").margins.expect("stable");
    assert_near(continuous.all.balanced.alpha, 1.429_653, tolerance, "all, continuous");
    for (margins, want) in continuous.each.iter().zip([1.999_922, 1.490_668, 2.0]) {
        assert_near(margins.balanced.alpha, want, tolerance, &margins.channel);
    }
    let sampled = &certificate.sampled.margins;
    assert_near(sampled.all.balanced.alpha, 1.386_027, tolerance, "all, sampled");
    assert!(sampled.all.alpha_at_most >= sampled.all.balanced.alpha * (1.0 - 1e-12));
    // Three channels: the bounds meet.
    assert_near(sampled.all.alpha_at_most, sampled.all.balanced.alpha, 1e-3, "gap");
    let want = [(1.888_491, 0.971_422), (1.452_382, 0.924_727), (1.977_820, 0.994_424)];
    for (margins, (balanced, sensitivity)) in sampled.each.iter().zip(want) {
        assert_near(margins.balanced.alpha, balanced, tolerance, &margins.channel);
        assert_near(margins.sensitivity.alpha, sensitivity, tolerance, &margins.channel);
    }
}

/// Growth of the error from the second to the third third of a simulated flight of `duration_s`: below 1 is stable.
///
/// `x' = A x + B v`, v the command `delay_s` ago behind a first-order lag, integrated by Runge and Kutta's method in steps
/// of 50 us; nothing is discretised but the command.
fn growth(
    plant: (&DMatrix<f64>, &DMatrix<f64>),
    gain: &DMatrix<f64>,
    period_us: u32,
    delay_us: u32,
    lag_s: f64,
) -> f64 {
    let (a, b) = plant;
    let step_us = 50;
    let steps = 12_000_000 / step_us;
    let mut x = DVector::from_element(a.nrows(), 0.1);
    let mut v = DVector::zeros(b.ncols());
    let mut commands: Vec<DVector<f64>> = Vec::new();
    let (mut second, mut third) = (0.0_f64, 0.0_f64);
    for k in 0..steps {
        let now_us = k * step_us;
        if now_us % period_us == 0 {
            commands.push(-gain * &x);
        }
        let command = match now_us.checked_sub(delay_us) {
            Some(sent_us) => commands[(sent_us / period_us) as usize].clone(),
            None => DVector::zeros(b.ncols()),
        };
        let h = f64::from(step_us) * 1e-6;
        let rate = |x: &DVector<f64>, v: &DVector<f64>| {
            let driving = if lag_s > 0.0 { v } else { &command };
            let actuator = if lag_s > 0.0 { (&command - v) / lag_s } else { DVector::zeros(b.ncols()) };
            (a * x + b * driving, actuator)
        };
        let k1 = rate(&x, &v);
        let k2 = rate(&(&x + &k1.0 * (h / 2.0)), &(&v + &k1.1 * (h / 2.0)));
        let k3 = rate(&(&x + &k2.0 * (h / 2.0)), &(&v + &k2.1 * (h / 2.0)));
        let k4 = rate(&(&x + &k3.0 * h), &(&v + &k3.1 * h));
        x += (k1.0 + k2.0 * 2.0 + k3.0 * 2.0 + k4.0) * (h / 6.0);
        v += (k1.1 + k2.1 * 2.0 + k3.1 * 2.0 + k4.1) * (h / 6.0);
        if 3 * k > 2 * steps {
            third = third.max(x.norm());
        } else if 3 * k > steps {
            second = second.max(x.norm());
        }
    }
    third / second
}

#[test]
fn the_motion_decays_just_inside_the_limits_and_grows_just_outside() {
    // Roll of LQR-E at 100 Hz: y, vy and q1, by hand.
    let a = matrix(3, 3, &[0.0, 1.0, 0.0, 0.0, 0.0, -19.62, 0.0, 0.0, 0.0]);
    let b = matrix(3, 1, &[0.0, 0.0, 0.5]);
    let whole = lqr_e().gain;
    let gain = matrix(1, 3, &[whole[(1, 1)], whole[(1, 7)], whole[(1, 3)]]);
    let certificate = certified(&Plant::equilibrium(), &lqr_e(), Timing::at_rate(100));
    let of_roll = |limits: &[quatrack_design::certify::StabilityLimit]| {
        limits.iter().find(|limit| limit.channels == "p_rad_s").expect("has the channel").stable_to_s
    };
    let delay_us = of_roll(&certificate.delay) * 1e6;
    let lag_s = of_roll(&certificate.lag);
    let flight = |delay_us: f64, lag_s: f64| {
        // A whole number of integration steps.
        growth((&a, &b), &gain, 10_000, (delay_us / 50.0).round() as u32 * 50, lag_s)
    };
    assert!(flight(0.98 * delay_us, 0.0) < 0.9, "decays within 4 s");
    assert!(flight(1.02 * delay_us, 0.0) > 1.1, "grows within 4 s");
    assert!(flight(0.0, 0.98 * lag_s) < 0.9);
    assert!(flight(0.0, 1.02 * lag_s) > 1.1);
}

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
