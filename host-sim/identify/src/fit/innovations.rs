//! Innovations of a Kalman filter that knows the figures: of the body rates with the accelerometer across them, about x
//! and about y, and of the accelerometer along the thrust. Figures and noise in; innovations with their covariance out.
//!
//! About x (about y alike): `J w' = M + c (v - a) - d w + b + n`, `f = -D (v - a) + l w' + y`, with the motors' mixture M, the velocity v
//! over ground, moving air a, a disturbing torque n and force y, which fade, and white noise on rate, gyroscope and accelerometer.
//! Along the thrust: `f = F m - D_z v_z + lift (v_x^2 + v_y^2) + n`. Constants of a section are taken as its mean.

use nalgebra::{DVector, Matrix1, Matrix2, Matrix2x4, Matrix4, Vector1, Vector2, Vector4};

use super::layout::{
    DAMPING, DRAG, DRAG_Z, FORCE_SHIFT, INERTIA, LEVER, LIFT, MOMENT, NOISE_Z, Noise, POSE_SHIFT, drive_of,
};
use super::prior::Base;
use super::problem::{Prepared, Thrusts};
use super::steady::Linear;
use crate::filter::{derivative, mean, shifted_smoothly};
use crate::flight::{RATE_HZ, STEP_S};

/// Balances: about x, about y, along the thrust.
pub(super) const KINDS: usize = 3;
/// Joined to the noise of each sensor, rad/s and m/s^2: between two samples the commands are not known better than that.
const RATE_LEAST: f64 = 2e-3;
const FORCE_LEAST: f64 = 2e-2;
/// Of a section, until the filter has forgotten how it began, s.
const SETTLED_S: f64 = 1.0;

/// Of one balance: innovations by section, and their covariance. The second component along the thrust is 0, of variance 1.
#[derive(Clone, Debug)]
pub(super) struct Innovations {
    pub(super) sections: Vec<Vec<[f64; 2]>>,
    pub(super) covariance: Matrix2<f64>,
}

impl Innovations {
    /// Minus the logarithm of their likelihood.
    pub(super) fn cost(&self) -> f64 {
        let Some(inverse) = self.covariance.try_inverse() else { return f64::INFINITY };
        let half_log = 0.5 * self.covariance.determinant().ln();
        self.sections
            .iter()
            .flatten()
            .map(|[a, b]| {
                0.5 * (inverse[(0, 0)] * a * a + 2.0 * inverse[(0, 1)] * a * b + inverse[(1, 1)] * b * b) + half_log
            })
            .sum()
    }
}

/// The signals that do not depend on the figures.
pub(super) struct Balances<'a> {
    pub(super) sections: &'a [Prepared],
    base: &'a Base,
    flights: usize,
    /// By section: derivatives of the velocity in the body frame.
    slopes: Vec<[Vec<f64>; 3]>,
}

impl<'a> Balances<'a> {
    pub(super) fn new(sections: &'a [Prepared], base: &'a Base, flights: usize) -> Self {
        let slopes = sections.iter().map(|one| one.velocity.each_ref().map(|v| derivative(v, STEP_S))).collect();
        Self { sections, base, flights, slopes }
    }

    /// Thrusts of all sections.
    pub(super) fn thrusts(&self, values: &DVector<f64>) -> Vec<Thrusts> {
        let drive = drive_of(values);
        self.sections.iter().map(|one| one.thrusts_between(&drive)).collect()
    }

    /// Logarithm of the thrust per mass of a full command by flight: it carries the craft on average.
    pub(super) fn full(&self, values: &DVector<f64>, thrusts: &[Thrusts]) -> Vec<f64> {
        (0..self.flights)
            .map(|flight| {
                let (mut needed, mut given) = (0.0, 0.0);
                for (one, thrusts) in self.sections.iter().zip(thrusts).filter(|(one, _)| one.flight == flight) {
                    for i in one.inner.clone() {
                        needed += one.force[2][i] + values[DRAG_Z] * one.velocity[2][i] - values[LIFT] * one.across[i];
                        given += thrusts.mean[i];
                    }
                }
                (needed / given.max(1e-9)).max(1e-3).ln()
            })
            .collect()
    }

    /// Of one balance; none where no filter settles.
    pub(super) fn innovations(
        &self,
        kind: usize,
        values: &DVector<f64>,
        thrusts: &[Thrusts],
        full: &[f64],
    ) -> Option<Innovations> {
        if kind < 2 { self.turning(kind, values, thrusts, full) } else { self.lifting(values, thrusts, full) }
    }

