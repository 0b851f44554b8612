//! How large a diagonal perturbation a matrix needs at least to become singular: bounds of the structured singular value.
//!
//! In flows M, m x m complex; out flow an upper and a lower bound of `mu(M)` for diagonal complex perturbations.
//! Above: the largest singular value of `D M D^-1` with a diagonal D > 0 that is improved until both singular vectors
//! have entries of equal size. Below: the spectral radius of `U M` with U diagonal and unitary, started from the phases
//! of those vectors and improved by turns. Up to three channels the best D closes the gap (Packard and Doyle 1993).

use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;

use crate::analysis::eigenvalues;

/// Steps of the scaling and of the phases.
const MAX_STEPS: usize = 200;
/// Sweeps of the quick scaling.
const OSBORNE_SWEEPS: usize = 4;

/// Bounds of `mu(M)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StructuredBounds {
    /// An upper bound.
    pub upper: f64,
    /// A lower bound.
    pub lower: f64,
}

/// Bounds of the structured singular value for diagonal complex perturbations; nothing if M is not square and finite.
pub fn structured_bounds(m: &DMatrix<Complex64>) -> Option<StructuredBounds> {
    let (scaled, upper) = scaled_norm(m)?;
    Some(StructuredBounds { upper, lower: lower_bound(m, &scaled).unwrap_or(0.0).min(upper) })
}

/// Only the upper bound.
pub(super) fn structured_upper_bound(m: &DMatrix<Complex64>) -> Option<f64> {
    scaled_norm(m).map(|(_, upper)| upper)
}

/// An upper bound for matrices by the thousand: the smaller of the largest singular values of M and of `D M D^-1`, D such
/// that its row and column sums are nearly equal (Osborne 1960). Both are bounds for any D.
pub(super) fn quick_upper_bound(m: &DMatrix<Complex64>) -> Option<f64> {
    let n = m.nrows();
    if n == 0 || m.ncols() != n || !m.iter().all(|value| value.re.is_finite() && value.im.is_finite()) {
        return None;
    }
    let mut d = DVector::from_element(n, 1.0);
    for _ in 0..OSBORNE_SWEEPS {
        for i in 0..n {
            let others = || (0..n).filter(|j| *j != i);
            let row: f64 = others().map(|j| (m[(i, j)].norm() / d[j]).powi(2)).sum();
            let column: f64 = others().map(|j| (m[(j, i)].norm() * d[j]).powi(2)).sum();
            if row > 0.0 && column > 0.0 {
                // d_i^2 row = column / d_i^2.
                d[i] = (column / row).powf(0.25);
            }
        }
    }
    let norm = |m: &DMatrix<Complex64>| (m.adjoint() * m).symmetric_eigenvalues().max().sqrt();
    let scaled = DMatrix::from_fn(n, n, |i, j| m[(i, j)] * (d[i] / d[j]));
    Some(norm(m).min(norm(&scaled)))
}

/// `D M D^-1` of smallest norm that was found, and that norm.
fn scaled_norm(m: &DMatrix<Complex64>) -> Option<(DMatrix<Complex64>, f64)> {
    let n = m.nrows();
    if n == 0 || m.ncols() != n || !m.iter().all(|value| value.re.is_finite() && value.im.is_finite()) {
        return None;
    }
    if n == 1 {
        return Some((m.clone(), m[(0, 0)].norm()));
    }
    let mut logs = DVector::<f64>::zeros(n);
    let (mut best, mut scaled) = (f64::INFINITY, m.clone());
    let mut step = 0.5;
    let mut gradient = DVector::zeros(n);
    for _ in 0..MAX_STEPS {
        let trial = &logs - &gradient * step;
        let candidate = DMatrix::from_fn(n, n, |i, j| m[(i, j)] * (trial[i] - trial[j]).exp());
        let (u, value, v) = largest_singular(&candidate)?;
        if value < best {
            let gain = best - value;
            (best, scaled, logs) = (value, candidate, trial);
            // d log sigma / d log d_i, zero where both vectors have entries of the same size.
            gradient = DVector::from_fn(n, |i, _| u[i].norm_sqr() - v[i].norm_sqr());
            step = (step * 1.5).min(4.0);
            if gradient.amax() < 1e-9 || gain < 1e-14 * value {
                break;
            }
        } else {
            step *= 0.4;
            if step < 1e-10 {
                break;
            }
        }
    }
    Some((scaled, best))
}

