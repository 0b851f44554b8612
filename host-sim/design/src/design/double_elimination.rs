//! Linear equations in 32 digits, by elimination.
//!
//! In flow a matrix and right-hand sides, n x n and n x k; out flows the solution, n x k. The columns are held as sum and sum
//! of errors while multiples of others are taken off them.

use std::ops::Range;

use nalgebra::DMatrix;

use super::double_double::{Double, DoubleMatrix};
use super::double_products::{Computation, Product, accumulate, run};

/// Columns of numbers held as sum and sum of errors.
struct Columns<'a> {
    rows: usize,
    sums: &'a mut [f64],
    errors: &'a mut [f64],
}

impl<'a> Columns<'a> {
    fn of(m: &'a mut DoubleMatrix) -> Self {
        Self { rows: m.hi.nrows(), sums: m.hi.as_mut_slice(), errors: m.lo.as_mut_slice() }
    }

    fn get(&self, i: usize, j: usize) -> Double {
        let at = j * self.rows + i;
        Double::renormalised(self.sums[at], self.errors[at])
    }

    fn set(&mut self, i: usize, j: usize, value: Double) {
        let at = j * self.rows + i;
        (self.sums[at], self.errors[at]) = value.parts();
    }

    fn swap_rows(&mut self, i: usize, k: usize) {
        for first in (0..self.sums.len()).step_by(self.rows) {
            self.sums.swap(first + i, first + k);
            self.errors.swap(first + i, first + k);
        }
    }

    /// Takes `factor` times rows `range` of a column off the same rows of column j.
    #[inline(always)]
    fn reduce(
        &mut self,
        product: impl Product,
        j: usize,
        range: Range<usize>,
        (hi, lo): (&[f64], &[f64]),
        factor: Double,
    ) {
        if factor.hi != 0.0 {
            let at = j * self.rows + range.start..j * self.rows + range.end;
            accumulate(product, &mut self.sums[at.clone()], &mut self.errors[at], hi, lo, factor.negated());
        }
    }
}

/// `M^-1 R` by Gauss's elimination with row pivoting.
struct Solve(DoubleMatrix, DoubleMatrix);

impl Computation for Solve {
    type Output = Option<DoubleMatrix>;

    #[inline(always)]
    fn with(self, product: impl Product) -> Option<DoubleMatrix> {
        let Self(mut matrix, mut right) = self;
        let (n, columns) = right.hi.shape();
        let (mut a, mut x) = (Columns::of(&mut matrix), Columns::of(&mut right));
        let (mut hi, mut lo) = (vec![0.0; n], vec![0.0; n]);
        for k in 0..n {
            let pivot = (k..n).max_by(|i, j| a.get(*i, k).hi.abs().total_cmp(&a.get(*j, k).hi.abs()))?;
            a.swap_rows(k, pivot);
            x.swap_rows(k, pivot);
            let pivot = a.get(k, k);
            if pivot.hi == 0.0 || !pivot.hi.is_finite() {
                return None;
            }
            let reciprocal = Double::new(1.0).over(pivot);
            for i in k + 1..n {
                (hi[i], lo[i]) = a.get(i, k).times(reciprocal).parts();
            }
            let multiples = (&hi[k + 1..], &lo[k + 1..]);
            for j in k + 1..n {
                a.reduce(product, j, k + 1..n, multiples, a.get(k, j));
            }
            for j in 0..columns {
                x.reduce(product, j, k + 1..n, multiples, x.get(k, j));
            }
        }
        for k in (0..n).rev() {
            let reciprocal = Double::new(1.0).over(a.get(k, k));
            for i in 0..k {
                (hi[i], lo[i]) = a.get(i, k).parts();
            }
            for j in 0..columns {
                let value = x.get(k, j).times(reciprocal);
                x.set(k, j, value);
                x.reduce(product, j, 0..k, (&hi[..k], &lo[..k]), value);
            }
        }
        Some(right)
    }
}

/// `L^-1 R` for a lower triangular L of f64.
struct OverLower<'a>(&'a DMatrix<f64>, DoubleMatrix);

impl Computation for OverLower<'_> {
    type Output = DoubleMatrix;

    #[inline(always)]
    fn with(self, product: impl Product) -> DoubleMatrix {
        let Self(lower, mut right) = self;
        let (n, columns) = right.hi.shape();
        let zeros = vec![0.0; n];
        let mut x = Columns::of(&mut right);
        for k in 0..n {
            let below = &lower.as_slice()[k * n + k + 1..(k + 1) * n];
            let reciprocal = Double::new(1.0).over(Double::new(lower[(k, k)]));
            for j in 0..columns {
                let value = x.get(k, j).times(reciprocal);
                x.set(k, j, value);
                x.reduce(product, j, k + 1..n, (below, &zeros[k + 1..]), value);
            }
        }
        right
    }
}

impl DoubleMatrix {
    /// `M^-1 R`; `None` if a pivot is zero or not finite.
    pub(super) fn solve(&self, right: &Self) -> Option<Self> {
        run(Solve(self.clone(), right.clone()))
    }

    /// The inverse; `None` if a pivot is zero or not finite.
    pub(super) fn inverse(&self) -> Option<Self> {
        self.solve(&Self::new(DMatrix::identity(self.hi.nrows(), self.hi.nrows())))
    }

    /// `L^-1 M` for a lower triangular L of f64.
    pub(super) fn over_lower(&self, lower: &DMatrix<f64>) -> Self {
        run(OverLower(lower, self.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers without a pattern, both parts of them.
    fn matrix(rows: usize, columns: usize) -> DoubleMatrix {
        let entry = |i: usize, j: usize| Double::new(((i * columns + j) as f64).powi(2).sin());
        DoubleMatrix::from_fn(rows, columns, |i, j| entry(i, j).over(Double::new(3.0 + j as f64)))
    }

    #[test]
    fn a_solution_has_thirty_digits() {
        // Hilbert's matrix of 8, condition 1.5e10: 32 digits less 10.
        let hilbert = DoubleMatrix::from_fn(8, 8, |i, j| Double::new(1.0).over(Double::new((i + j + 1) as f64)));
        let right = matrix(8, 3);
        let found = hilbert.solve(&hilbert.times(&right)).expect("regular");
        assert!(found.minus(&right).hi.amax() < 1e-20, "{:e}", found.minus(&right).hi.amax());
        assert!(DoubleMatrix::new(DMatrix::zeros(2, 2)).solve(&matrix(2, 1)).is_none());
    }

    #[test]
    fn a_triangular_system_is_solved_forwards() {
        let lower = DMatrix::from_fn(7, 7, |i, j| if i < j { 0.0 } else { 1.0 / (1.0 + i as f64 - 0.5 * j as f64) });
        let right = matrix(7, 4);
        let found = DoubleMatrix::new(lower.clone()).times(&right).over_lower(&lower);
        // Some units of 2^-106, and a condition of some hundred.
        assert!(found.minus(&right).hi.amax() < 1e-28);
    }
}
