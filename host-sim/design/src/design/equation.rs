//! The equation `A' X + X A + Q - X F F' X = 0` in well-scaled coordinates, and its residual in 32 digits.
//!
//! In flow A, Q and a factor F of `B R^-1 B' = F F'`; out flow the same equation balanced, and the residual of any X.
//! With F absent the equation is Lyapunov's. The product `F F'` is never part of the residual: `F' X` is formed first,
//! so an R that is nearly singular costs no digits.

use nalgebra::{DMatrix, DVector};

use super::cost_coordinates::CostCoordinates;
use super::double_double::DoubleMatrix;

/// Exponents of the balancing stay within this of the start.
const MAX_EXPONENT: i32 = 100;

/// A quadratic matrix equation in the scaled unknown `D X D`.
#[derive(Debug, Clone)]
pub(super) struct Equation {
    /// `D^-1 A D`, n x n.
    pub(super) a: DoubleMatrix,
    /// `D^-1 F`, n x m; m = 0 for a linear equation.
    pub(super) factor: DoubleMatrix,
    /// `D Q D`, n x n.
    pub(super) q: DoubleMatrix,
    /// Diagonal of D: powers of two, so that the scaling is exact.
    pub(super) scale: DVector<f64>,
}

/// The terms of the residual of an X.
pub(super) struct Residual {
    /// `A' X + X A + Q - X F F' X`.
    pub(super) value: DoubleMatrix,
    /// `A - F F' X`.
    pub(super) closed_loop: DMatrix<f64>,
    /// Sum of the norms of the four terms.
    pub(super) terms: f64,
}

impl Equation {
    /// The equation as given, `D = I`.
    pub(super) fn new(a: DMatrix<f64>, factor: DoubleMatrix, q: DMatrix<f64>) -> Self {
        let scale = DVector::from_element(a.nrows(), 1.0);
        Self { a: DoubleMatrix::new(a), factor, q: DoubleMatrix::new(q), scale }
    }

    /// The equation with Q and `F F'` brought to equal norms by one factor for all states.
    pub(super) fn uniformly_scaled(mut self) -> Self {
        let mut g = &self.factor.hi * self.factor.hi.transpose();
        let (norm_a, norm_g, norm_q) = (self.a.hi.norm(), g.norm(), self.q.hi.norm());
        let ratio = match (norm_g > 0.0, norm_q > 0.0) {
            (true, true) => (norm_g / norm_q).sqrt(),
            (true, false) if norm_a > 0.0 => norm_g / norm_a,
            (false, true) if norm_a > 0.0 => norm_a / norm_q,
            _ => 1.0,
        };
        let uniform = (0.5 * ratio.log2()).round().clamp(-200.0, 200.0) as i32;
        for i in 0..self.states() {
            self.scale_state(i, uniform, &mut g);
        }
        self
    }

    /// The equation with its Hamiltonian matrix balanced: a diagonal scaling of the states that lowers the norm.
    ///
    /// Coordinate descent on the squared Frobenius norm of `[A -FF'; -Q -A']`, which under `D` turns the rows and
    /// columns of state i by powers of its `d_i` (symplectic balancing, Benner 2001).
    pub(super) fn balanced(self) -> Self {
        let mut equation = self.uniformly_scaled();
        let mut g = &equation.factor.hi * equation.factor.hi.transpose();
        let mut exponents = vec![0_i32; equation.states()];
        let total = 2.0 * equation.a.hi.norm_squared() + g.norm_squared() + equation.q.hi.norm_squared();
        for _ in 0..20 {
            let mut changed = false;
            for (i, exponent) in exponents.iter_mut().enumerate() {
                let shift = equation.best_shift(i, &g, 1e-30 * total);
                if shift != 0 && (*exponent + shift).abs() <= MAX_EXPONENT {
                    equation.scale_state(i, shift, &mut g);
                    *exponent += shift;
                    changed = true;
                }
            }
            if !changed {
                break;
            }
        }
        equation
    }

