//! Filters of signals on an even grid: low-pass without phase, derivative, fractional shift, first-order lag.

use std::f64::consts::{PI, SQRT_2};

/// Butterworth's second-order low-pass, forwards and backwards: no phase, half of the power twice at the corner.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LowPass {
    b: [f64; 3],
    a: [f64; 2],
}

impl LowPass {
    /// With its corner, by the bilinear transform.
    pub(crate) fn new(corner_hz: f64, rate_hz: f64) -> Self {
        let k = (PI * (corner_hz / rate_hz).min(0.45)).tan();
        let norm = 1.0 / (1.0 + SQRT_2 * k + k * k);
        let b0 = k * k * norm;
        Self { b: [b0, 2.0 * b0, b0], a: [2.0 * (k * k - 1.0) * norm, (1.0 - SQRT_2 * k + k * k) * norm] }
    }

    /// Forwards and backwards; each pass begins as if its first value had always been there.
    pub(crate) fn both_ways(&self, signal: &[f64]) -> Vec<f64> {
        let mut out = self.pass(signal.iter().copied());
        out.reverse();
        out = self.pass(out.into_iter());
        out.reverse();
        out
    }

    fn pass(&self, signal: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut state: Option<[f64; 2]> = None;
        let [b0, b1, b2] = self.b;
        let [a1, a2] = self.a;
        signal
            .map(|x| {
                // At rest with gain 1: y = x, s2 = (b2 - a2) x, s1 = (b1 - a1) x + s2.
                let [s1, s2] = state.unwrap_or([(b1 - a1 + b2 - a2) * x, (b2 - a2) * x]);
                let y = b0 * x + s1;
                state = Some([b1 * x - a1 * y + s2, b2 * x - a2 * y]);
                y
            })
            .collect()
    }
}

/// Derivative by five points, good to the fourth order; one-sided at the ends.
pub(crate) fn derivative(signal: &[f64], step_s: f64) -> Vec<f64> {
    let n = signal.len();
    let at = |i: usize| signal[i.min(n - 1)];
    (0..n)
        .map(|i| {
            if i >= 2 && i + 2 < n {
                (-at(i + 2) + 8.0 * at(i + 1) - 8.0 * at(i - 1) + at(i - 2)) / (12.0 * step_s)
            } else {
                let (low, high) = (i.saturating_sub(1), (i + 1).min(n - 1));
                if high > low { (at(high) - at(low)) / ((high - low) as f64 * step_s) } else { 0.0 }
            }
        })
        .collect()
}

/// The value at every point of the grid plus a shift in steps, linear in between, held beyond the ends.
pub(crate) fn shifted(signal: &[f64], steps: f64) -> Vec<f64> {
    let last = signal.len().saturating_sub(1);
    (0..signal.len())
        .map(|i| {
            let place = (i as f64 + steps).clamp(0.0, last as f64);
            let below = (place as usize).min(last);
            let share = place - below as f64;
            signal[below] + share * (signal[(below + 1).min(last)] - signal[below])
        })
        .collect()
}

/// The same by the cubic through the four nearest points, which keeps frequencies below a quarter of the rate.
pub(crate) fn shifted_smoothly(signal: &[f64], steps: f64) -> Vec<f64> {
    let last = signal.len().saturating_sub(1) as isize;
    let whole = steps.floor();
    let s = steps - whole;
    // Lagrange's, at -1, 0, 1 and 2.
    let weights = [
        -s * (s - 1.0) * (s - 2.0) / 6.0,
        (s + 1.0) * (s - 1.0) * (s - 2.0) / 2.0,
        -(s + 1.0) * s * (s - 2.0) / 2.0,
        (s + 1.0) * s * (s - 1.0) / 6.0,
    ];
    let at = |i: isize| signal[i.clamp(0, last) as usize];
    let sum = |v: [f64; 4]| weights[0] * v[0] + weights[1] * v[1] + weights[2] * v[2] + weights[3] * v[3];
    let first = whole as isize - 1;
    (0..signal.len() as isize)
        .map(|i| {
            let from = i + first;
            let inside = usize::try_from(from).ok().and_then(|from| signal.get(from..from + 4)?.as_array::<4>());
            sum(inside.copied().unwrap_or_else(|| [0, 1, 2, 3].map(|k| at(from + k))))
        })
        .collect()
}

