//! Variance, correlation and spectrum of the filters against the standard's formulas, and its scales at low altitude.

use super::super::random::Source;
use super::*;

const PERIOD_S: f64 = 0.002;

fn dryden() -> Dryden {
    Dryden { rms_m_s: Vector3::new(0.5, 0.4, 0.3), scale_m: Vector3::new(1.0, 1.4, 0.6), airspeed_m_s: 4.0 }
}

fn run(dryden: &Dryden, seed: u64, samples: usize) -> Vec<Vector3<f64>> {
    let mut filters = Turbulence::new(dryden, PERIOD_S, Stream::new(seed, Source::Turbulence));
    (0..samples).map(|_| filters.next()).collect()
}

#[test]
fn the_correlation_is_that_of_the_continuous_filters() {
    // 400 independent runs: the product of two samples that lie apart has a deviation of at most sqrt(2) variances.
    let dryden = dryden();
    let memory_s = dryden.memory_s();
    let runs: Vec<_> = (0..4000).map(|seed| run(&dryden, seed, 126)).collect();
    for lag in [0_usize, 25, 125] {
        let time_s = lag as f64 * PERIOD_S;
        for axis in 0..3 {
            let (variance, a) = (dryden.rms_m_s[axis].powi(2), time_s / memory_s[axis]);
            let expected = variance * (-a).exp() * if axis == 0 { 1.0 } else { 1.0 - 0.5 * a };
            let found = runs.iter().map(|x| x[0][axis] * x[lag][axis]).sum::<f64>() / 4000.0;
            // Four deviations: true in all but one of 16,000 such sums.
            let bound = 4.0 * variance * (2.0 / 4000.0_f64).sqrt();
            assert!((found - expected).abs() < bound, "axis {axis}, lag {lag}: {found} {expected} +- {bound}");
        }
    }
}

#[test]
fn the_spectrum_is_the_standard_s() {
    let dryden = dryden();
    // The Fourier coefficient of each of 800 pieces of 8 s at a frequency, with a Hann window. Their squares are
    // exponentially distributed; the mean of 800 has a deviation of 1/sqrt(800) = 3.5 %.
    let (pieces, length) = (800_usize, 4000_usize);
    let window: Vec<f64> =
        (0..length).map(|k| 0.5 - 0.5 * (std::f64::consts::TAU * k as f64 / length as f64).cos()).collect();
    let power: f64 = window.iter().map(|w| w * w).sum();
    let samples = run(&dryden, 11, pieces * length);
    for frequency_hz in [0.5, 1.0, 2.0, 4.0, 8.0, 16.0] {
        let turns = std::f64::consts::TAU * frequency_hz * PERIOD_S;
        let carrier: Vec<[f64; 2]> = (0..length)
            .map(|k| {
                let (sine, cosine) = (turns * k as f64).sin_cos();
                [window[k] * cosine, window[k] * sine]
            })
            .collect();
        for axis in 0..3 {
            let found = samples
                .chunks_exact(length)
                .map(|piece| {
                    let (mut real, mut imaginary) = (0.0, 0.0);
                    for (x, [cosine, sine]) in piece.iter().zip(&carrier) {
                        real += x[axis] * cosine;
                        imaginary += x[axis] * sine;
                    }
                    real * real + imaginary * imaginary
                })
                .sum::<f64>()
                / pieces as f64
                * 2.0
                * PERIOD_S
                / power;
            let ratio = found / dryden.density(frequency_hz)[axis];
            // 99.9 % of 18 such ratios at once lie within 4.2 deviations: 15 %. The window's breadth of 0.19 Hz and the
            // sampling add less than 3 %.
            assert!((ratio - 1.0).abs() < 0.18, "axis {axis} at {frequency_hz} Hz: {ratio}");
        }
    }
}

#[test]
fn the_density_holds_the_variance() {
    let dryden = dryden();
    // Trapezium over a logarithmic grid from 1e-5 to 1e5 Hz; outside lies less than 1e-4 of it.
    let at = |k: i32| 10.0_f64.powf(-5.0 + f64::from(k) * 0.001);
    for axis in 0..3 {
        let integral: f64 = (0..10_000)
            .map(|k| 0.5 * (dryden.density(at(k)) + dryden.density(at(k + 1)))[axis] * (at(k + 1) - at(k)))
            .sum();
        let variance = dryden.rms_m_s[axis].powi(2);
        assert!((integral / variance - 1.0).abs() < 3e-4, "{axis}: {integral} {variance}");
    }
}

#[test]
fn scales_at_low_altitude_are_the_standard_s() {
    let at_100_ft = Dryden::at_low_altitude(Vector3::repeat(0.5), 30.48, 3.0);
    // 100 / 0.2593^1.2 ft and 100 ft.
    assert!((at_100_ft.scale_m.x - 30.48 / 0.2593_f64.powf(1.2)).abs() < 1e-9);
    assert!((at_100_ft.scale_m.z - 30.48).abs() < 1e-12);
    // Below 10 ft there is nothing to be had but the value there.
    let low = Dryden::at_low_altitude(Vector3::repeat(0.5), 1.0, 0.0);
    assert!((low.scale_m.z - 3.048).abs() < 1e-12);
    // W_20 = 5 m/s, at 10 ft 5 ln(66.7) / ln(133.3) = 4.29 m/s.
    assert!((low.airspeed_m_s - 5.0 * (10.0_f64 / 0.15).ln() / (20.0_f64 / 0.15).ln()).abs() < 1e-12);
}
