//! Newton-Kleinman refinement: residuals in 32 digits, corrections in 16.
//!
//! In flow an equation and a start; out flow X in 32 digits with the size of the last correction, which tells how well
//! X is known. Each correction solves the Lyapunov equation of the closed loop (Kleinman 1968). Far from the solution
//! the steps converge quadratically; near it each one divides the error by about `1 / (eps cond)`, so that X becomes
//! exact to the last digit of an f64 as long as the condition number is below about 1e15.

use nalgebra::DMatrix;

use super::double_double::{DoubleMatrix, UNIT_ROUNDING};
use super::equation::{Equation, Residual};
use super::lyapunov_operator::LyapunovOperator;

/// Newton steps at most: 3 or 4 from a good start, some 50 halvings where the closed loop ends on the imaginary axis.
const MAX_STEPS: usize = 70;
/// Correction relative to X after which another one could only change digits that an f64 does not have.
const FINISHED: f64 = 1e-20;
/// Below this a correction that no longer shrinks, not even by half, is the rounding floor.
const SETTLED: f64 = 1e-9;

/// A refined solution, in the coordinates of its equation.
pub(super) struct Refined {
    /// The solution.
    pub(super) x: DoubleMatrix,
    /// `A - F F' X`.
    pub(super) closed_loop: DMatrix<f64>,
    /// Norm of the last correction over the norm of X.
    pub(super) last_correction: f64,
    /// How far the rounding of the residual may put X off, over X.
    pub(super) rounding: f64,
}

/// Refines `start` until the corrections vanish or stop shrinking; `None` if they blow up, or if the first one is above
/// `roughest`, relative to X.
pub(super) fn refine(equation: &Equation, start: DoubleMatrix, roughest: f64) -> Option<Refined> {
    let mut x = start;
    let mut operator: Option<LyapunovOperator> = None;
    let mut last_correction = f64::INFINITY;
    let mut fast = false;
    let mut growing = 0;
    for step in 0..MAX_STEPS {
        let residual = equation.residual(&x);
        if !residual.value.is_finite() {
            return None;
        }
        // Near the solution the closed loop no longer changes enough to be worth another Schur form.
        if last_correction > 1e-8 || !fast {
            operator = Some(LyapunovOperator::new(&residual.closed_loop).ok()?);
        }
        let correction = operator.as_ref()?.solve(&residual.value.hi);
        if correction.iter().any(|value| !value.is_finite()) {
            return None;
        }
        let size = correction.norm();
        if size == 0.0 {
            last_correction = 0.0;
            break;
        }
        let relative = size / x.hi.norm().max(size);
        if step == 0 && relative > roughest {
            return None;
        }
        if relative < SETTLED && relative > 0.7 * last_correction {
            break;
        }
        growing = if relative > 0.9 * last_correction { growing + 1 } else { 0 };
        if growing > 20 {
            return None;
        }
        x.add(&correction);
        fast = relative < 1e-3 * last_correction;
        last_correction = relative;
        if relative < FINISHED {
            break;
        }
    }
    let Residual { closed_loop, terms, .. } = equation.residual(&x);
    let reach = operator?.solve(&DMatrix::identity(x.hi.nrows(), x.hi.nrows())).norm();
    let rounding = UNIT_ROUNDING * terms * reach / x.hi.norm().max(f64::MIN_POSITIVE);
    x.is_finite().then_some(Refined { x, closed_loop, last_correction, rounding })
}
