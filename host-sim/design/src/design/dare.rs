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
//! 4. Structured doubling (Chu, Fan, Lin and Wang 2004) in 32 digits gives a first P. Where Q does not see an unstable
//!    mode doubling ends in a P that does not stabilise; then the start is the solution for `Q + |Q| I`, from which
//!    Newton's method descends to the stabilising one (Hewer 1971).
//! 5. Newton steps with residuals in 32 digits refine P until the corrections are below the rounding of an f64.
//! 6. The result counts only if the corrections have vanished and every pole lies inside the unit circle.
//!
//! [`dlqr`] demands Q >= 0 (with S: `Q - S R^-1 S' >= 0`), and then P >= 0; [`dare`] takes any symmetric Q.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;

use super::discretise::require_fitting;
use super::double_double::{Double, DoubleMatrix};
use super::equation::{Equation, InputWeight};
use super::existence::require_positive_semidefinite;
use super::stein::SteinOperator;
use super::{DesignError, require_symmetric};
use crate::analysis::{MatrixError, eigenvalues, moves, require_finite, staircase};

/// Doubling steps at most: `2^60` samples.
const MAX_DOUBLINGS: usize = 60;
/// Newton steps at most.
const MAX_NEWTON_STEPS: usize = 60;
/// A solution counts as found if the last correction, relative to P, is below this.
const ACCURATE: f64 = 1e-13;
/// States up to which a singular value decomposition per unstable eigenvalue costs little.
const MAX_PBH_STATES: usize = 40;

/// Solution of the discrete Riccati equation.
#[derive(Debug, Clone)]
pub struct DareSolution {
    /// P, n x n, symmetric.
    pub p: DMatrix<f64>,
    /// `K = (R + B' P B)^-1 (B' P A + S')`, m x n, for u = -K x.
    pub gain: DMatrix<f64>,
    /// Eigenvalues of `A - B K`, per sample, sorted by real part.
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
    problem.solve()
}

/// The stabilising solution for any symmetric Q and R > 0, without a cross weight.
///
/// # Errors
/// [`DesignError::Matrix`] for matrices that do not fit, are empty or not finite; [`DesignError::NotSymmetric`];
/// [`DesignError::NotPositiveDefinite`] for R; [`DesignError::NotStabilisable`], [`DesignError::NotDetectableSampled`]
/// and [`DesignError::ClosedLoopOnCircle`] where no stabilising solution exists; [`DesignError::Inaccurate`] where none
/// was found to working precision.
pub fn dare(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    q: &DMatrix<f64>,
    r: &DMatrix<f64>,
) -> Result<DareSolution, DesignError> {
    Problem::new(a, b, q, r, &DMatrix::zeros(b.nrows(), b.ncols()))?.solve()
}

/// The equation with the weight of the input made the identity.
struct Problem {
    a: DoubleMatrix,
    q: DMatrix<f64>,
    weight: InputWeight,
    /// `F = B R^-1/2`, n x m.
    factor: DoubleMatrix,
    /// `S R^-1/2`, n x m.
    cross: DoubleMatrix,
}

/// The gain, poles and residual of a P.
struct Evaluated {
    residual: DoubleMatrix,
    /// `(I + F' P F)^-1 (F' P A + (S R^-1/2)')`, m x n.
    feedback: DoubleMatrix,
    /// `A - B K`.
    closed_loop: DMatrix<f64>,
    /// Sum of the norms of the four terms.
    terms: f64,
}

/// A P that Newton's method has settled on.
struct Refined {
    p: DoubleMatrix,
    last_correction: f64,
    spectral_radius: f64,
}

impl Problem {
    fn new(
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
        Ok(Self { a: DoubleMatrix::new(a.clone()), q, weight, factor, cross })
    }

    /// `Q - S R^-1 S'`: the weight left once the input makes the best of S.
    fn reduced_q(&self) -> DoubleMatrix {
        DoubleMatrix::new(self.q.clone()).minus(&self.cross.times(&self.cross.transposed()))
    }

    /// The same equation in the states `D^-1 x`, for D diagonal, powers of two; its P is `D P D`.
    fn scaled(&self, d: &DVector<f64>) -> Self {
        let n = d.len();
        let map = |m: &DoubleMatrix, factor: &dyn Fn(usize, usize) -> f64| DoubleMatrix {
            hi: DMatrix::from_fn(n, m.hi.ncols(), |i, j| m.hi[(i, j)] * factor(i, j)),
            lo: DMatrix::from_fn(n, m.lo.ncols(), |i, j| m.lo[(i, j)] * factor(i, j)),
        };
        Self {
            a: map(&self.a, &|i, j| d[j] / d[i]),
            q: DMatrix::from_fn(n, n, |i, j| self.q[(i, j)] * d[i] * d[j]),
            weight: self.weight.clone(),
            factor: map(&self.factor, &|i, _| 1.0 / d[i]),
            cross: map(&self.cross, &|i, _| d[i]),
        }
    }

