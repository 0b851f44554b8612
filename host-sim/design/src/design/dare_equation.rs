//! The discrete Riccati equation in coordinates of the states, and Newton's method on it.
//!
//! In flow A, B, Q, R, S and a start; out flow P in 32 digits with its gain and poles, and how far it may be off.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;

use super::attempts::Attempt;
use super::cost_coordinates::CostCoordinates;
use super::discretise::require_fitting;
use super::double_double::{DoubleMatrix, UNIT_ROUNDING};
use super::input_weight::InputWeight;
use super::stein::SteinOperator;
use super::{DesignError, require_symmetric};
use crate::analysis::{MatrixError, eigenvalues, require_finite};

/// Newton steps at most.
const MAX_NEWTON_STEPS: usize = 60;

/// The equation with the weight of the input made the identity.
pub(super) struct Problem {
    pub(super) a: DoubleMatrix,
    pub(super) q: DoubleMatrix,
    pub(super) weight: InputWeight,
    /// `F = B R^-1/2`, n x m.
    pub(super) factor: DoubleMatrix,
    /// `S R^-1/2`, n x m.
    pub(super) cross: DoubleMatrix,
}

/// The gain, poles and residual of a P.
pub(super) struct Evaluated {
    pub(super) residual: DoubleMatrix,
    /// `(I + F' P F)^-1 (F' P A + (S R^-1/2)')`, m x n.
    pub(super) feedback: DoubleMatrix,
    /// `A - B K`.
    pub(super) closed_loop: DMatrix<f64>,
}

/// A P that Newton's method has settled on.
pub(super) struct Refined {
    pub(super) p: DoubleMatrix,
    /// As [`Evaluated`] has it.
    pub(super) feedback: DoubleMatrix,
    /// Eigenvalues of the closed loop.
    pub(super) poles: Vec<Complex64>,
    pub(super) last_correction: f64,
    /// How far the rounding of the residual may put P off, over P.
    pub(super) rounding: f64,
}

impl Attempt for Refined {
    fn is_stable(&self) -> bool {
        spectral_radius(&self.poles) < 1.0
    }

    fn error(&self) -> f64 {
        self.last_correction.max(self.rounding)
    }

    fn last_correction(&self) -> f64 {
        self.last_correction
    }
}

impl Problem {
    pub(super) fn new(
        a: &DMatrix<f64>,
        b: &DMatrix<f64>,
        q: &DMatrix<f64>,
        r: &DMatrix<f64>,
        s: &DMatrix<f64>,
    ) -> Result<Self, DesignError> {
        require_fitting(a, b)?;
        let (n, m) = b.shape();
        require_finite("S", s)?;
        if s.shape() != b.shape() {
            let (rows, columns) = s.shape();
            let error =
                MatrixError::Dimension { name: "S", rows, columns, expected_rows: n, expected_columns: m, fits: "B" };
            return Err(error.into());
        }
        let q = require_symmetric("Q", q, n)?;
        let weight = InputWeight::new(&require_symmetric("R", r, m)?)?;
        let (factor, cross) = (weight.factor(b), weight.factor(s));
        Ok(Self { a: DoubleMatrix::new(a.clone()), q: DoubleMatrix::new(q), weight, factor, cross })
    }

    /// `Q - S R^-1 S'`: the weight left once the input makes the best of S.
    pub(super) fn reduced_q(&self) -> DoubleMatrix {
        self.q.minus(&self.cross.times(&self.cross.transposed()))
    }

    /// The same equation in the states `D^-1 x`, for D diagonal, powers of two; its P is `D P D`.
    pub(super) fn scaled(&self, d: &DVector<f64>) -> Self {
        let n = d.len();
        let map = |m: &DoubleMatrix, factor: &dyn Fn(usize, usize) -> f64| DoubleMatrix {
            hi: DMatrix::from_fn(n, m.hi.ncols(), |i, j| m.hi[(i, j)] * factor(i, j)),
            lo: DMatrix::from_fn(n, m.lo.ncols(), |i, j| m.lo[(i, j)] * factor(i, j)),
        };
        Self {
            a: map(&self.a, &|i, j| d[j] / d[i]),
            q: map(&self.q, &|i, j| d[i] * d[j]),
            weight: self.weight.clone(),
            factor: map(&self.factor, &|i, _| 1.0 / d[i]),
            cross: map(&self.cross, &|i, _| d[i]),
        }
    }

    /// The same equation in other coordinates of the states.
    pub(super) fn in_coordinates(&self, coordinates: &CostCoordinates) -> Self {
        Self {
            a: coordinates.map(&self.a),
            q: coordinates.form(&self.q),
            weight: self.weight.clone(),
            factor: coordinates.input(&self.factor),
            cross: coordinates.weight(&self.cross),
        }
    }

    /// A and Q once S acts as a feedback given beforehand: the reachable modes are the same, and Q sees the rest of them.
    pub(super) fn without_cross(&self) -> (DoubleMatrix, DoubleMatrix) {
        (self.a.minus(&self.factor.times(&self.cross.transposed())), self.reduced_q())
    }

