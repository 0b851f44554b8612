//! Schur form by the Francis double-shift QR iteration, bounded.
//!
//! In flows a square matrix; out flow its eigenvalues, or `A = U T U*` with `T` upper triangular and `U` unitary. The
//! iteration runs in real arithmetic, so complex eigenvalues come in exact conjugate pairs; its 2x2 blocks are then
//! split by complex rotations. Deflation compares a subdiagonal entry with its neighbours on the diagonal; every tenth
//! sweep takes an exceptional shift, and a bound on the sweeps turns a stall into an error.
//! Reference: Golub and Van Loan, Matrix Computations, 4th edition, sections 7.4 and 7.5.

use nalgebra::{DMatrix, Hessenberg};
use num_complex::Complex64;

use super::{MatrixError, balance, require_square};

/// Sweeps allowed for one eigenvalue; 2 or 3 are usual.
const MAX_SWEEPS: usize = 100;

/// `A = U T U*`.
#[derive(Debug, Clone)]
pub(crate) struct ComplexSchur {
    pub(crate) unitary: DMatrix<Complex64>,
    pub(crate) triangular: DMatrix<Complex64>,
}

impl ComplexSchur {
    /// Eigenvalues in the order of the diagonal.
    pub(crate) fn eigenvalues(&self) -> Vec<Complex64> {
        self.triangular.diagonal().iter().copied().collect()
    }
}

/// Eigenvalues of a square matrix, sorted by real part and then by imaginary part; complex ones in exact pairs.
///
/// The matrix is balanced first. Each is exact for a matrix within some `n eps |A|` of the (balanced) one: a defective
/// eigenvalue with a Jordan block of size k is therefore only found to `eps^(1/k)`.
///
/// # Errors
/// [`MatrixError`] for a matrix that is not square, empty or not finite, or if the iteration reaches its bound.
pub fn eigenvalues(a: &DMatrix<f64>) -> Result<Vec<Complex64>, MatrixError> {
    require_square("A", a)?;
    let (t, _) = real_schur(&balance(a).0)?;
    let n = t.nrows();
    let mut values = Vec::with_capacity(n);
    let mut i = 0;
    while i < n {
        if i + 1 < n && t[(i + 1, i)] != 0.0 {
            let (re, im) = block_eigenvalue(&t, i);
            values.extend([Complex64::new(re, -im), Complex64::new(re, im)]);
            i += 2;
        } else {
            // Adding zero makes -0 a plain 0.
            values.push(Complex64::new(t[(i, i)] + 0.0, 0.0));
            i += 1;
        }
    }
    values.sort_by(|x, y| x.re.total_cmp(&y.re).then(x.im.total_cmp(&y.im)));
    Ok(values)
}

/// Largest real part of the eigenvalues: negative means asymptotically stable.
///
/// # Errors
/// As [`eigenvalues`].
pub fn spectral_abscissa(a: &DMatrix<f64>) -> Result<f64, MatrixError> {
    Ok(eigenvalues(a)?.iter().map(|value| value.re).fold(f64::NEG_INFINITY, f64::max))
}

/// Complex Schur form of a square, finite matrix, without balancing.
pub(crate) fn complex_schur(a: &DMatrix<f64>) -> Result<ComplexSchur, MatrixError> {
    require_square("A", a)?;
    let (t, q) = real_schur(a)?;
    let n = t.nrows();
    let mut triangular = t.map(|value| Complex64::new(value, 0.0));
    let mut unitary = q.map(|value| Complex64::new(value, 0.0));
    for k in 0..n.saturating_sub(1) {
        if t[(k + 1, k)] == 0.0 {
            continue;
        }
        let (re, im) = block_eigenvalue(&t, k);
        // First column of the rotation: the block's eigenvector, from its second row.
        let (x, y) = (Complex64::new(re - t[(k + 1, k + 1)], im), t[(k + 1, k)]);
        let norm = x.norm().hypot(y);
        let (c, s) = (x / norm, y / norm);
        for j in k..n {
            let (upper, lower) = (triangular[(k, j)], triangular[(k + 1, j)]);
            triangular[(k, j)] = c.conj() * upper + lower * s;
            triangular[(k + 1, j)] = c * lower - upper * s;
        }
        for (matrix, rows) in [(&mut triangular, k + 2), (&mut unitary, n)] {
            for i in 0..rows {
                let (left, right) = (matrix[(i, k)], matrix[(i, k + 1)]);
                matrix[(i, k)] = left * c + right * s;
                matrix[(i, k + 1)] = right * c.conj() - left * s;
            }
        }
        triangular[(k + 1, k)] = Complex64::ZERO;
    }
    Ok(ComplexSchur { unitary, triangular })
}

