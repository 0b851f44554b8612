//! From the continuous Riccati equation to its refined solution: the starts and their order.
//!
//! In flow the equation in some scalings; out flows the best solution that was found, with its poles. Starts in 16 digits are
//! cheap and do for nearly all problems. Where the first correction tells that too little of a start is left by rounding, and
//! where the residual in 32 digits does not tell the last digit, doubling in 32 digits is next, refined in
//! coordinates in which X is about the identity.

use num_complex::Complex64;

use super::attempts::{self, Attempt};
use super::cost_coordinates::CostCoordinates;
use super::double_double::DoubleMatrix;
use super::equation::Equation;
use super::hamiltonian::{by_precise_doubling, by_precise_sign_function, by_schur_vectors, by_sign_function};
use super::newton::{Refined, refine};
use crate::analysis::eigenvalues;

/// A start whose first correction is above this share of P has lost too much in rounding to be refined where it is.
const ROUGH: f64 = 1e-2;

/// From an equation to a first approximation.
type Start = fn(&Equation) -> Option<DoubleMatrix>;
/// From an equation and a first approximation to a solution and its poles.
type Refinement = fn(&Equation, DoubleMatrix) -> Option<(Refined, Vec<Complex64>)>;

/// A refined solution in the coordinates of its equation.
pub(super) struct Solution<'a> {
    pub(super) equation: &'a Equation,
    pub(super) refined: Refined,
    /// Eigenvalues of the closed loop, 1/s, sorted by real part.
    pub(super) poles: Vec<Complex64>,
}

impl Solution<'_> {
    /// Largest real part of the poles.
    pub(super) fn abscissa(&self) -> f64 {
        self.poles.last().map_or(f64::NEG_INFINITY, |pole| pole.re)
    }
}

impl Attempt for Solution<'_> {
    fn is_stable(&self) -> bool {
        self.abscissa() < 0.0
    }

    fn error(&self) -> f64 {
        self.refined.last_correction.max(self.refined.rounding)
    }

    fn last_correction(&self) -> f64 {
        self.refined.last_correction
    }
}

/// Refines the starts in each scaling, as far as they are needed.
pub(super) fn solution(scalings: &[Equation]) -> Option<Solution<'_>> {
    let quick: [(Start, Refinement); 2] =
        [(by_sign_function, unless_rough), (by_precise_doubling, in_cost_coordinates)];
    // From a rough start Newton's method may wander: it is left to that only where the precise starts fail, too.
    let slow: [(Start, Refinement); 4] = [
        (by_schur_vectors, unless_rough),
        (by_precise_sign_function, patiently),
        (by_sign_function, patiently),
        (by_schur_vectors, patiently),
    ];
    let first = scalings.iter().flat_map(|equation| quick.map(|start| (equation, start)));
    let then = slow.into_iter().flat_map(|start| scalings.iter().map(move |equation| (equation, start)));
    attempts::best(first.chain(then).map(|(equation, (start, refinement))| {
        let (refined, poles) = refinement(equation, start(equation)?)?;
        Some(Solution { equation, refined, poles })
    }))
}

fn unless_rough(equation: &Equation, start: DoubleMatrix) -> Option<(Refined, Vec<Complex64>)> {
    with_poles(refine(equation, start, ROUGH)?)
}

fn patiently(equation: &Equation, start: DoubleMatrix) -> Option<(Refined, Vec<Complex64>)> {
    with_poles(refine(equation, start, f64::INFINITY)?)
}

/// Refines in coordinates in which X is about the identity, if it is positive definite.
fn in_cost_coordinates(equation: &Equation, start: DoubleMatrix) -> Option<(Refined, Vec<Complex64>)> {
    let Some(coordinates) = CostCoordinates::new(&start) else { return patiently(equation, start) };
    let start = coordinates.form(&start);
    let (refined, poles) = patiently(&equation.in_coordinates(&coordinates), start)?;
    let x = coordinates.form_of_states(&refined.x);
    Some((Refined { closed_loop: equation.residual(&x).closed_loop, x, ..refined }, poles))
}

fn with_poles(refined: Refined) -> Option<(Refined, Vec<Complex64>)> {
    let poles = eigenvalues(&refined.closed_loop).ok()?;
    Some((refined, poles))
}
