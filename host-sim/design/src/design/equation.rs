//! The equation `A' X + X A + Q - X F F' X = 0` in well-scaled coordinates, and its residual in 32 digits.
//!
//! In flow A, Q and a factor F of `B R^-1 B' = F F'`; out flow the same equation balanced, and the residual of any X.
//! With F absent the equation is Lyapunov's. The product `F F'` is never part of the residual: `F' X` is formed first,
//! so an R that is nearly singular costs no digits. R itself is factorised in 32 digits after its diagonal has been
//! brought to about 1.

use nalgebra::{DMatrix, DVector};

use super::DesignError;
use super::double_double::{Double, DoubleMatrix};

/// Exponents of the balancing stay within this of the start.
const MAX_EXPONENT: i32 = 100;

/// A quadratic matrix equation in the scaled unknown `D X D`.
#[derive(Debug, Clone)]
pub(super) struct Equation {
    /// `D^-1 A D`, n x n.
    pub(super) a: DMatrix<f64>,
    /// `D^-1 F`, n x m; m = 0 for a linear equation.
    pub(super) factor: DoubleMatrix,
    /// `D Q D`, n x n.
    pub(super) q: DMatrix<f64>,
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
        Self { a, factor, q, scale }
    }

    /// The equation with Q and `F F'` brought to equal norms by one factor for all states.
    pub(super) fn uniformly_scaled(mut self) -> Self {
        let mut g = &self.factor.hi * self.factor.hi.transpose();
        let (norm_a, norm_g, norm_q) = (self.a.norm(), g.norm(), self.q.norm());
        let ratio = match (norm_g > 0.0, norm_q > 0.0) {
            (true, true) => (norm_g / norm_q).sqrt(),
            (true, false) if norm_a > 0.0 => norm_g / norm_a,
            (false, true) if norm_a > 0.0 => norm_a / norm_q,
            _ => 1.0,
        };
        let uniform = (0.5 * ratio.log2()).round().clamp(-200.0, 200.0) as i32;
        for i in 0..self.a.nrows() {
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
        let mut exponents = vec![0_i32; equation.a.nrows()];
        let total = 2.0 * equation.a.norm_squared() + g.norm_squared() + equation.q.norm_squared();
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
        let (aii, qii, gii) = (self.a[(i, i)], self.q[(i, i)], g[(i, i)]);
        let up = off(self.a.column(i).norm_squared(), aii) + off(self.q.column(i).norm_squared(), qii);
        let down = off(self.a.row(i).norm_squared(), aii) + off(g.column(i).norm_squared(), gii);
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
        self.a.column_mut(i).scale_mut(factor);
        self.a.row_mut(i).unscale_mut(factor);
        self.q.column_mut(i).scale_mut(factor);
        self.q.row_mut(i).scale_mut(factor);
        g.column_mut(i).unscale_mut(factor);
        g.row_mut(i).unscale_mut(factor);
        self.factor.hi.row_mut(i).unscale_mut(factor);
        self.factor.lo.row_mut(i).unscale_mut(factor);
    }

    /// The Hamiltonian matrix `[A -FF'; -Q -A']`, 2n x 2n, with `F F'` in 32 digits.
    pub(super) fn precise_hamiltonian(&self) -> DoubleMatrix {
        let n = self.a.nrows();
        let g = self.factor.times(&self.factor.transposed());
        DoubleMatrix::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
            (true, true) => Double::new(self.a[(i, j)]),
            (true, false) => Double::new(0.0).minus(g.get(i, j - n)),
            (false, true) => Double::new(-self.q[(i - n, j)]),
            (false, false) => Double::new(-self.a[(j - n, i - n)]),
        })
    }

    /// The Hamiltonian matrix rounded to f64: good for a start, not for a residual.
    pub(super) fn hamiltonian(&self) -> DMatrix<f64> {
        self.precise_hamiltonian().hi
    }

    /// The residual of a symmetric X, with the products in 32 digits.
    pub(super) fn residual(&self, x: &DoubleMatrix) -> Residual {
        let linear = DoubleMatrix::new(self.a.transpose()).times(x);
        let feedback = self.factor.transposed().times(x);
        let quadratic = feedback.transposed().times(&feedback);
        let mut value = linear.plus(&linear.transposed()).minus(&quadratic);
        value.add(&self.q);
        Residual {
            terms: 2.0 * linear.hi.norm() + self.q.norm() + quadratic.hi.norm(),
            value: value.symmetrised(),
            closed_loop: &self.a - self.factor.times(&feedback).hi,
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

/// `R = S^-1 L L' S^-1` with S diagonal, powers of two, and L lower triangular in 32 digits.
#[derive(Debug, Clone)]
pub(super) struct InputWeight {
    lower: DoubleMatrix,
    scale: DVector<f64>,
}

impl InputWeight {
    /// Factorises a symmetric R.
    ///
    /// A pivot up to `m eps` of its diagonal entry is refused: the entries of R are not known to more.
    pub(super) fn new(r: &DMatrix<f64>) -> Result<Self, DesignError> {
        let m = r.nrows();
        if let Some(row) = (0..m).find(|i| r[(*i, *i)] <= 0.0) {
            return Err(DesignError::NotPositiveDefinite { row, pivot: r[(row, row)].signum().min(0.0) });
        }
        let scale = DVector::from_fn(m, |i, _| (-0.5 * r[(i, i)].log2()).round().exp2());
        let mut lower = DoubleMatrix::new(DMatrix::zeros(m, m));
        for j in 0..m {
            for i in j..m {
                let mut sum = Double::new(r[(i, j)] * scale[i] * scale[j]);
                for k in 0..j {
                    sum = sum.minus(lower.get(i, k).times(lower.get(j, k)));
                }
                if i > j {
                    lower.set(i, j, sum.over(lower.get(j, j)));
                    continue;
                }
                let pivot = sum.hi / (r[(j, j)] * scale[j] * scale[j]);
                if pivot.is_nan() || pivot <= m as f64 * f64::EPSILON {
                    return Err(DesignError::NotPositiveDefinite { row: j, pivot });
                }
                lower.set(j, j, sum.sqrt());
            }
        }
        Ok(Self { lower, scale })
    }

    /// `F = B S L^-T`, so that `F F' = B R^-1 B'`.
    pub(super) fn factor(&self, b: &DMatrix<f64>) -> DoubleMatrix {
        let mut factor = DoubleMatrix::new(DMatrix::from_fn(b.nrows(), b.ncols(), |i, j| b[(i, j)] * self.scale[j]));
        for i in 0..b.nrows() {
            for j in 0..b.ncols() {
                let mut sum = factor.get(i, j);
                for k in 0..j {
                    sum = sum.minus(factor.get(i, k).times(self.lower.get(j, k)));
                }
                factor.set(i, j, sum.over(self.lower.get(j, j)));
            }
        }
        factor
    }

    /// `K = R^-1 B' X = S L^-T (F' X)`, rounded once.
    pub(super) fn gain(&self, factor: &DoubleMatrix, x: &DoubleMatrix) -> DMatrix<f64> {
        self.in_input_units(factor.transposed().times(x))
    }

    /// `S L^-T W`: the action through F as an input that acts through B, rounded once.
    pub(super) fn in_input_units(&self, mut gain: DoubleMatrix) -> DMatrix<f64> {
        let (m, n) = gain.hi.shape();
        for j in 0..n {
            for i in (0..m).rev() {
                let mut sum = gain.get(i, j);
                for k in i + 1..m {
                    sum = sum.minus(self.lower.get(k, i).times(gain.get(k, j)));
                }
                gain.set(i, j, sum.over(self.lower.get(i, i)));
            }
        }
        DMatrix::from_fn(m, n, |i, j| gain.hi[(i, j)] * self.scale[i])
    }
}
