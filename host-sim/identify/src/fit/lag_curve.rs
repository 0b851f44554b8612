//! How much of the motors' torques a lag explains: the torque balance by least squares over a grid of lags.

use nalgebra::{Matrix3, Vector3};

use super::prior::Base;
use super::problem::{Drive, Prepared};

/// One lag of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LagPoint {
    /// s.
    pub lag_s: f64,
    /// Explained share of the mixture's variance about body x and y.
    pub explained: [f64; 2],
    /// Least-squares inertia, kg m^2 per N m of mixture.
    pub(super) inertia: [f64; 2],
    pub(super) moment: [f64; 2],
}

/// Lags of the grid, s.
pub(super) fn lags() -> impl Iterator<Item = f64> {
    (3..=40).map(|k| 0.005 * f64::from(k))
}

/// The point that explains most, of a curve that has one.
pub(super) fn most_explained(curve: &[LagPoint]) -> LagPoint {
    let explained = |point: &LagPoint| point.explained.iter().sum::<f64>();
    curve.iter().copied().max_by(|a, b| explained(a).total_cmp(&explained(b))).unwrap_or(curve[0])
}

/// The curve at a delay and the base's powers, of mixtures in units of a full command.
pub(super) fn lag_curve(sections: &[Prepared], base: &Base, delay_s: f64, powers: [f64; 2]) -> Vec<LagPoint> {
    // Damping of rates as far as physics has it; else it takes the place of the lag.
    let damping = 0.15 * base.damping_scale() / (0.25 * base.mass_kg * 16.0 * base.half_arm_m);
    lags()
        .map(|lag_s| {
            let driven: Vec<_> = sections
                .iter()
                .map(|one| one.drive(&Drive { rise_s: lag_s, fall_s: lag_s, delay_s, jump_s: 0.0, powers }))
                .collect();
            let mut point = LagPoint { lag_s, explained: [0.0; 2], inertia: [0.0; 2], moment: [0.0; 2] };
            for axis in 0..2 {
                let sign = if axis == 0 { -1.0 } else { 1.0 };
                let (mut matrix, mut right, mut whole) = (Matrix3::zeros(), Vector3::zeros(), 0.0);
                for (one, driven) in sections.iter().zip(&driven) {
                    let mixture = one.centred(&driven.mixture[axis]);
                    let angular = one.centred(&one.angular[axis]);
                    let across = one.centred(&one.velocity[1 - axis]);
                    let rates = one.centred(&one.rates[axis]);
                    for i in 0..mixture.len() {
                        let row = Vector3::new(angular[i], sign * across[i], 0.0);
                        let rest = mixture[i] - damping * rates[i];
                        matrix += row * row.transpose();
                        right += row * rest;
                        whole += rest * rest;
                    }
                }
                matrix[(2, 2)] = 1.0;
                let solution = matrix.lu().solve(&right).unwrap_or_default();
                point.explained[axis] = solution.dot(&right) / whole.max(1e-300);
                (point.inertia[axis], point.moment[axis]) = (solution.x, solution.y);
            }
            point
        })
        .collect()
}