    /// The exponent by which state i is best scaled, all others held.
    fn best_shift(&self, i: usize, g: &DMatrix<f64>, least: f64) -> i32 {
        let off = |norm_squared: f64, diagonal: f64| (norm_squared - diagonal * diagonal).max(0.0);
        let (a, q) = (&self.a.hi, &self.q.hi);
        let (aii, qii, gii) = (a[(i, i)], q[(i, i)], g[(i, i)]);
        let up = off(a.column(i).norm_squared(), aii) + off(q.column(i).norm_squared(), qii);
        let down = off(a.row(i).norm_squared(), aii) + off(g.column(i).norm_squared(), gii);
        let size = |exponent: i32| {
            let d2 = f64::from(2 * exponent).exp2();
            2.0 * (up * d2 + down / d2) + qii * qii * d2 * d2 + gii * gii / (d2 * d2)
        };
        // Quantities that scaling does not change. Couplings below the diagonal entry are small enough: lowering them
        // further would pull a triangular A apart without end.
        let floor = least + 2.0 * aii * aii;
        let mut best = 0_i32;
        for direction in [1, -1] {
            // The sum is convex in the exponent: walk while it falls by a worthwhile share.
            while best.abs() < MAX_EXPONENT && size(best + direction) + floor < 0.95 * (size(best) + floor) {
                best += direction;
            }
            if best != 0 {
                break;
            }
        }
        best
    }

    /// Multiplies `d_i` by `2^exponent`.
    fn scale_state(&mut self, i: usize, exponent: i32, g: &mut DMatrix<f64>) {
        let factor = f64::from(exponent).exp2();
        self.scale[i] *= factor;
        for a in [&mut self.a.hi, &mut self.a.lo] {
            a.column_mut(i).scale_mut(factor);
            a.row_mut(i).unscale_mut(factor);
        }
        for q in [&mut self.q.hi, &mut self.q.lo] {
            q.column_mut(i).scale_mut(factor);
            q.row_mut(i).scale_mut(factor);
        }
        g.column_mut(i).unscale_mut(factor);
        g.row_mut(i).unscale_mut(factor);
        self.factor.hi.row_mut(i).unscale_mut(factor);
        self.factor.lo.row_mut(i).unscale_mut(factor);
    }

    /// The same equation in other coordinates of the states, for the unknown there.
    pub(super) fn in_coordinates(&self, coordinates: &CostCoordinates) -> Self {
        Self {
            a: coordinates.map(&self.a),
            factor: coordinates.input(&self.factor),
            q: coordinates.form(&self.q),
            scale: DVector::from_element(self.states(), 1.0),
        }
    }

    /// n.
    pub(super) fn states(&self) -> usize {
        self.a.hi.nrows()
    }

    /// The Hamiltonian matrix `[A -FF'; -Q -A']`, 2n x 2n, with `F F'` in 32 digits.
    pub(super) fn precise_hamiltonian(&self) -> DoubleMatrix {
        let n = self.states();
        let g = self.factor.times(&self.factor.transposed());
        DoubleMatrix::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
            (true, true) => self.a.get(i, j),
            (true, false) => g.get(i, j - n).negated(),
            (false, true) => self.q.get(i - n, j).negated(),
            (false, false) => self.a.get(j - n, i - n).negated(),
        })
    }

    /// The Hamiltonian matrix rounded to f64: good for a start, not for a residual.
    pub(super) fn hamiltonian(&self) -> DMatrix<f64> {
        self.precise_hamiltonian().hi
    }

    /// The residual of a symmetric X, with the products in 32 digits.
    pub(super) fn residual(&self, x: &DoubleMatrix) -> Residual {
        let linear = self.a.transposed().times(x);
        let feedback = self.factor.transposed().times(x);
        let quadratic = feedback.transposed().times(&feedback);
        let value = linear.plus(&linear.transposed()).minus(&quadratic).plus(&self.q);
        Residual {
            terms: 2.0 * linear.hi.norm() + self.q.hi.norm() + quadratic.hi.norm(),
            value: value.symmetrised(),
            closed_loop: self.a.minus(&self.factor.times(&feedback)).hi,
        }
    }

    /// Norm of the residual of an f64 matrix over the sum of the norms of the four terms; 0 where all are 0.
    pub(super) fn relative_residual(&self, x: &DMatrix<f64>) -> f64 {
        let residual = self.residual(&DoubleMatrix::new(x.clone()));
        if residual.terms == 0.0 { 0.0 } else { residual.value.hi.norm() / residual.terms }
    }

    /// X from the scaled unknown `D X D`.
    pub(super) fn unscaled(&self, scaled: &DoubleMatrix) -> DoubleMatrix {
        let unscale =
            |m: &DMatrix<f64>| DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)] / self.scale[i] / self.scale[j]);
        DoubleMatrix { hi: unscale(&scaled.hi), lo: unscale(&scaled.lo) }
    }
}
