//! Certificates against closed forms, another tool's margins and the motion itself.

use nalgebra::{Complex, DMatrix, DVector, SMatrix};
use quatrack_design::certify::{Certificate, Controller, Plant, Timing, certify, structured_bounds};
use quatrack_design::design::synthesis::{EquilibriumWeights, FlatWeights, lqr_equilibrium, lqr_flat};

fn matrix(rows: usize, columns: usize, entries: &[f64]) -> DMatrix<f64> {
    DMatrix::from_row_slice(rows, columns, entries)
}

pub(super) fn dense<const M: usize, const N: usize>(gain: &SMatrix<f64, M, N>) -> Controller {
    Controller::memoryless(DMatrix::from_column_slice(M, N, gain.as_slice()))
}

pub(super) fn lqr_e() -> Controller {
    dense(&lqr_equilibrium(&EquilibriumWeights::paper()).expect("solvable").gain)
}

pub(super) fn certified(plant: &Plant, controller: &Controller, timing: Timing) -> Certificate {
    certify(plant, controller, &timing, None).expect("stable")
}

pub(super) fn assert_near(got: f64, want: f64, tolerance: f64, figure: &str) {
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