/// First-order lag of a signal that is linear between the points of the grid, with a time constant while it grows and one
/// while it falls, s; exact for equal ones. It begins where the signal does.
pub(crate) fn lagged(signal: &[f64], rise_s: f64, fall_s: f64, step_s: f64) -> Vec<f64> {
    let gains = |lag_s: f64| {
        let lag_s = lag_s.max(1e-5);
        let kept = (-step_s / lag_s).exp();
        (kept, 1.0 - (1.0 - kept) * lag_s / step_s)
    };
    let (rise, fall) = (gains(rise_s), gains(fall_s));
    let mut value = signal.first().copied().unwrap_or(0.0);
    let mut before = value;
    signal
        .iter()
        .map(|&now| {
            let (kept, late) = if 0.5 * (before + now) >= value { rise } else { fall };
            value = kept * value + (1.0 - kept) * before + late * (now - before);
            before = now;
            value
        })
        .collect()
}

/// Mean of a signal.
pub(crate) fn mean(signal: &[f64]) -> f64 {
    signal.iter().sum::<f64>() / signal.len().max(1) as f64
}

/// Median; 0 of nothing.
pub(crate) fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// Quantile by linear interpolation; 0 of nothing.
pub(crate) fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    if sorted.is_empty() {
        return 0.0;
    }
    sorted.sort_by(f64::total_cmp);
    let place = share * (sorted.len() - 1) as f64;
    let below = place as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_low_pass_halves_the_amplitude_at_its_corner_and_keeps_the_phase() {
        let filter = LowPass::new(6.0, 100.0);
        let wave = |hz: f64| -> Vec<f64> { (0..4000).map(|i| (2.0 * PI * hz * 0.01 * f64::from(i)).sin()).collect() };
        let gain = |hz: f64| {
            let (x, y) = (wave(hz), filter.both_ways(&wave(hz)));
            let inner = 500..3500;
            let dot: f64 = inner.clone().map(|i| x[i] * y[i]).sum();
            dot / inner.map(|i| x[i] * x[i]).sum::<f64>()
        };
        // Twice -3 dB, in phase.
        assert!((gain(6.0) - 0.5).abs() < 1e-3, "{}", gain(6.0));
        assert!((gain(0.5) - 1.0).abs() < 1e-3 && gain(30.0) < 1e-2);
        assert!(filter.both_ways(&[3.0; 50]).iter().all(|v| (v - 3.0).abs() < 1e-12));
    }

    #[test]
    fn a_lagged_ramp_is_late_by_the_lag() {
        let ramp: Vec<f64> = (0..400).map(|i| 0.02 * f64::from(i)).collect();
        let out = lagged(&ramp, 0.067, 0.067, 0.01);
        // 2/s times 67 ms.
        assert!((ramp[399] - out[399] - 2.0 * 0.067).abs() < 1e-9);
        let step: Vec<f64> = (0..100).map(|i| f64::from(u8::from(i > 0))).collect();
        let up = lagged(&step, 0.03, 0.05, 0.01);
        let down = lagged(&step.iter().map(|v| 1.0 - v).collect::<Vec<_>>(), 0.03, 0.05, 0.01);
        assert!(up[10] > 1.0 - down[10], "the rise is the faster one");
    }

    #[test]
    fn derivative_and_shift_are_exact_where_they_can_be() {
        let cubic: Vec<f64> = (0..50).map(|i| (0.01 * f64::from(i)).powi(3)).collect();
        let slope = derivative(&cubic, 0.01);
        assert!((slope[25] - 3.0 * 0.25 * 0.25).abs() < 1e-12);
        let line: Vec<f64> = (0..50).map(f64::from).collect();
        assert!((shifted(&line, 0.3)[10] - 10.3).abs() < 1e-12);
        assert_eq!(quantile(&[3.0, 1.0, 2.0], 0.5), 2.0);
    }
}
