//! Products of matrices in 32 digits, and the loop in which products and eliminations do nearly all of their work.
//!
//! In flow matrices of [`Double`]; out flows their product. The loop adds a multiple of a column to another one, which is held
//! as sum and sum of errors (Ogita, Rump and Oishi 2005). Each entry has its own sum, so the order of its terms is the same
//! however many entries a processor takes at once.
//!
//! Where the processor has a fused multiply-add, and the feature `x86-v3` is on, that gives the rounding error of a product in one instruction in place of
//! Dekker's sixteen. The error is an f64 either way, and so the bits are the same, short of overflow and underflow.

use nalgebra::DMatrix;

use super::double_double::{Double, DoubleMatrix, two_product, two_sum};

/// How the rounding error of a product is found.
pub(super) trait Product: Copy {
    /// `a * b` and its rounding error.
    fn of(self, a: f64, b: f64) -> (f64, f64);
}

/// By splitting the factors: on every processor.
#[derive(Clone, Copy)]
struct Split;

impl Product for Split {
    #[inline(always)]
    fn of(self, a: f64, b: f64) -> (f64, f64) {
        two_product(a, b)
    }
}

/// By a fused multiply-add.
#[cfg(all(feature = "x86-v3", target_arch = "x86_64"))]
#[derive(Clone, Copy)]
struct Fused;

#[cfg(all(feature = "x86-v3", target_arch = "x86_64"))]
impl Product for Fused {
    #[inline(always)]
    fn of(self, a: f64, b: f64) -> (f64, f64) {
        let product = a * b;
        (product, a.mul_add(b, -product))
    }
}

/// A computation that is compiled once for each kind of product.
pub(super) trait Computation {
    type Output;

    fn with(self, product: impl Product) -> Self::Output;
}

/// Runs it by the widest instructions of this processor.
pub(super) fn run<C: Computation>(computation: C) -> C::Output {
    #[cfg(all(feature = "x86-v3", target_arch = "x86_64"))]
    if let Some(simd) = pulp::x86::V3::try_new() {
        return simd.vectorize(
            #[inline(always)]
            || computation.with(Fused),
        );
    }
    computation.with(Split)
}

/// Adds `(hi + lo) factor` to sums held as sum and sum of errors.
#[inline(always)]
pub(super) fn accumulate(
    product: impl Product,
    sums: &mut [f64],
    errors: &mut [f64],
    hi: &[f64],
    lo: &[f64],
    factor: Double,
) {
    for ((sum, error), (hi, lo)) in sums.iter_mut().zip(errors).zip(hi.iter().zip(lo)) {
        let (value, product_error) = product.of(*hi, factor.hi);
        let (total, sum_error) = two_sum(*sum, value);
        *sum = total;
        *error += sum_error + (product_error + (hi * factor.lo + lo * factor.hi));
    }
}

struct Times<'a>(&'a DoubleMatrix, &'a DoubleMatrix);

impl Computation for Times<'_> {
    type Output = DoubleMatrix;

    #[inline(always)]
    fn with(self, product: impl Product) -> DoubleMatrix {
        let Self(left, right) = self;
        let (rows, inner, columns) = (left.hi.nrows(), left.hi.ncols(), right.hi.ncols());
        let mut result = DoubleMatrix::new(DMatrix::zeros(rows, columns));
        if rows == 0 {
            return result;
        }
        let (left_hi, left_lo) = (left.hi.as_slice(), left.lo.as_slice());
        let sums = result.hi.as_mut_slice().chunks_exact_mut(rows);
        let errors = result.lo.as_mut_slice().chunks_exact_mut(rows);
        for (j, (sums, errors)) in sums.zip(errors).enumerate() {
            for k in 0..inner {
                let factor = right.get(k, j);
                // Models of chains are mostly zeros.
                if factor.hi != 0.0 {
                    let column = k * rows..(k + 1) * rows;
                    accumulate(product, sums, errors, &left_hi[column.clone()], &left_lo[column], factor);
                }
            }
            for (sum, error) in sums.iter_mut().zip(errors) {
                (*sum, *error) = Double::renormalised(*sum, *error).parts();
            }
        }
        result
    }
}

impl DoubleMatrix {
    /// Matrix product: exact products, their sum kept as sum and sum of errors.
    pub(super) fn times(&self, other: &Self) -> Self {
        run(Times(self, other))
    }
}

#[cfg(all(test, feature = "x86-v3", target_arch = "x86_64"))]
mod tests {
    use super::*;

    /// Numbers without a pattern, both parts of them.
    fn matrix(rows: usize, columns: usize) -> DoubleMatrix {
        let entry = |i: usize, j: usize| Double::new(((i * columns + j) as f64).powi(2).sin());
        DoubleMatrix::from_fn(rows, columns, |i, j| entry(i, j).over(Double::new(3.0 + j as f64)))
    }

    #[test]
    fn both_kinds_of_product_have_the_same_bits() {
        let (left, right) = (matrix(9, 13), matrix(13, 5));
        let run = pulp::x86::V3::try_new();
        let Some(simd) = run else { return };
        let fused = simd.vectorize(|| Times(&left, &right).with(Fused));
        let split = Times(&left, &right).with(Split);
        assert_eq!((fused.hi, fused.lo), (split.hi, split.lo));
    }
}