    fn turning(&self, axis: usize, values: &DVector<f64>, thrusts: &[Thrusts], full: &[f64]) -> Option<Innovations> {
        let (across, sign) = if axis == 0 { (1, 1.0) } else { (0, -1.0) };
        let inertia = values[INERTIA[axis]].exp();
        let (moment, damping) = (sign * values[MOMENT[axis]] / inertia, values[DAMPING[axis]] / inertia);
        let (drag, lever) = (values[DRAG[axis]], values[LEVER[axis]]);
        let noise = Noise::of(values, axis);
        let keep = |memory_s: f64| (-STEP_S / memory_s).exp();
        let [torque, air, force] = [noise.torque[0], noise.air[0], noise.force[0]].map(keep);
        let fed = |kept: f64, deviation: f64| (1.0 - kept * kept) * deviation * deviation;
        let model = Linear {
            a: Matrix4::new(
                1.0 - STEP_S * damping,
                STEP_S,
                -STEP_S * moment,
                0.0, //
                0.0,
                torque,
                0.0,
                0.0, //
                0.0,
                0.0,
                air,
                0.0, //
                0.0,
                0.0,
                0.0,
                force,
            ),
            h: Matrix2x4::new(
                1.0,
                0.0,
                0.0,
                0.0, //
                -lever * damping,
                lever,
                drag - lever * moment,
                1.0,
            ),
            q: Vector4::new(
                noise.rate * noise.rate,
                fed(torque, noise.torque[1]),
                fed(air, noise.air[1]),
                fed(force, noise.force[1]),
            ),
            r: Vector2::new(
                noise.sensors[0].powi(2) + RATE_LEAST.powi(2),
                noise.sensors[1].powi(2) + FORCE_LEAST.powi(2),
            ),
        };
        let steady = model.steady()?;
        let [j_x, j_y, j_z] = [values[INERTIA[0]].exp(), values[INERTIA[1]].exp(), self.base.inertia_kg_m2[2]];
        let gyroscopic = if axis == 0 { (j_y - j_z) / j_x } else { (j_z - j_x) / j_y };
        let sections = self
            .sections
            .iter()
            .zip(thrusts)
            .zip(&self.slopes)
            .map(|((one, thrusts), slopes)| {
                let per_mixture = 0.25 * self.base.mass_kg * full[one.flight].exp() * self.base.half_arm_m / inertia;
                let velocity = |i: usize| one.logged.velocity[across][i] + values[POSE_SHIFT] * slopes[across][i];
                let count = one.logged.rates[0].len();
                let aside = |i: usize| moment * velocity(i) + gyroscopic * one.products[axis][i];
                let mut state = Vector4::new(one.logged.rates[axis][0], 0.0, 0.0, 0.0);
                let mut all = Vec::with_capacity(count);
                let mut now = aside(0);
                for i in 0..count {
                    let turn = per_mixture * thrusts.mixture[axis][i] + now;
                    let seen = Vector2::new(
                        one.logged.rates[axis][i],
                        one.logged.force[across][i] + drag * velocity(i) - lever * turn,
                    );
                    let news = seen - model.h * state;
                    all.push([news.x, news.y]);
                    state += steady.gain * news;
                    state = model.a * state;
                    if i + 1 < count {
                        let next = aside(i + 1);
                        state.x += STEP_S * (per_mixture * thrusts.between[axis][i] + 0.5 * (now + next));
                        now = next;
                    }
                }
                settled(&all)
            })
            .collect();
        Some(Innovations { sections, covariance: steady.covariance })
    }

    fn lifting(&self, values: &DVector<f64>, thrusts: &[Thrusts], full: &[f64]) -> Option<Innovations> {
        let [memory_s, deviation, sensor] = [0, 1, 2].map(|k| values[NOISE_Z + k].exp());
        let kept = (-STEP_S / memory_s).exp();
        let model = Linear {
            a: Matrix1::new(kept),
            h: Matrix1::new(1.0),
            q: Vector1::new((1.0 - kept * kept) * deviation * deviation),
            r: Vector1::new(sensor.powi(2) + FORCE_LEAST.powi(2)),
        };
        let steady = model.steady()?;
        let sections = self
            .sections
            .iter()
            .zip(thrusts)
            .map(|(one, thrusts)| {
                let full = full[one.flight].exp();
                let mean = shifted_smoothly(&thrusts.mean, -values[FORCE_SHIFT] / STEP_S);
                let mut state = 0.0;
                let all: Vec<[f64; 2]> = (0..mean.len())
                    .map(|i| {
                        let foreseen =
                            full * mean[i] - values[DRAG_Z] * one.velocity[2][i] + values[LIFT] * one.across[i];
                        let news = one.logged.force[2][i] - foreseen - state;
                        state = kept * (state + steady.gain[0] * news);
                        [news, 0.0]
                    })
                    .collect();
                settled(&all)
            })
            .collect();
        Some(Innovations { sections, covariance: Matrix2::new(steady.covariance[0], 0.0, 0.0, 1.0) })
    }
}

/// Those that count, less their mean.
fn settled(all: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let counted = &all[((SETTLED_S * RATE_HZ) as usize).min(all.len())..];
    let means = [0, 1].map(|k| mean(&counted.iter().map(|news| news[k]).collect::<Vec<_>>()));
    counted.iter().map(|[a, b]| [a - means[0], b - means[1]]).collect()
}
