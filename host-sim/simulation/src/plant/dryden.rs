//! The turbulence of MIL-F-8785C (1980), section 3.7.2, in Dryden's form: intensities and scale lengths in, three components
//! of a wind on a grid of times out.
//!
//! The forming filters are continuous in time, driven by white noise, and discretised exactly: on the grid mean, variance and
//! correlation are the formula's, at any period. They start from the distribution that they stay in.

use nalgebra::{Vector2, Vector3};

use super::random::Stream;

/// Feet in a metre.
const FT_PER_M: f64 = 1.0 / 0.3048;
/// Below it the standard's model of low altitude gives no scale lengths, ft.
const LOWEST_FT: f64 = 10.0;
/// Above it the model of low altitude ends, ft.
const HIGHEST_FT: f64 = 1000.0;

/// Turbulence along the wind, across it and upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dryden {
    /// Root mean square of each component, m/s.
    pub rms_m_s: Vector3<f64>,
    /// Scale length of each, m.
    pub scale_m: Vector3<f64>,
    /// Speed at which the frozen pattern moves past the craft, m/s.
    pub airspeed_m_s: f64,
}

impl Dryden {
    /// At low altitude (MIL-F-8785C, 3.7.3.4): `L_w = h` and `L_u = L_v = h / (0.177 + 0.000823 h)^1.2`, h in feet, from 10
    /// to 1000 ft; the nearer end beyond them, where the standard says nothing. The pattern moves with the mean wind, and no
    /// slower than the wind at that height in which the standard has such turbulence: `sigma_w = 0.1 W_20`,
    /// `sigma_u = sigma_w / (0.177 + 0.000823 h)^0.4`, `W(h) = W_20 ln(h / 0.15 ft) / ln(20 / 0.15)`.
    pub fn at_low_altitude(rms_m_s: Vector3<f64>, altitude_m: f64, mean_wind_m_s: f64) -> Self {
        let h = (altitude_m * FT_PER_M).clamp(LOWEST_FT, HIGHEST_FT);
        let shape = 0.177 + 0.000_823 * h;
        let along_m = h / shape.powf(1.2) / FT_PER_M;
        let at_20_ft_m_s = 10.0 * (rms_m_s.x * shape.powf(0.4)).max(rms_m_s.z);
        let own_wind_m_s = at_20_ft_m_s * (h / 0.15).ln() / (20.0_f64 / 0.15).ln();
        Self {
            rms_m_s,
            scale_m: Vector3::new(along_m, along_m, h / FT_PER_M),
            airspeed_m_s: mean_wind_m_s.max(own_wind_m_s),
        }
    }

    /// Power spectral density of each component over the frequency in Hz, one-sided, (m/s)^2/Hz: the standard's `Phi(Omega)`
    /// with `Omega = 2 pi f / V`.
    pub fn density(&self, frequency_hz: f64) -> Vector3<f64> {
        let per_hz = std::f64::consts::TAU / self.airspeed_m_s;
        let reduced = self.scale_m * (frequency_hz * per_hz);
        let shape = |axis: usize| {
            let square = reduced[axis] * reduced[axis];
            if axis == 0 { 2.0 / (1.0 + square) } else { (1.0 + 3.0 * square) / ((1.0 + square) * (1.0 + square)) }
        };
        Vector3::from_fn(|axis, _| {
            let variance = self.rms_m_s[axis] * self.rms_m_s[axis];
            variance * self.scale_m[axis] / std::f64::consts::PI * shape(axis) * per_hz
        })
    }

    /// How long each component remembers, `L / V`, s.
    fn memory_s(&self) -> Vector3<f64> {
        self.scale_m / self.airspeed_m_s
    }
}

/// `sigma sqrt(2 T) / (1 + T s)`.
#[derive(Clone, Debug)]
struct FirstOrder {
    kept: f64,
    fresh: f64,
    state: f64,
}