/// Real and imaginary part of a 2x2 block with complex eigenvalues that starts at `k`.
fn block_eigenvalue(t: &DMatrix<f64>, k: usize) -> (f64, f64) {
    let half_difference = 0.5 * (t[(k, k)] - t[(k + 1, k + 1)]);
    let discriminant = half_difference * half_difference + t[(k, k + 1)] * t[(k + 1, k)];
    (t[(k + 1, k + 1)] + half_difference, (-discriminant).max(0.0).sqrt())
}

/// `A = Q T Q'` with `T` quasi-triangular; the 2x2 blocks that remain have complex eigenvalues.
///
/// The sweeps stall on about one in a hundred matrices with a cluster of equal eigenvalues, and seldom on the same matrix in
/// the reversed order of its states.
fn real_schur(a: &DMatrix<f64>) -> Result<(DMatrix<f64>, DMatrix<f64>), MatrixError> {
    by_sweeps(a).or_else(|stalled| {
        let last = a.nrows() - 1;
        let reversed = DMatrix::from_fn(a.nrows(), a.nrows(), |i, j| a[(last - i, last - j)]);
        let (t, q) = by_sweeps(&reversed).map_err(|_| stalled)?;
        Ok((t, DMatrix::from_fn(q.nrows(), q.ncols(), |i, j| q[(last - i, j)])))
    })
}

/// As [`real_schur`], in the given order of the states.
fn by_sweeps(a: &DMatrix<f64>) -> Result<(DMatrix<f64>, DMatrix<f64>), MatrixError> {
    let n = a.nrows();
    if n < 2 {
        return Ok((a.clone(), DMatrix::identity(n, n)));
    }
    let (mut q, mut h) = Hessenberg::new(a.clone()).unpack();
    let norm = h.norm();
    let mut high = n - 1;
    let mut sweeps = 0;
    while high > 0 {
        let mut low = high;
        while low > 0 {
            let neighbours = h[(low - 1, low - 1)].abs() + h[(low, low)].abs();
            let size = if neighbours == 0.0 { norm } else { neighbours };
            if h[(low, low - 1)].abs() <= f64::EPSILON * size {
                h[(low, low - 1)] = 0.0;
                break;
            }
            low -= 1;
        }
        if low == high {
            high -= 1;
            sweeps = 0;
        } else if low + 1 == high {
            split_real_pair(&mut h, &mut q, low);
            high = high.saturating_sub(2);
            sweeps = 0;
        } else if sweeps == MAX_SWEEPS {
            return Err(MatrixError::EigenvaluesNotFound { name: "A", iterations: MAX_SWEEPS });
        } else {
            sweeps += 1;
            francis_sweep(&mut h, &mut q, low, high, sweeps % 10 == 0);
        }
    }
    Ok((h, q))
}

