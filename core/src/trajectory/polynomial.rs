//! Polynomials of degree at most 7: coefficients and a time in; the value and its derivatives out.

/// Coefficients of a polynomial of degree at most 7, ascending powers of the seconds since the piece began.
pub type Coefficients = [f32; 8];

/// A polynomial and its first three derivatives at `t`, all by one pass of Horner's scheme. Written out: coefficients
/// that are still zero in its first steps costs nothing.
#[inline]
pub(super) fn derivatives(coefficients: &Coefficients, t: f32) -> [f32; 4] {
    let [c0, c1, c2, c3, c4, c5, c6, c7] = *coefficients;
    let (d1, p) = (c7, c7 * t + c6);
    let (d2, d1, p) = (d1, d1 * t + p, p * t + c5);
    let (d3, d2, d1, p) = (d2, d2 * t + d1, d1 * t + p, p * t + c4);
    let (d3, d2, d1, p) = (d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c3);
    let (d3, d2, d1, p) = (d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c2);
    let (d3, d2, d1, p) = (d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c1);
    let (d3, d2, d1, p) = (d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c0);
    [p, d1, 2.0 * d2, 6.0 * d3]
}

/// The same for a polynomial of degree 5, the paper's, to the same bits: two thirds of the products.
#[inline]
pub(super) fn quintic_derivatives(coefficients: &Coefficients, t: f32) -> [f32; 4] {
    let [c0, c1, c2, c3, c4, c5, ..] = *coefficients;
    let (d1, p) = (c5, c5 * t + c4);
    let (d2, d1, p) = (d1, d1 * t + p, p * t + c3);
    let (d3, d2, d1, p) = (d2, d2 * t + d1, d1 * t + p, p * t + c2);
    let (d3, d2, d1, p) = (d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c1);
    let (d3, d2, d1, p) = (d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c0);
    [p, d1, 2.0 * d2, 6.0 * d3]
}

/// A polynomial and its first five derivatives at `t`; the first four to the same bits as by [`derivatives`].
#[inline]
pub(super) fn derivatives_to_fifth(coefficients: &Coefficients, t: f32) -> [f32; 6] {
    let [c0, c1, c2, c3, c4, c5, c6, c7] = *coefficients;
    let (d1, p) = (c7, c7 * t + c6);
    let (d2, d1, p) = (d1, d1 * t + p, p * t + c5);
    let (d3, d2, d1, p) = (d2, d2 * t + d1, d1 * t + p, p * t + c4);
    let (d4, d3, d2, d1, p) = (d3, d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c3);
    let (d5, d4, d3, d2, d1, p) = (d4, d4 * t + d3, d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c2);
    let (d5, d4, d3, d2, d1, p) = (d5 * t + d4, d4 * t + d3, d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c1);
    let (d5, d4, d3, d2, d1, p) = (d5 * t + d4, d4 * t + d3, d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c0);
    [p, d1, 2.0 * d2, 6.0 * d3, 24.0 * d4, 120.0 * d5]
}

/// The same for a polynomial of degree 5, to the same bits.
#[inline]
pub(super) fn quintic_derivatives_to_fifth(coefficients: &Coefficients, t: f32) -> [f32; 6] {
    let [c0, c1, c2, c3, c4, c5, ..] = *coefficients;
    let (d1, p) = (c5, c5 * t + c4);
    let (d2, d1, p) = (d1, d1 * t + p, p * t + c3);
    let (d3, d2, d1, p) = (d2, d2 * t + d1, d1 * t + p, p * t + c2);
    let (d4, d3, d2, d1, p) = (d3, d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c1);
    let (d5, d4, d3, d2, d1, p) = (d4, d4 * t + d3, d3 * t + d2, d2 * t + d1, d1 * t + p, p * t + c0);
    [p, d1, 2.0 * d2, 6.0 * d3, 24.0 * d4, 120.0 * d5]
}

/// A polynomial and its first derivative at `t`.
#[inline]
pub(super) fn value_and_rate(coefficients: &Coefficients, t: f32) -> [f32; 2] {
    let [c0, c1, c2, c3, c4, c5, c6, c7] = *coefficients;
    let (d1, p) = (c7, c7 * t + c6);
    let (d1, p) = (d1 * t + p, p * t + c5);
    let (d1, p) = (d1 * t + p, p * t + c4);
    let (d1, p) = (d1 * t + p, p * t + c3);
    let (d1, p) = (d1 * t + p, p * t + c2);
    let (d1, p) = (d1 * t + p, p * t + c1);
    let (d1, p) = (d1 * t + p, p * t + c0);
    [p, d1]
}
