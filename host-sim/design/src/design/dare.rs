//! The discrete algebraic Riccati equation and its stabilising solution:
//! `A' P A - P + Q - (A' P B + S) (R + B' P B)^-1 (B' P A + S') = 0`.
//!
//! In flow A (n x n), B (n x m), Q (n x n), R (m x m) and a cross weight S (n x m, zero where none is asked for); out flow
//! P, `K = (R + B' P B)^-1 (B' P A + S')`, the poles of `A - B K` and bounds on their accuracy.
//!
//! **Method.**
//! 1. R is factorised in 32 digits; with `F = B R^-1/2` and `S R^-1/2` the weight of the input becomes the identity.
//! 2. The states are balanced by powers of two, as for the continuous equation.
//! 3. Staircase forms, with PBH tests beside them, decide whether a mode on or outside the unit circle is out of reach,
//!    or one on the circle out of sight.
//! 4. Structured doubling in 16 digits gives a first P; where too little of it is left by rounding, doubling in 32 digits
//!    does. Where Q does not see an unstable mode doubling ends in a P that does not stabilise; then the start is the
//!    solution for `Q + |Q| I`, from which Newton's method descends to the stabilising one (Hewer 1971).
//! 5. Newton steps with residuals in 32 digits refine P until the corrections are below the rounding of an f64; after
//!    doubling in 32 digits in coordinates in which P is about the identity, where few digits are lost.
//! 6. The result counts only if the corrections have vanished and every pole lies inside the unit circle, with the gain
//!    in 32 digits and with the one that is returned, in 16.
//!
//! [`dlqr`] demands Q >= 0 (with S: `Q - S R^-1 S' >= 0`), and then P >= 0; [`dare`] takes any symmetric Q.

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::DesignError;
use super::attempts::{self, ACCURATE};
use super::closed_loop;
use super::dare_equation::{Problem, Refined, spectral_radius};
use super::dare_existence::{require_detectable, require_stabilisable};
use super::discretise::require_fitting;
use super::double_double::DoubleMatrix;
use super::doubling::{doubling, doubling_in_16_digits};
use super::equation::Equation;
use super::existence::require_positive_semidefinite;
use super::require_symmetric;
use super::sizes::or_size;

/// A start whose first correction is above this share of P has lost too much in rounding to be refined where it is.
const ROUGH: f64 = 1e-4;
/// In messages.
const EQUATION: &str = "the discrete Riccati equation";

/// Solution of the discrete Riccati equation.
#[derive(Debug, Clone)]
pub struct DareSolution {
    /// P, n x n, symmetric.
    pub p: DMatrix<f64>,
    /// `K = (R + B' P B)^-1 (B' P A + S')`, m x n, for u = -K x.
    pub gain: DMatrix<f64>,
    /// Eigenvalues of `A - B K` with K as it is here, rounded to 16 digits, per sample, sorted by real part.
    pub poles: Vec<Complex64>,
    /// Frobenius norm of the residual of P over the sum of the norms of the four terms, evaluated in 32 digits.
    pub relative_residual: f64,
    /// Last Newton correction over P, before P was rounded to f64.
    pub last_correction: f64,
}

/// The optimal feedback for `sum x' Q x + u' R u`, Q >= 0 and R > 0.
///
/// # Errors
/// As [`dare`], and [`DesignError::NotPositiveSemidefinite`].
pub fn dlqr(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    q: &DMatrix<f64>,
    r: &DMatrix<f64>,
) -> Result<DareSolution, DesignError> {
    require_fitting(a, b)?;
    require_positive_semidefinite(&require_symmetric("Q", q, a.nrows())?)?;
    dare(a, b, q, r)
}

/// The optimal feedback for `sum x' Q x + 2 x' S u + u' R u`, all of it together >= 0, and R > 0; S is n x m.
///
/// # Errors
/// As [`dare`], and [`DesignError::CrossWeight`].
pub fn dlqr_with_cross(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    q: &DMatrix<f64>,
    r: &DMatrix<f64>,
    s: &DMatrix<f64>,
) -> Result<DareSolution, DesignError> {
    let problem = Problem::new(a, b, q, r, s)?;
    require_positive_semidefinite(&problem.reduced_q().hi).map_err(|error| match error {
        DesignError::NotPositiveSemidefinite { eigenvalue } => DesignError::CrossWeight { eigenvalue },
        other => other,
    })?;
    problem.solve(b).map_err(|error| or_size(error, [("A", a), ("B", b), ("Q", q), ("R", r)]))
}