/// Left vector, largest singular value, right vector.
fn largest_singular(m: &DMatrix<Complex64>) -> Option<(DVector<Complex64>, f64, DVector<Complex64>)> {
    let svd = m.clone().try_svd(true, true, f64::EPSILON, 10_000)?;
    let (index, value) = svd.singular_values.iter().enumerate().max_by(|x, y| x.1.total_cmp(y.1))?;
    let (u, v_adjoint) = (svd.u?, svd.v_t?);
    Some((u.column(index).into_owned(), *value, v_adjoint.row(index).adjoint()))
}

/// The largest spectral radius of `U M` that was found.
fn lower_bound(m: &DMatrix<Complex64>, scaled: &DMatrix<Complex64>) -> Option<f64> {
    let n = m.nrows();
    let (u, _, v) = largest_singular(scaled)?;
    let unit = |value: Complex64| if value.norm() > 0.0 { value / value.norm() } else { Complex64::ONE };
    let mut phases: Vec<Complex64> = (0..n).map(|i| unit(v[i] * u[i].conj())).collect();
    let radius = |phases: &[Complex64]| spectral_radius(&DMatrix::from_fn(n, n, |i, j| phases[i] * scaled[(i, j)]));
    let mut best = radius(&phases)?;
    let mut turn_rad = 0.5;
    while turn_rad > 1e-6 {
        let before = best;
        for i in 1..n {
            for sign in [1.0, -1.0] {
                let mut trial = phases.clone();
                trial[i] *= Complex64::from_polar(1.0, sign * turn_rad);
                let value = radius(&trial)?;
                if value > best {
                    (best, phases) = (value, trial);
                }
            }
        }
        if best <= before {
            turn_rad *= 0.5;
        }
    }
    Some(best)
}

/// Of a complex matrix: the real matrix `[re -im; im re]` has its eigenvalues and their conjugates.
pub(super) fn spectral_radius(m: &DMatrix<Complex64>) -> Option<f64> {
    let n = m.nrows();
    let embedded = DMatrix::from_fn(2 * n, 2 * n, |i, j| {
        let value = m[(i % n, j % n)];
        match (i < n, j < n) {
            (true, true) | (false, false) => value.re,
            (true, false) => -value.im,
            (false, true) => value.im,
        }
    });
    Some(eigenvalues(&embedded).ok()?.iter().map(|value| value.norm()).fold(0.0, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quick_bound_is_one_and_not_far_above_the_best() {
        // Dense, triangular, badly scaled: entries of modulus around 1 from a rotation.
        for (spread, triangular) in [(0.0, false), (2.0, false), (0.0, true), (4.0, true)] {
            let entry = |i: usize, j: usize| {
                let size = 1.0 + 0.3 * ((3 * i + 5 * j) as f64).sin();
                let scale = (spread * (i as f64 - j as f64) / 3.0).exp();
                if triangular && j > i {
                    Complex64::ZERO
                } else {
                    Complex64::from_polar(size * scale, (7 * i + 4 * j * j) as f64)
                }
            };
            let m = DMatrix::from_fn(4, 4, entry);
            let best = structured_bounds(&m).unwrap();
            let quick = quick_upper_bound(&m).unwrap();
            assert!(quick >= best.lower && quick >= best.upper * (1.0 - 1e-9), "{quick} below {best:?}");
            // Of a triangular matrix the best scaling is an infinite one, which sweeps do not reach.
            assert!(triangular || quick <= 1.2 * best.upper, "{quick} far above {best:?}");
        }
        assert_eq!(quick_upper_bound(&DMatrix::from_element(2, 2, Complex64::new(f64::NAN, 0.0))), None);
    }
}
