//! The shift between the on-board streams and the pose: gyroscope against the turning of the attitude, on a fine grid.

use nalgebra::{UnitQuaternion, Vector3};

use super::grid::Grid;
use super::signals::{channel, turning};
use super::{RATE_HZ, STEP_S};
use crate::filter::{LowPass, mean, shifted};

/// Longest shift that is looked for, s: those of NanoBench are -50 to +90 ms.
const LONGEST_S: f64 = 0.15;
/// Step of the fine grid, s.
const FINE_S: f64 = 0.001;
/// Corner frequency of the compared signals, Hz.
const CORNER_HZ: f64 = 6.0;

/// By how much the pose comes later than the on-board streams, s: `gyro(t)` is the attitude's rate of turn at `t +
/// shift`.
pub(super) fn pose_shift_s(grid: &Grid, flying: &[bool]) -> f64 {
    let low = LowPass::new(CORNER_HZ, RATE_HZ);
    let turned = turning(&grid.attitude);
    let signals: Vec<(Vec<f64>, Vec<f64>)> = (0..2)
        .map(|axis| (low.both_ways(&channel(&grid.gyro, axis)), low.both_ways(&channel(&turned, axis))))
        .collect();
    let margin = (LONGEST_S / STEP_S) as usize + 1;
    let inner: Vec<usize> = (margin..grid.len().saturating_sub(margin)).filter(|i| flying[*i]).collect();
    let misfit = |shift_s: f64| -> f64 {
        signals
            .iter()
            .map(|(own, turn)| {
                let turn = shifted(turn, shift_s / STEP_S);
                let rest: Vec<f64> = inner.iter().map(|i| own[*i] - turn[*i]).collect();
                let offset = mean(&rest);
                rest.iter().map(|r| (r - offset).powi(2)).sum::<f64>()
            })
            .sum()
    };
    let coarse =
        (-15..=15).map(|k| 0.01 * f64::from(k)).min_by(|a, b| misfit(*a).total_cmp(&misfit(*b))).unwrap_or(0.0);
    (-10..=10)
        .map(|k| coarse + FINE_S * f64::from(k))
        .min_by(|a, b| misfit(*a).total_cmp(&misfit(*b)))
        .unwrap_or(coarse)
}

/// Vectors at every time plus a shift.
pub(super) fn moved(vectors: &[Vector3<f64>], shift_s: f64) -> Vec<Vector3<f64>> {
    let axes = [0, 1, 2].map(|axis| shifted(&channel(vectors, axis), shift_s / STEP_S));
    (0..vectors.len()).map(|i| Vector3::new(axes[0][i], axes[1][i], axes[2][i])).collect()
}

/// Attitudes likewise.
pub(super) fn turned(attitude: &[UnitQuaternion<f64>], shift_s: f64) -> Vec<UnitQuaternion<f64>> {
    let last = attitude.len().saturating_sub(1);
    (0..attitude.len())
        .map(|i| {
            let place = (i as f64 + shift_s / STEP_S).clamp(0.0, last as f64);
            let below = (place as usize).min(last);
            attitude[below].nlerp(&attitude[(below + 1).min(last)], place - below as f64)
        })
        .collect()
}