/// The stabilising solution for any symmetric Q and R > 0, without a cross weight.
///
/// # Errors
/// [`DesignError::Matrix`] for matrices that do not fit, are empty or not finite; [`DesignError::NotSymmetric`];
/// [`DesignError::NotPositiveDefinite`] for R; [`DesignError::NotStabilisable`], [`DesignError::NotDetectableSampled`]
/// and [`DesignError::ClosedLoopOnCircle`] where no stabilising solution exists; [`DesignError::Inaccurate`] where none
/// was found to working precision; [`DesignError::RoundedGain`] where its gain in 16 digits does not stabilise;
/// [`DesignError::Size`] where one of the latter is met and a matrix is far from 1.
pub fn dare(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    q: &DMatrix<f64>,
    r: &DMatrix<f64>,
) -> Result<DareSolution, DesignError> {
    Problem::new(a, b, q, r, &DMatrix::zeros(b.nrows(), b.ncols()))?
        .solve(b)
        .map_err(|error| or_size(error, [("A", a), ("B", b), ("Q", q), ("R", r)]))
}

impl Problem {
    /// `b`: as given, before R became a part of it.
    fn solve(&self, b: &DMatrix<f64>) -> Result<DareSolution, DesignError> {
        let d = Equation::new(self.a.hi.clone(), self.factor.clone(), self.q.hi.clone()).balanced().scale;
        let Refined { p, feedback, poles, last_correction, .. } = self.scaled(&d).stabilising()?;
        let unscale = |m: &DMatrix<f64>| DMatrix::from_fn(d.len(), d.len(), |i, j| m[(i, j)] / d[i] / d[j]);
        let p = unscale(&p.hi);
        let rounded = self.evaluate(&DoubleMatrix::new(p.clone())).ok_or_else(|| inaccurate(f64::INFINITY))?;
        let norm = rounded.residual.hi.norm();
        let terms = self.terms(&p);
        let relative_residual = if terms == 0.0 { 0.0 } else { norm / terms };
        let accurate = last_correction <= ACCURATE && relative_residual.is_finite();
        if !(accurate && spectral_radius(&poles) < 1.0) {
            let nearest = poles.iter().min_by(|x, y| (x.norm() - 1.0).abs().total_cmp(&(y.norm() - 1.0).abs()));
            // Newton's steps halve the distance of a pole to the circle: it ends at the root of the rounding.
            if let Some(eigenvalue) = nearest.filter(|value| (value.norm() - 1.0).abs() < 1e-6) {
                return Err(DesignError::ClosedLoopOnCircle { eigenvalue: *eigenvalue });
            }
            return Err(inaccurate(relative_residual));
        }
        let mut gain = self.weight.in_input_units(feedback);
        for (mut column, scale) in gain.column_iter_mut().zip(d.iter()) {
            column.unscale_mut(*scale);
        }
        let [poles, in_16_digits] = closed_loop::poles(&self.a.hi, b, &gain)?;
        match poles.iter().chain(&in_16_digits).max_by(|x, y| x.norm().total_cmp(&y.norm())) {
            Some(pole) if pole.norm() >= 1.0 => Err(DesignError::RoundedGain { equation: EQUATION, pole: *pole }),
            _ => Ok(DareSolution { p, gain, poles, relative_residual, last_correction }),
        }
    }

    /// The best P that was found, stabilising or not.
    fn stabilising(&self) -> Result<Refined, DesignError> {
        let (a, q) = self.without_cross();
        require_stabilisable(&a.hi, &self.factor.hi)?;
        require_detectable(&a.hi, &q.hi)?;
        let mut lifted = q.clone();
        let size = if q.hi.norm() > 0.0 { q.hi.norm() } else { 1.0 };
        lifted.add(&(DMatrix::identity(a.hi.nrows(), a.hi.nrows()) * size));
        // In 16 digits first: the refinement brings the others back on all but the hardest problems.
        let ways: [&dyn Fn() -> Option<Refined>; 3] = [
            &|| self.refine(doubling_in_16_digits(&a, &self.factor, &q)?, ROUGH),
            &|| self.refine_in_cost_coordinates(doubling(&a, &self.factor, &q)?),
            &|| self.refine(doubling(&a, &self.factor, &lifted)?, f64::INFINITY),
        ];
        let best = attempts::best(ways.into_iter().map(|way| way()));
        best.ok_or_else(|| inaccurate(f64::INFINITY))
    }
}

fn inaccurate(residual: f64) -> DesignError {
    DesignError::Inaccurate { equation: EQUATION, residual }
}