    /// As [`Self::refine`], in coordinates in which P is about the identity, if it is positive definite.
    pub(super) fn refine_in_cost_coordinates(&self, start: DoubleMatrix) -> Option<Refined> {
        let Some(coordinates) = CostCoordinates::new(&start) else { return self.refine(start, f64::INFINITY) };
        let refined = self.in_coordinates(&coordinates).refine(coordinates.form(&start), f64::INFINITY)?;
        Some(Refined {
            p: coordinates.form_of_states(&refined.p),
            feedback: coordinates.feedback_of_states(&refined.feedback),
            ..refined
        })
    }

    /// The residual at a symmetric P; nothing if `I + F' P F` is singular.
    ///
    /// As `A_K' P A_K - P + Q - S K - K' S' + K' K` with `A_K = A - F K`: an error of K enters squared, and where F reaches
    /// states of very different costs `A_K` is small beside A, so that little cancels.
    pub(super) fn evaluate(&self, p: &DoubleMatrix) -> Option<Evaluated> {
        let reached = p.times(&self.factor);
        let mut middle = self.factor.transposed().times(&reached).symmetrised();
        middle.add(&DMatrix::identity(middle.hi.nrows(), middle.hi.nrows()));
        let weights = self.cross.transposed();
        let rough = middle.solve(&reached.transposed().times(&self.a).plus(&weights))?;
        // What K leaves of its equation `K - F' P A_K - S' = 0`, which loses the digits that `I + F' P F` has squared.
        let driven = reached.transposed().times(&self.a.minus(&self.factor.times(&rough)));
        let feedback = rough.minus(&middle.solve(&rough.minus(&driven).minus(&weights))?);
        let closed_loop = self.a.minus(&self.factor.times(&feedback));
        let ahead = closed_loop.transposed().times(&p.times(&closed_loop));
        let crossed = self.cross.times(&feedback);
        let effort = feedback.transposed().times(&feedback).minus(&crossed).minus(&crossed.transposed());
        let residual = ahead.minus(p).plus(&self.q).plus(&effort).symmetrised();
        Some(Evaluated { residual, feedback, closed_loop: closed_loop.hi })
    }

    /// Sum of the norms of the four terms of the equation.
    pub(super) fn terms(&self, p: &DMatrix<f64>) -> f64 {
        let pa = p * &self.a.hi;
        let driven = self.factor.hi.transpose() * &pa + self.cross.hi.transpose();
        let middle =
            self.factor.hi.transpose() * p * &self.factor.hi + DMatrix::identity(driven.nrows(), driven.nrows());
        let quadratic = middle.lu().solve(&driven).map_or(0.0, |feedback| (driven.transpose() * feedback).norm());
        (self.a.hi.transpose() * pa).norm() + p.norm() + self.q.hi.norm() + quadratic
    }

    /// Newton's method (Hewer 1971): each step solves the Stein equation of its closed loop.
    ///
    /// Nothing if the first correction is above `roughest`, relative to P.
    pub(super) fn refine(&self, start: DoubleMatrix, roughest: f64) -> Option<Refined> {
        let mut p = start;
        let mut last_correction = f64::INFINITY;
        let mut operator: Option<SteinOperator> = None;
        let mut growing = 0;
        for step in 0..MAX_NEWTON_STEPS {
            let evaluated = self.evaluate(&p)?;
            if !evaluated.residual.is_finite() {
                return None;
            }
            // Near the solution the closed loop no longer changes enough to be worth another Schur form.
            if last_correction > 1e-8 || operator.is_none() {
                operator = Some(SteinOperator::new(&evaluated.closed_loop).ok()?);
            }
            let correction = operator.as_ref()?.solve(&evaluated.residual.hi);
            let size = correction.norm();
            if !size.is_finite() {
                return None;
            }
            let relative = if size == 0.0 { 0.0 } else { size / p.hi.norm().max(size) };
            if step == 0 && relative > roughest {
                return None;
            }
            growing = if relative > 0.9 * last_correction { growing + 1 } else { 0 };
            // The rounding floor, or no convergence at all.
            if growing > 20 || (relative < 1e-9 && relative > 0.7 * last_correction) {
                break;
            }
            p.add(&correction);
            last_correction = relative;
            if relative < 1e-20 {
                break;
            }
        }
        let Evaluated { feedback, closed_loop, .. } = self.evaluate(&p)?;
        let poles = eigenvalues(&closed_loop).ok()?;
        // The rounding of A_K, of the terms of the residual, and what they come to in P.
        let (loop_norm, gain_norm, p_norm) = (closed_loop.norm(), feedback.hi.norm(), p.hi.norm());
        let moved = 2.0 * loop_norm * p_norm * (self.a.hi.norm() + self.factor.hi.norm() * gain_norm);
        let terms = moved + p_norm + self.q.hi.norm() + gain_norm * (gain_norm + 2.0 * self.cross.hi.norm());
        let reach = operator?.solve(&DMatrix::identity(p.hi.nrows(), p.hi.nrows())).norm();
        let rounding = UNIT_ROUNDING * terms * reach / p_norm.max(f64::MIN_POSITIVE);
        p.is_finite().then_some(Refined { p, feedback, poles, last_correction, rounding })
    }
}

/// Largest modulus of the poles.
pub(super) fn spectral_radius(poles: &[Complex64]) -> f64 {
    poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max)
}
