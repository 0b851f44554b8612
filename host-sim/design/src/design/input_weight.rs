//! The weight R of the input, factorised in 32 digits after its diagonal has been brought to about 1.
//!
//! In flow R (m x m) and B (n x m); out flows `F = B R^-1/2`, and an action through F as an input through B.

use nalgebra::{DMatrix, DVector};

use super::DesignError;
use super::double_double::{Double, DoubleMatrix};

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
