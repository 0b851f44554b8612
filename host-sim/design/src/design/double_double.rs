//! Numbers of twice the precision: an unevaluated sum of two f64, about 32 digits.
//!
//! The refinement of a Riccati or Lyapunov solution lives on residuals that are far smaller than the terms they are the
//! difference of. With these computed in 32 digits, and only the corrections in 16, the solution comes out to the last
//! digit of an f64 even where the equation is ill-conditioned. Every target computes the same bits.
//! References: Dekker 1971; Ogita, Rump and Oishi 2005 (Dot2).

use nalgebra::DMatrix;

/// Rounding of a product or a sum, relative: `2^-104`.
pub(super) const UNIT_ROUNDING: f64 = f64::EPSILON * f64::EPSILON;

/// `hi + lo` with `|lo| <= ulp(hi) / 2`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Double {
    pub(super) hi: f64,
    pub(super) lo: f64,
}

/// `a + b` and its rounding error (Knuth).
#[inline(always)]
pub(super) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let virtual_b = sum - a;
    (sum, (a - (sum - virtual_b)) + (b - virtual_b))
}

/// The two halves of a factor, each short enough for exact products (Veltkamp).
#[inline(always)]
fn split(a: f64) -> (f64, f64) {
    let scaled = 134_217_729.0 * a; // 2^27 + 1
    let high = scaled - (scaled - a);
    (high, a - high)
}

/// `a * b` and its rounding error (Dekker).
#[inline(always)]
pub(super) fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    (product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low)
}

impl Double {
    #[inline(always)]
    pub(super) fn new(value: f64) -> Self {
        Self { hi: value, lo: 0.0 }
    }

    #[inline(always)]
    pub(super) fn renormalised(hi: f64, lo: f64) -> Self {
        let sum = hi + lo;
        Self { hi: sum, lo: lo - (sum - hi) }
    }

    /// `(hi, lo)`.
    #[inline(always)]
    pub(super) fn parts(self) -> (f64, f64) {
        (self.hi, self.lo)
    }

    #[inline(always)]
    pub(super) fn plus(self, other: Self) -> Self {
        let (hi, error) = two_sum(self.hi, other.hi);
        let (lo, low_error) = two_sum(self.lo, other.lo);
        let first = Self::renormalised(hi, error + lo);
        Self::renormalised(first.hi, first.lo + low_error)
    }

    #[inline(always)]
    pub(super) fn minus(self, other: Self) -> Self {
        self.plus(other.negated())
    }

    #[inline(always)]
    pub(super) fn negated(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }

    #[inline(always)]
    pub(super) fn times(self, other: Self) -> Self {
        let (product, error) = two_product(self.hi, other.hi);
        Self::renormalised(product, error + (self.hi * other.lo + self.lo * other.hi))
    }

    #[inline(always)]
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

    /// The columns of both, side by side.
    pub(super) fn beside(&self, other: &Self) -> Self {
        let join = |left: &DMatrix<f64>, right: &DMatrix<f64>| {
            let mut joined = left.clone().resize_horizontally(left.ncols() + right.ncols(), 0.0);
            joined.columns_mut(left.ncols(), right.ncols()).copy_from(right);
            joined
        };
        Self { hi: join(&self.hi, &other.hi), lo: join(&self.lo, &other.lo) }
    }

    /// `count` columns from `first` on.
    pub(super) fn columns(&self, first: usize, count: usize) -> Self {
        Self { hi: self.hi.columns(first, count).into_owned(), lo: self.lo.columns(first, count).into_owned() }
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