    fn solve(&self) -> Result<DareSolution, DesignError> {
        let d = Equation::new(self.a.hi.clone(), self.factor.clone(), self.q.clone()).balanced().scale;
        let scaled = self.scaled(&d);
        let Refined { p, last_correction, spectral_radius } = scaled.stabilising()?;
        let inaccurate = |residual| DesignError::Inaccurate { equation: "the discrete Riccati equation", residual };
        let at_p = scaled.evaluate(&p).ok_or_else(|| inaccurate(f64::INFINITY))?;
        let poles = eigenvalues(&at_p.closed_loop)?;
        let unscale = |m: &DMatrix<f64>| DMatrix::from_fn(d.len(), d.len(), |i, j| m[(i, j)] / d[i] / d[j]);
        let p = unscale(&p.hi);
        let rounded = self.evaluate(&DoubleMatrix::new(p.clone())).ok_or_else(|| inaccurate(f64::INFINITY))?;
        let norm = rounded.residual.hi.norm();
        let relative_residual = if rounded.terms == 0.0 { 0.0 } else { norm / rounded.terms };
        let accurate = last_correction <= ACCURATE && relative_residual.is_finite();
        if !(accurate && spectral_radius < 1.0) {
            let nearest = poles.iter().min_by(|x, y| (x.norm() - 1.0).abs().total_cmp(&(y.norm() - 1.0).abs()));
            // Newton's steps halve the distance of a pole to the circle: it ends at the root of the rounding.
            if let Some(eigenvalue) = nearest.filter(|value| (value.norm() - 1.0).abs() < 1e-6) {
                return Err(DesignError::ClosedLoopOnCircle { eigenvalue: *eigenvalue });
            }
            return Err(inaccurate(relative_residual));
        }
        let mut gain = self.weight.in_input_units(at_p.feedback);
        for (mut column, scale) in gain.column_iter_mut().zip(d.iter()) {
            column.unscale_mut(*scale);
        }
        Ok(DareSolution { p, gain, poles, relative_residual, last_correction })
    }

    /// The best P that was found, stabilising or not.
    fn stabilising(&self) -> Result<Refined, DesignError> {
        // S acts as a feedback given beforehand: the reachable modes are the same, and Q sees the rest of them.
        let a = self.a.minus(&self.factor.times(&self.cross.transposed()));
        let q = self.reduced_q();
        require_stabilisable(&a.hi, &self.factor.hi)?;
        require_detectable(&a.hi, &q.hi)?;
        let mut lifted = q.clone();
        let size = if q.hi.norm() > 0.0 { q.hi.norm() } else { 1.0 };
        lifted.add(&(DMatrix::identity(a.hi.nrows(), a.hi.nrows()) * size));
        let mut best: Option<Refined> = None;
        // In 16 digits first: the refinement brings the others back on all but the hardest problems.
        let starts: [(Start, &DoubleMatrix); 3] = [(doubling_in_16_digits, &q), (doubling, &q), (doubling, &lifted)];
        for (start, q) in starts {
            let Some(refined) = start(&a, &self.factor, q).and_then(|p| self.refine(p)) else { continue };
            let good = refined.last_correction <= ACCURATE && refined.spectral_radius < 1.0;
            if good || best.is_none() {
                best = Some(refined);
            }
            if good {
                break;
            }
        }
        best.ok_or(DesignError::Inaccurate { equation: "the discrete Riccati equation", residual: f64::INFINITY })
    }

    /// The residual at a symmetric P; nothing if `I + F' P F` is singular.
    fn evaluate(&self, p: &DoubleMatrix) -> Option<Evaluated> {
        let pa = p.times(&self.a);
        let linear = self.a.transposed().times(&pa);
        let driven = self.factor.transposed().times(&pa).plus(&self.cross.transposed());
        let mut middle = self.factor.transposed().times(&p.times(&self.factor)).symmetrised();
        middle.add(&DMatrix::identity(middle.hi.nrows(), middle.hi.nrows()));
        let feedback = middle.inverse()?.times(&driven);
        let quadratic = driven.transposed().times(&feedback);
        let mut residual = linear.minus(p).minus(&quadratic);
        residual.add(&self.q);
        Some(Evaluated {
            terms: linear.hi.norm() + p.hi.norm() + self.q.norm() + quadratic.hi.norm(),
            residual: residual.symmetrised(),
            closed_loop: self.a.minus(&self.factor.times(&feedback)).hi,
            feedback,
        })
    }

