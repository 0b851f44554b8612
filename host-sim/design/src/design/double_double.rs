//! Numbers of twice the precision: an unevaluated sum of two f64, about 32 digits.
//!
//! The refinement of a Riccati or Lyapunov solution lives on residuals that are far smaller than the terms they are the
//! difference of. With these computed in 32 digits, and only the corrections in 16, the solution comes out to the last
//! digit of an f64 even where the equation is ill-conditioned. Products are split without a fused multiply-add, so that
//! every target computes the same bits.
//! References: Dekker 1971; Ogita, Rump and Oishi 2005 (Dot2).

use nalgebra::DMatrix;

/// `hi + lo` with `|lo| <= ulp(hi) / 2`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Double {
    pub(super) hi: f64,
    pub(super) lo: f64,
}

/// `a + b` and its rounding error (Knuth).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let virtual_b = sum - a;
    (sum, (a - (sum - virtual_b)) + (b - virtual_b))
}

/// The two halves of a factor, each short enough for exact products (Veltkamp).
fn split(a: f64) -> (f64, f64) {
    let scaled = 134_217_729.0 * a; // 2^27 + 1
    let high = scaled - (scaled - a);
    (high, a - high)
}

/// `a * b` and its rounding error (Dekker).
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    (product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low)
}

impl Double {
    pub(super) fn new(value: f64) -> Self {
        Self { hi: value, lo: 0.0 }
    }

    fn renormalised(hi: f64, lo: f64) -> Self {
        let sum = hi + lo;
        Self { hi: sum, lo: lo - (sum - hi) }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        let (hi, error) = two_sum(self.hi, other.hi);
        let (lo, low_error) = two_sum(self.lo, other.lo);
        let first = Self::renormalised(hi, error + lo);
        Self::renormalised(first.hi, first.lo + low_error)
    }

    pub(super) fn minus(self, other: Self) -> Self {
        self.plus(Self { hi: -other.hi, lo: -other.lo })
    }

    pub(super) fn times(self, other: Self) -> Self {
        let (product, error) = two_product(self.hi, other.hi);
        Self::renormalised(product, error + (self.hi * other.lo + self.lo * other.hi))
    }

    pub(super) fn over(self, other: Self) -> Self {
        let first = self.hi / other.hi;
        let remainder = self.minus(other.times(Self::new(first)));
        let second = remainder.hi / other.hi;
        let rest = remainder.minus(other.times(Self::new(second)));
        Self::renormalised(first, second).plus(Self::new(rest.hi / other.hi))
    }

    /// Square root of a positive number: one Newton step from the f64 root doubles its digits.
    pub(super) fn sqrt(self) -> Self {
        let root = self.hi.sqrt();
        let remainder = self.minus(Self::new(root).times(Self::new(root)));
        Self::renormalised(root, remainder.hi / (2.0 * root))
    }
}

/// A matrix of [`Double`], its two parts held apart.
#[derive(Debug, Clone)]
pub(super) struct DoubleMatrix {
    pub(super) hi: DMatrix<f64>,
    pub(super) lo: DMatrix<f64>,
}

impl DoubleMatrix {
    pub(super) fn new(m: DMatrix<f64>) -> Self {
        Self { lo: DMatrix::zeros(m.nrows(), m.ncols()), hi: m }
    }

    pub(super) fn from_fn(rows: usize, columns: usize, mut entry: impl FnMut(usize, usize) -> Double) -> Self {
        let mut matrix = Self::new(DMatrix::zeros(rows, columns));
        for j in 0..columns {
            for i in 0..rows {
                matrix.set(i, j, entry(i, j));
            }
        }
        matrix
    }

    pub(super) fn get(&self, i: usize, j: usize) -> Double {
        Double { hi: self.hi[(i, j)], lo: self.lo[(i, j)] }
    }

    pub(super) fn set(&mut self, i: usize, j: usize, value: Double) {
        self.hi[(i, j)] = value.hi;
        self.lo[(i, j)] = value.lo;
    }

    pub(super) fn transposed(&self) -> Self {
        Self { hi: self.hi.transpose(), lo: self.lo.transpose() }
    }

    pub(super) fn plus(&self, other: &Self) -> Self {
        Self::from_fn(self.hi.nrows(), self.hi.ncols(), |i, j| self.get(i, j).plus(other.get(i, j)))
    }

    pub(super) fn minus(&self, other: &Self) -> Self {
        Self::from_fn(self.hi.nrows(), self.hi.ncols(), |i, j| self.get(i, j).minus(other.get(i, j)))
    }

