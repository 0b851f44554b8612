//! Correlation, gain and turning of signals on a grid.

use nalgebra::{UnitQuaternion, Vector3};

use super::STEP_S;

/// Over the points that are good.
pub(super) fn correlation(good: &[usize], a: &[f64], b: &[f64]) -> f64 {
    let mean = |x: &[f64]| good.iter().map(|i| x[*i]).sum::<f64>() / good.len().max(1) as f64;
    let (a_mean, b_mean) = (mean(a), mean(b));
    let sum = |f: &dyn Fn(usize) -> f64| good.iter().map(|i| f(*i)).sum::<f64>();
    let ab = sum(&|i| (a[i] - a_mean) * (b[i] - b_mean));
    let (aa, bb) = (sum(&|i| (a[i] - a_mean).powi(2)), sum(&|i| (b[i] - b_mean).powi(2)));
    ab / (aa * bb).sqrt().max(1e-12)
}

/// How many times the other a signal is, means taken off, over the points that are good.
pub(super) fn gain(good: &[usize], a: &[f64], b: &[f64]) -> f64 {
    let mean = |x: &[f64]| good.iter().map(|i| x[*i]).sum::<f64>() / good.len().max(1) as f64;
    let (a_mean, b_mean) = (mean(a), mean(b));
    let (mut ab, mut bb) = (0.0, 0.0);
    for i in good {
        ab += (a[*i] - a_mean) * (b[*i] - b_mean);
        bb += (b[*i] - b_mean).powi(2);
    }
    ab / bb.max(1e-12)
}

/// Body rates that an attitude turns by, rad/s.
pub(super) fn turning(attitude: &[UnitQuaternion<f64>]) -> Vec<Vector3<f64>> {
    let n = attitude.len();
    (0..n)
        .map(|i| {
            let (low, high) = (i.saturating_sub(1), (i + 1).min(n - 1));
            let span_s = (high - low).max(1) as f64 * STEP_S;
            (attitude[low].inverse() * attitude[high]).scaled_axis() / span_s
        })
        .collect()
}

/// One axis of a series of vectors.
pub(super) fn channel(vectors: &[Vector3<f64>], axis: usize) -> Vec<f64> {
    vectors.iter().map(|v| v[axis]).collect()
}