    /// Newton's method (Hewer 1971): each step solves the Stein equation of its closed loop.
    fn refine(&self, start: DoubleMatrix) -> Option<Refined> {
        let mut p = start;
        let mut last_correction = f64::INFINITY;
        let mut operator: Option<SteinOperator> = None;
        let mut growing = 0;
        for _ in 0..MAX_NEWTON_STEPS {
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
        let spectral_radius = SteinOperator::new(&self.evaluate(&p)?.closed_loop).ok()?.spectral_radius();
        p.is_finite().then_some(Refined { p, last_correction, spectral_radius })
    }
}

/// From an equation to a first approximation.
type Start = fn(&DoubleMatrix, &DoubleMatrix, &DoubleMatrix) -> Option<DoubleMatrix>;

/// Structured doubling in 16 digits.
fn doubling_in_16_digits(a: &DoubleMatrix, factor: &DoubleMatrix, q: &DoubleMatrix) -> Option<DoubleMatrix> {
    let n = a.hi.nrows();
    let (mut a, mut g, mut h) = (a.hi.clone(), &factor.hi * factor.hi.transpose(), q.hi.clone());
    for _ in 0..MAX_DOUBLINGS {
        let middle = &g * &h + DMatrix::identity(n, n);
        let lu = middle.lu();
        let step = lu.solve(&a)?;
        let gained = a.transpose() * &h * &step;
        g += &a * lu.solve(&(&g * a.transpose()))?;
        g = (&g + g.transpose()) * 0.5;
        h += (&gained + gained.transpose()) * 0.5;
        a = &a * step;
        if !(h.norm().is_finite() && g.norm().is_finite() && a.norm().is_finite()) {
            return None;
        }
        if gained.norm() <= 1e-15 * h.norm() {
            break;
        }
    }
    Some(DoubleMatrix::new(h))
}

/// Structured doubling in 32 digits: after k steps `H` is the cost of `2^k` samples.
fn doubling(a: &DoubleMatrix, factor: &DoubleMatrix, q: &DoubleMatrix) -> Option<DoubleMatrix> {
    let n = a.hi.nrows();
    let (mut a, mut g, mut h) = (a.clone(), factor.times(&factor.transposed()), q.clone());
    for _ in 0..MAX_DOUBLINGS {
        let mut middle = g.times(&h);
        for i in 0..n {
            middle.set(i, i, middle.get(i, i).plus(Double::new(1.0)));
        }
        let inverse = middle.inverse()?;
        let step = inverse.times(&a);
        let gained = a.transposed().times(&h.times(&step)).symmetrised();
        g = g.plus(&a.times(&inverse.times(&g.times(&a.transposed())))).symmetrised();
        h = h.plus(&gained);
        a = a.times(&step);
        if !(h.is_finite() && g.is_finite() && a.is_finite()) {
            return None;
        }
        if gained.hi.norm() <= 1e-28 * h.hi.norm() {
            break;
        }
    }
    Some(h)
}

/// Refuses a pair whose input does not reach a mode on or outside the unit circle.
fn require_stabilisable(a: &DMatrix<f64>, factor: &DMatrix<f64>) -> Result<(), DesignError> {
    let n = a.nrows();
    let tolerance = n as f64 * f64::EPSILON * a.norm().max(1.0);
    let stairs = staircase(a, factor)?;
    if stairs.uncontrollable > 0 {
        let unreached = stairs.uncontrollable_a();
        for eigenvalue in eigenvalues(&unreached)? {
            if eigenvalue.norm() >= 1.0 - tolerance || on_circle(&unreached, eigenvalue, tolerance) {
                return Err(DesignError::NotStabilisable { eigenvalue });
            }
        }
    }
    if n > MAX_PBH_STATES {
        return Ok(());
    }
    // The size of B says nothing about the states that it reaches.
    let input = factor * (a.norm().max(1.0) / factor.norm().max(f64::MIN_POSITIVE));
    // Of a pair of conjugates, one tells.
    for eigenvalue in eigenvalues(a)?.into_iter().filter(|value| value.norm() >= 1.0 - tolerance && value.im >= 0.0) {
        if !moves(a, &input, eigenvalue)? {
            return Err(DesignError::NotStabilisable { eigenvalue });
        }
    }
    Ok(())
}

/// Refuses a Q that does not see a mode of A on the unit circle.
fn require_detectable(a: &DMatrix<f64>, q: &DMatrix<f64>) -> Result<(), DesignError> {
    let stairs = staircase(&a.transpose(), q)?;
    if stairs.uncontrollable == 0 {
        return Ok(());
    }
    let unseen = stairs.uncontrollable_a();
    let tolerance = unseen.nrows() as f64 * f64::EPSILON * a.norm().max(1.0);
    for eigenvalue in eigenvalues(&unseen)? {
        if on_circle(&unseen, eigenvalue, tolerance) {
            return Err(DesignError::NotDetectableSampled { eigenvalue: eigenvalue / eigenvalue.norm() });
        }
    }
    Ok(())
}

/// Whether the point of the circle beside `eigenvalue` is an eigenvalue of `m` up to a change of `m` by `tolerance`.
fn on_circle(m: &DMatrix<f64>, eigenvalue: Complex64, tolerance: f64) -> bool {
    if (eigenvalue.norm() - 1.0).abs() > 1e-2 {
        return false;
    }
    let point = eigenvalue / eigenvalue.norm();
    let mut shifted = m.map(|value| Complex64::new(value, 0.0));
    for i in 0..m.nrows() {
        shifted[(i, i)] -= point;
    }
    // The inverse's Frobenius norm bounds the smallest singular value from below within sqrt(n).
    shifted.try_inverse().is_none_or(|inverse| {
        let norm = inverse.norm();
        !norm.is_finite() || norm * tolerance >= 1.0
    })
}