impl FirstOrder {
    fn new(memory_s: f64, period_s: f64, stream: &mut Stream) -> Self {
        let kept = (-period_s / memory_s).exp();
        Self { kept, fresh: (-(-2.0 * period_s / memory_s).exp_m1()).sqrt(), state: stream.normal() }
    }

    fn next(&mut self, stream: &mut Stream) -> f64 {
        self.state = self.kept * self.state + self.fresh * stream.normal();
        self.state
    }
}

/// `sigma sqrt(T) (1 + sqrt(3) T s) / (1 + T s)^2` as two lags in a row: `T x_1' = -x_1 + n`, `T x_2' = -x_2 + x_1`, of which
/// it is `(sqrt(3) x_1 + (1 - sqrt(3)) x_2) / sqrt(2)`. With `E x_1^2 = 1` the stationary covariance is `[1 1/2; 1/2 1/2]`.
#[derive(Clone, Debug)]
struct SecondOrder {
    kept: f64,
    passed_on: f64,
    /// Lower triangular factor of the covariance that a period adds: 11, 21, 22.
    fresh: [f64; 3],
    state: Vector2<f64>,
}

impl SecondOrder {
    fn new(memory_s: f64, period_s: f64, stream: &mut Stream) -> Self {
        let a = period_s / memory_s;
        let kept = (-a).exp();
        // P - Phi P Phi', entry by entry: one minus the first one, two and three terms of the exponential series of 2 a,
        // times exp(-2 a).
        let (one, two, three) = (remainder(2.0 * a, 1), remainder(2.0 * a, 2), remainder(2.0 * a, 3));
        let first = one.sqrt();
        let second = 0.5 * two / first;
        let fresh = [first, second, (0.5 * three - second * second).max(0.0).sqrt()];
        let (x, y) = (stream.normal(), stream.normal());
        Self { kept, passed_on: kept * a, fresh, state: Vector2::new(x, 0.5 * x + 0.5 * y) }
    }

    fn next(&mut self, stream: &mut Stream) -> f64 {
        let (x, y) = (stream.normal(), stream.normal());
        let [first, second, third] = self.fresh;
        self.state = Vector2::new(
            self.kept * self.state.x + first * x,
            self.passed_on * self.state.x + self.kept * self.state.y + second * x + third * y,
        );
        let root = 3.0_f64.sqrt();
        (root * self.state.x + (1.0 - root) * self.state.y) * std::f64::consts::FRAC_1_SQRT_2
    }
}

/// `1 - exp(-z) (1 + z + .. )` with so many terms, which is `exp(-z) (z^n/n! + ..)`: free of cancellation.
fn remainder(z: f64, terms: u32) -> f64 {
    let mut term = (1..=terms).fold(1.0, |term, k| term * z / f64::from(k));
    let (mut sum, mut k) = (0.0, terms);
    while term > f64::EPSILON * sum && k < 1000 {
        sum += term;
        k += 1;
        term *= z / f64::from(k);
    }
    if k < 1000 { sum * (-z).exp() } else { 1.0 }
}

/// The filters at work.
#[derive(Clone, Debug)]
pub(super) struct Turbulence {
    rms_m_s: Vector3<f64>,
    along: FirstOrder,
    across: [SecondOrder; 2],
    stream: Stream,
}

impl Turbulence {
    pub(super) fn new(dryden: &Dryden, period_s: f64, mut stream: Stream) -> Self {
        let memory_s = dryden.memory_s();
        let along = FirstOrder::new(memory_s.x, period_s, &mut stream);
        let across = [memory_s.y, memory_s.z].map(|memory_s| SecondOrder::new(memory_s, period_s, &mut stream));
        Self { rms_m_s: dryden.rms_m_s, along, across, stream }
    }

    /// One period on: along, across, upwards, m/s.
    pub(super) fn next(&mut self) -> Vector3<f64> {
        let [across, up] = &mut self.across;
        let along = self.along.next(&mut self.stream);
        Vector3::new(along, across.next(&mut self.stream), up.next(&mut self.stream)).component_mul(&self.rms_m_s)
    }
}

#[cfg(test)]
mod tests;