/// Makes a 2x2 block triangular if its eigenvalues are real.
fn split_real_pair(h: &mut DMatrix<f64>, q: &mut DMatrix<f64>, k: usize) {
    let n = h.nrows();
    let p = 0.5 * (h[(k, k)] - h[(k + 1, k + 1)]);
    let discriminant = p * p + h[(k, k + 1)] * h[(k + 1, k)];
    if discriminant < 0.0 {
        return;
    }
    // Eigenvalue h11 + z of the larger distance from h11: no cancellation.
    let z = p + discriminant.sqrt().copysign(p);
    let norm = h[(k + 1, k)].hypot(z);
    let (s, c) = (h[(k + 1, k)] / norm, z / norm);
    for j in k..n {
        let (upper, lower) = (h[(k, j)], h[(k + 1, j)]);
        h[(k, j)] = c * upper + s * lower;
        h[(k + 1, j)] = c * lower - s * upper;
    }
    for (matrix, rows) in [(&mut *h, k + 2), (q, n)] {
        for i in 0..rows {
            let (left, right) = (matrix[(i, k)], matrix[(i, k + 1)]);
            matrix[(i, k)] = c * left + s * right;
            matrix[(i, k + 1)] = c * right - s * left;
        }
    }
    h[(k + 1, k)] = 0.0;
}

/// One implicit double-shift sweep over the active block `low..=high`, which has at least three rows.
fn francis_sweep(h: &mut DMatrix<f64>, q: &mut DMatrix<f64>, low: usize, high: usize, exceptional: bool) {
    let (first, second, product) = if exceptional {
        // The ad hoc shift of LAPACK: breaks the cycles that the usual shift runs into on, say, permutations.
        let w = h[(high, high - 1)].abs() + h[(high - 1, high - 2)].abs();
        (0.75 * w + h[(high, high)], 0.75 * w + h[(high, high)], -0.4375 * w * w)
    } else {
        (h[(high - 1, high - 1)], h[(high, high)], h[(high - 1, high)] * h[(high, high - 1)])
    };
    let (h00, h11, h10) = (h[(low, low)], h[(low + 1, low + 1)], h[(low + 1, low)]);
    // First column of (H - s1)(H - s2), divided by h10 so that it neither overflows nor cancels.
    let mut x = ((h00 - first) * (h00 - second) - product) / h10 + h[(low, low + 1)];
    let mut y = (h11 - second) + (h00 - first);
    let mut z = h[(low + 2, low + 1)];
    for k in low..high {
        let size = if k + 1 < high { 3 } else { 2 };
        if size == 2 {
            z = 0.0;
        }
        let scale = x.abs().max(y.abs()).max(z.abs());
        if scale > 0.0 {
            reflect(h, q, [x / scale, y / scale, z / scale], k, size, low, high);
        }
        x = h[(k + 1, k)];
        if k + 2 <= high {
            y = h[(k + 2, k)];
        }
        z = if k + 3 <= high { h[(k + 3, k)] } else { 0.0 };
    }
    // Each reflection has made these zero but for rounding.
    for k in low + 2..=high {
        for j in low..k - 1 {
            h[(k, j)] = 0.0;
        }
    }
}

/// Applies the reflection that maps `vector` onto the first axis to rows and columns `k..k + size`.
fn reflect(
    h: &mut DMatrix<f64>,
    q: &mut DMatrix<f64>,
    vector: [f64; 3],
    k: usize,
    size: usize,
    low: usize,
    high: usize,
) {
    let n = h.nrows();
    let norm = vector.iter().map(|v| v * v).sum::<f64>().sqrt();
    let alpha = -norm.copysign(vector[0]);
    let v = [vector[0] - alpha, vector[1], vector[2]];
    let beta = 2.0 / v.iter().map(|v| v * v).sum::<f64>();
    if !beta.is_finite() {
        return;
    }
    for j in k.saturating_sub(1).max(low)..n {
        let sum = beta * (0..size).map(|i| v[i] * h[(k + i, j)]).sum::<f64>();
        for i in 0..size {
            h[(k + i, j)] -= sum * v[i];
        }
    }
    let last = (k + 3).min(high);
    for (matrix, rows) in [(h, last + 1), (q, n)] {
        for i in 0..rows {
            let sum = beta * (0..size).map(|j| matrix[(i, k + j)] * v[j]).sum::<f64>();
            for j in 0..size {
                matrix[(i, k + j)] -= sum * v[j];
            }
        }
    }
}
