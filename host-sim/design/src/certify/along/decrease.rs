//! The decrease of `V = e' P_k e` at every control step of the loop as it moves.
//!
//! In flow a reference and a design; out flows the step that takes off least. Between two steps the error moves by the
//! linear time-varying dynamics under a held command; they are integrated by the classical Runge-Kutta method in parts so
//! short that its error is below 1e-7. So the check shares neither the design's discretisation nor its gains between the
//! knots, only its P.

use nalgebra::SMatrix;

use super::flown::flown;
use crate::certify::CertifyError;
use crate::certify::certificate::WORSE;
use crate::design::along::{GainsAlong, error_dynamics};
use crate::model::flat::ReferencePoint;

/// Longest part of an integration step, s: the dynamics have no rate above some 20 1/s.
const LONGEST_PART_S: f64 = 2.6e-3;

type Square = SMatrix<f64, 9, 9>;
/// `[A B]`, and the map of a state and a held command.
type Motion = SMatrix<f64, 9, 13>;

/// The result along a trajectory and behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingDecrease {
    /// Whether every P > 0 and V falls by more than rounding at every step.
    pub holds: bool,
    /// Control steps that were checked, with that of the hover behind the last knot.
    pub steps: usize,
    /// Largest V after a step over V before it, over all errors.
    pub largest_ratio: f64,
    /// Time of that step, s.
    pub largest_ratio_at_s: f64,
    /// Least of the smallest eigenvalues of P over its largest.
    pub p_smallest_over_largest: f64,
    /// Largest change of a ratio by rounding.
    pub rounding: f64,
}

/// Checks the decrease of the gains as flown, with the design's own P.
///
/// # Errors
/// [`CertifyError::Schedule`] for a design that has no P for each of its control steps;
/// [`CertifyError::NotSinglePrecision`].
pub fn moving_decrease(
    reference: impl Fn(f64) -> ReferencePoint,
    designed: &GainsAlong,
) -> Result<MovingDecrease, CertifyError> {
    let gains = flown(designed)?;
    let steps = gains.len().saturating_sub(1) * designed.steps_per_knot;
    let (Some(last), true) = (gains.last(), designed.p.len() == steps + 1 && steps > 0) else {
        return Err(CertifyError::Schedule { knots: gains.len(), p: designed.p.len() });
    };
    let period_s = designed.period_s;
    let mut found = MovingDecrease {
        holds: true,
        steps: steps + 1,
        largest_ratio: 0.0,
        largest_ratio_at_s: 0.0,
        p_smallest_over_largest: 1.0,
        rounding: 0.0,
    };
    // Behind the last knot it hovers: one step is like all others.
    let followed = designed.p.iter().skip(1).chain(designed.p.last());
    for (step, (before, after)) in designed.p.iter().zip(followed).enumerate() {
        let start_s = step as f64 * period_s;
        let gain = if step < steps { interpolated(&gains, designed.steps_per_knot, step) } else { *last };
        let motion = transition(&reference, start_s, period_s);
        let closed = motion.fixed_columns::<9>(0) - motion.fixed_columns::<4>(9) * gain;
        found.take(before, after, &closed, start_s);
    }
    // Written so that NaN does not hold.
    found.holds = found.holds && found.largest_ratio < 1.0 - found.rounding;
    Ok(found)
}

impl MovingDecrease {
    fn take(&mut self, before: &Square, after: &Square, closed: &Square, time_s: f64) {
        let eigenvalues = before.symmetric_eigenvalues();
        let share = eigenvalues.min() / eigenvalues.max();
        self.p_smallest_over_largest = self.p_smallest_over_largest.min(share);
        let (Some(before), Some(after)) = (before.cholesky(), after.cholesky()) else {
            self.holds = false;
            return;
        };
        // With P = L L': the singular values of L_after' A L_before^-T, squared, are V's ratios.
        let moved = closed.transpose() * after.l();
        let ratio = match before.l().solve_lower_triangular(&moved) {
            Some(scaled) => (scaled * scaled.transpose()).symmetric_eigenvalues().max(),
            None => f64::INFINITY,
        };
        self.rounding = self.rounding.max(4.0 * 9.0 * f64::EPSILON / share);
        if ratio.is_nan() || ratio > self.largest_ratio * WORSE {
            (self.largest_ratio, self.largest_ratio_at_s) = (ratio, time_s);
        }
    }
}

/// The gain of a control step before the last knot, with the position between knots as the core has it.
fn interpolated(gains: &[SMatrix<f64, 4, 9>], steps_per_knot: usize, step: usize) -> SMatrix<f64, 4, 9> {
    let knots_per_tick = 1.0 / steps_per_knot as f32;
    let position = step as f32 * knots_per_tick;
    let share = f64::from(position - (position as u32) as f32);
    match gains.get(position as usize..) {
        Some([before, after, ..]) => before + (after - before) * share,
        Some([last]) => *last,
        _ => SMatrix::zeros(),
    }
}

/// `e(end) = Phi e(start) + Gamma u` over a period with u held, as `[Phi Gamma]`.
fn transition(reference: &impl Fn(f64) -> ReferencePoint, start_s: f64, period_s: f64) -> Motion {
    let parts = (period_s / LONGEST_PART_S).ceil().max(1.0);
    let part_s = period_s / parts;
    let dynamics = |time_s: f64| {
        let (a, b) = error_dynamics(&reference(time_s));
        let (a, b) = (Square::from_iterator(a.iter().copied()), SMatrix::<f64, 9, 4>::from_iterator(b.iter().copied()));
        move |x: &Motion| {
            let mut rate = a * x;
            let mut driven = rate.fixed_columns_mut::<4>(9);
            driven += b;
            rate
        }
    };
    let mut x = Motion::identity();
    let mut first = dynamics(start_s);
    for part in 0..parts as usize {
        let time_s = start_s + part as f64 * part_s;
        let (middle, end) = (dynamics(time_s + 0.5 * part_s), dynamics(time_s + part_s));
        let k1 = first(&x);
        let k2 = middle(&(x + k1 * (0.5 * part_s)));
        let k3 = middle(&(x + k2 * (0.5 * part_s)));
        let k4 = end(&(x + k3 * part_s));
        x += (k1 + (k2 + k3) * 2.0 + k4) * (part_s / 6.0);
        first = end;
    }
    x
}
