//! First approximations to the stabilising solution, from the Hamiltonian matrix `H = [A -G; -Q -A']`.
//!
//! The columns of `[I; X]` span the invariant subspace of H that belongs to its n stable eigenvalues. Two ways to it,
//! both bounded: the matrix sign function (Roberts 1980; Byers 1987), and the ordered Schur form (Laub 1979). Both work
//! in f64 and lose digits on hard problems; the refinement brings them back. Where they lose them all, 32 digits are taken: for
//! structured doubling, and for the sign function where that fails.

use num_complex::Complex64;

use super::double_double::{Double, DoubleMatrix};
use super::doubling::continuous_doubling;
use super::equation::Equation;
use crate::analysis::{ComplexSchur, complex_schur};

/// Sign iterations at most; 10 are usual.
const MAX_SIGN_STEPS: usize = 80;
/// States up to which 32 digits cost no more than about a second.
const MAX_PRECISE_STATES: usize = 100;

/// X by the scaled Newton iteration for `sign(H)`.
pub(super) fn by_sign_function(equation: &Equation) -> Option<DoubleMatrix> {
    let n = equation.states();
    let mut z = equation.hamiltonian();
    let mut previous = f64::INFINITY;
    for _ in 0..MAX_SIGN_STEPS {
        let inverse = z.clone().try_inverse()?;
        // Norm scaling, switched off once the iteration converges quadratically by itself.
        let scale = if previous > 1e-2 { (inverse.norm() / z.norm()).sqrt() } else { 1.0 };
        if !scale.is_finite() || scale == 0.0 {
            return None;
        }
        let next = (&z * scale + inverse / scale) * 0.5;
        let change = (&next - &z).norm() / next.norm();
        z = next;
        if !change.is_finite() {
            return None;
        }
        if change < 1e-14 || (change < 1e-6 && change > 0.5 * previous) {
            break;
        }
        previous = change;
    }
    // (sign(H) + I) [I; X] = 0, 2n equations for n unknowns a column, by least squares.
    let mut unknowns = z.columns(n, n).into_owned();
    let mut rest = z.columns(0, n).into_owned();
    for i in 0..n {
        unknowns[(n + i, i)] += 1.0;
        rest[(i, i)] += 1.0;
    }
    let qr = unknowns.qr();
    let right = -(qr.q().transpose() * rest);
    symmetric(&DoubleMatrix::new(qr.r().solve_upper_triangular(&right)?))
}

/// X by the sign function in 32 digits: slow, for small problems on which the other two leave no digit.
pub(super) fn by_precise_sign_function(equation: &Equation) -> Option<DoubleMatrix> {
    let n = equation.states();
    if n > MAX_PRECISE_STATES {
        return None;
    }
    let mut z = equation.precise_hamiltonian();
    let mut previous = f64::INFINITY;
    for _ in 0..MAX_SIGN_STEPS {
        let inverse = z.inverse()?;
        let ratio = if previous > 1e-2 { (inverse.hi.norm() / z.hi.norm()).sqrt() } else { 1.0 };
        if !ratio.is_finite() || ratio == 0.0 {
            return None;
        }
        // A power of two, so that the scaling itself is exact.
        let scale = ratio.log2().round().exp2();
        let next = z.scaled(0.5 * scale).plus(&inverse.scaled(0.5 / scale));
        let change = next.minus(&z).hi.norm() / next.hi.norm();
        z = next;
        if !change.is_finite() {
            return None;
        }
        if change < 1e-28 || (change < 1e-10 && change > 0.5 * previous) {
            break;
        }
        previous = change;
    }
    let column = |first: usize, shift: usize| {
        DoubleMatrix::from_fn(2 * n, n, |i, j| {
            let entry = z.get(i, first + j);
            if i == shift + j { entry.plus(Double::new(1.0)) } else { entry }
        })
    };
    // Normal equations: squaring the condition is affordable in 32 digits.
    let (unknowns, rest) = (column(n, n), column(0, 0));
    let transposed = unknowns.transposed();
    let x = transposed.times(&unknowns).solve(&transposed.times(&rest))?;
    symmetric(&x.scaled(-1.0))
}

/// X by doubling in 32 digits, for small problems on which rounding leaves too little of the others.
pub(super) fn by_precise_doubling(equation: &Equation) -> Option<DoubleMatrix> {
    if equation.states() > MAX_PRECISE_STATES { None } else { continuous_doubling(equation) }
}

/// X by the ordered complex Schur form of H.
pub(super) fn by_schur_vectors(equation: &Equation) -> Option<DoubleMatrix> {
    let n = equation.states();
    let mut schur = complex_schur(&equation.hamiltonian()).ok()?;
    // The n eigenvalues furthest left are the stable ones, wherever rounding has put those near the axis.
    let mut by_real_part: Vec<usize> = (0..2 * n).collect();
    let eigenvalues = schur.eigenvalues();
    by_real_part.sort_by(|i, j| eigenvalues[*i].re.total_cmp(&eigenvalues[*j].re));
    let mut wanted = by_real_part[..n].to_vec();
    wanted.sort_unstable();
    for (target, from) in wanted.into_iter().enumerate() {
        for k in (target..from).rev() {
            swap_neighbours(&mut schur, k);
        }
    }
    let basis = schur.unitary.columns(0, n);
    let (upper, lower) = (basis.rows(0, n).into_owned(), basis.rows(n, n).into_owned());
    // X U1 = U2, transposed.
    let x = upper.transpose().lu().solve(&lower.transpose())?;
    symmetric(&DoubleMatrix::new(x.map(|value| value.re)))
}

/// Exchanges the eigenvalues k and k + 1 on the diagonal by one rotation.
fn swap_neighbours(schur: &mut ComplexSchur, k: usize) {
    let t = &mut schur.triangular;
    let n = t.nrows();
    let (first, second, coupling) = (t[(k, k)], t[(k + 1, k + 1)], t[(k, k + 1)]);
    let difference = second - first;
    let norm = coupling.norm().hypot(difference.norm());
    if norm == 0.0 {
        return;
    }
    let (c, s) = (coupling / norm, difference / norm);
    for j in k..n {
        let (upper, lower) = (t[(k, j)], t[(k + 1, j)]);
        t[(k, j)] = c.conj() * upper + s.conj() * lower;
        t[(k + 1, j)] = c * lower - s * upper;
    }
    for (matrix, rows) in [(t, k + 2), (&mut schur.unitary, n)] {
        for i in 0..rows {
            let (left, right) = (matrix[(i, k)], matrix[(i, k + 1)]);
            matrix[(i, k)] = left * c + right * s;
            matrix[(i, k + 1)] = right * c.conj() - left * s.conj();
        }
    }
    schur.triangular[(k + 1, k)] = Complex64::ZERO;
    schur.triangular[(k, k)] = second;
    schur.triangular[(k + 1, k + 1)] = first;
}

/// The symmetric part, if it is finite.
fn symmetric(x: &DoubleMatrix) -> Option<DoubleMatrix> {
    let symmetric = x.symmetrised();
    symmetric.is_finite().then_some(symmetric)
}