    /// The matrix times a power of two.
    pub(super) fn scaled(&self, power_of_two: f64) -> Self {
        Self { hi: &self.hi * power_of_two, lo: &self.lo * power_of_two }
    }

    /// Adds an f64 matrix.
    pub(super) fn add(&mut self, other: &DMatrix<f64>) {
        for j in 0..other.ncols() {
            for i in 0..other.nrows() {
                self.set(i, j, self.get(i, j).plus(Double::new(other[(i, j)])));
            }
        }
    }

    /// `(M + M') / 2`.
    pub(super) fn symmetrised(&self) -> Self {
        self.plus(&self.transposed()).scaled(0.5)
    }

    /// Matrix product: exact products, their sum kept as sum and sum of errors.
    pub(super) fn times(&self, other: &Self) -> Self {
        let (rows, inner, columns) = (self.hi.nrows(), self.hi.ncols(), other.hi.ncols());
        let mut result = Self::new(DMatrix::zeros(rows, columns));
        for j in 0..columns {
            let mut sums = vec![0.0; rows];
            let mut errors = vec![0.0; rows];
            for k in 0..inner {
                let factor = other.get(k, j);
                // Models of chains are mostly zeros.
                if factor.hi == 0.0 {
                    continue;
                }
                let column = self.hi.column(k);
                let low = self.lo.column(k);
                let entries = column.iter().zip(low.iter());
                for ((sum, error), (hi, lo)) in sums.iter_mut().zip(&mut errors).zip(entries) {
                    let (product, product_error) = two_product(*hi, factor.hi);
                    let (total, sum_error) = two_sum(*sum, product);
                    *sum = total;
                    *error += sum_error + (product_error + (hi * factor.lo + lo * factor.hi));
                }
            }
            for i in 0..rows {
                result.set(i, j, Double::renormalised(sums[i], errors[i]));
            }
        }
        result
    }

    /// Inverse by Gauss-Jordan elimination with row pivoting; `None` if a pivot is zero or not finite.
    pub(super) fn inverse(&self) -> Option<Self> {
        let n = self.hi.nrows();
        let mut left: Vec<Vec<Double>> = (0..n).map(|i| (0..n).map(|j| self.get(i, j)).collect()).collect();
        let mut right: Vec<Vec<Double>> =
            (0..n).map(|i| (0..n).map(|j| Double::new(f64::from(u8::from(i == j)))).collect()).collect();
        for k in 0..n {
            let pivot = (k..n).max_by(|i, j| left[*i][k].hi.abs().total_cmp(&left[*j][k].hi.abs()))?;
            left.swap(k, pivot);
            right.swap(k, pivot);
            if left[k][k].hi == 0.0 || !left[k][k].hi.is_finite() {
                return None;
            }
            let reciprocal = Double::new(1.0).over(left[k][k]);
            for entry in left[k].iter_mut().chain(&mut right[k]) {
                *entry = entry.times(reciprocal);
            }
            let (pivot_left, pivot_right) = (left[k].clone(), right[k].clone());
            for i in (0..n).filter(|i| *i != k) {
                let factor = left[i][k];
                if factor.hi == 0.0 {
                    continue;
                }
                for (entry, above) in left[i].iter_mut().zip(&pivot_left).chain(right[i].iter_mut().zip(&pivot_right)) {
                    *entry = entry.minus(factor.times(*above));
                }
            }
        }
        Some(Self::from_fn(n, n, |i, j| right[i][j]))
    }

    pub(super) fn is_finite(&self) -> bool {
        self.hi.iter().chain(self.lo.iter()).all(|value| value.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_that_f64_loses_is_kept() {
        // 1e16 + 1 - 1e16 is 0 in f64 arithmetic.
        let row = DoubleMatrix::new(DMatrix::from_row_slice(1, 3, &[1e16, 1.0, -1e16]));
        let ones = DoubleMatrix::new(DMatrix::from_element(3, 1, 1.0));
        assert_eq!(row.times(&ones).hi[(0, 0)], 1.0);
    }

    #[test]
    fn quotient_and_root_invert_product_to_thirty_digits() {
        let third = Double::new(1.0).over(Double::new(3.0));
        let one = third.times(Double::new(3.0)).minus(Double::new(1.0));
        // A few units of 2^-106 = 1.2e-32.
        assert!(one.hi.abs() < 1e-31, "{one:?}");
        let root = Double::new(2.0).sqrt();
        assert!(root.times(root).minus(Double::new(2.0)).hi.abs() < 1e-31);
        // Both parts carry digits: neither is exact in f64.
        assert!(third.lo != 0.0 && root.lo != 0.0);
    }
}
