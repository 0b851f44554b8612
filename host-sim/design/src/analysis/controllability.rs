//! The states that the input reaches: the controllability matrix (10), the orthogonal staircase (11), the PBH test.
//!
//! In flows a pair (A, B); out flow ranks with their tolerances and the orthogonal T that separates the two parts. The
//! staircase is Rosenbrock's: rank-revealing QR row compressions only, so `T A T'` and `T B` are exact for a pair
//! within rounding of the given one (Paige 1981). The controllability matrix is there because the paper argues with
//! it; where the two disagree, believe the staircase.

mod compress;

use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use serde::Serialize;

use super::singular::{NumericalRank, complex_singular_values, numerical_rank, rank_above};
use super::{MatrixError, require_finite, require_square};
use compress::{compress_rows, echelon};

/// The pair in staircase form (11), the uncontrollable part first.
#[derive(Debug, Clone)]
pub struct Staircase {
    /// Orthogonal T, n x n: a row is one new state as a combination of the old ones.
    pub transformation: DMatrix<f64>,
    /// `T A T' = [A_u 0; A_cu A_c]`, n x n.
    pub a: DMatrix<f64>,
    /// `T B = [0; B_c]`, n x m.
    pub b: DMatrix<f64>,
    /// Dimension of the uncontrollable part.
    pub uncontrollable: usize,
    /// Sizes of the steps of the controllable part, top to bottom; the last one is driven by B itself.
    pub steps: Vec<usize>,
    /// A pivot counts as zero up to this share of the norm of A, or of B for the last step.
    pub tolerance: f64,
}

impl Staircase {
    /// `A_u`, the uncontrollable part.
    pub fn uncontrollable_a(&self) -> DMatrix<f64> {
        let size = self.uncontrollable;
        self.a.view((0, 0), (size, size)).into_owned()
    }

    /// `A_cu`, the coupling from the uncontrollable part to the controllable one.
    pub fn coupling(&self) -> DMatrix<f64> {
        let split = self.uncontrollable;
        self.a.view((split, 0), (self.a.nrows() - split, split)).into_owned()
    }

    /// `(A_c, B_c)`, the controllable pair (14).
    pub fn controllable_pair(&self) -> (DMatrix<f64>, DMatrix<f64>) {
        let split = self.uncontrollable;
        let size = self.a.nrows() - split;
        (self.a.view((split, split), (size, size)).into_owned(), self.b.rows(split, size).into_owned())
    }

    /// `S_c T` of (14): the rows of T that span the controllable part.
    pub fn controllable_rows(&self) -> DMatrix<f64> {
        let split = self.uncontrollable;
        self.transformation.rows(split, self.a.nrows() - split).into_owned()
    }
}

/// `[B, A B, ..., A^(n-1) B]`, equation (10), n x nm.
///
/// # Errors
/// [`MatrixError`] for matrices that do not fit, are empty or not finite.
pub fn controllability_matrix(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Result<DMatrix<f64>, MatrixError> {
    require_pair(a, b)?;
    let (n, m) = b.shape();
    let mut matrix = DMatrix::zeros(n, n * m);
    let mut block = b.clone();
    for k in 0..n {
        matrix.columns_mut(k * m, m).copy_from(&block);
        block = a * block;
    }
    Ok(matrix)
}

/// The orthogonal controllability staircase of a pair.
///
/// Pivots count as zero up to `10 max(n, m) eps` of the norm of A (of B for the first step). Within each step the rows
/// are brought to echelon form in the order of the old states, with positive leading entries: where the steps are
/// spanned by states, as in the paper, T is a permutation that keeps their order.
///
/// # Errors
/// [`MatrixError`] for matrices that do not fit, are empty or not finite.
pub fn staircase(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Result<Staircase, MatrixError> {
    require_pair(a, b)?;
    let (n, m) = b.shape();
    let tolerance = 10.0 * n.max(m) as f64 * f64::EPSILON;
    let (norm_a, norm_b) = (a.norm(), b.norm());
    // Rows of `remaining` span the states that no step has reached yet; each step splits off those that the last one
    // drives.
    let mut remaining = DMatrix::<f64>::identity(n, n);
    let mut coupling = b.clone();
    let mut threshold = tolerance * norm_b;
    let mut steps: Vec<DMatrix<f64>> = Vec::new();
    while remaining.nrows() > 0 {
        let rank = compress_rows(coupling, threshold, &mut remaining);
        if rank == 0 {
            break;
        }
        let step = echelon(remaining.rows(0, rank).into_owned());
        remaining = remaining.rows(rank, remaining.nrows() - rank).into_owned();
        coupling = &remaining * (a * step.transpose());
        threshold = tolerance * norm_a;
        steps.push(step);
    }
    let uncontrollable = remaining.nrows();
    let mut transformation = DMatrix::zeros(n, n);
    let mut row = 0;
    let first = if uncontrollable > 0 { Some(echelon(remaining)) } else { None };
    for basis in first.iter().chain(steps.iter().rev()) {
        transformation.rows_mut(row, basis.nrows()).copy_from(basis);
        row += basis.nrows();
    }
    Ok(Staircase {
        a: &transformation * a * transformation.transpose(),
        b: &transformation * b,
        transformation,
        uncontrollable,
        steps: steps.iter().rev().map(DMatrix::nrows).collect(),
        tolerance,
    })
}

/// Rank test of Popov, Belevitch and Hautus at one eigenvalue.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PbhTest {
    /// Real and imaginary part of the eigenvalue, 1/s.
    pub eigenvalue: [f64; 2],
    /// Rank of `[lambda I - A, B]`; n if the eigenvalue is controllable.
    pub rank: usize,
    /// Singular values up to this count as zero: `max(n, m) eps` of the largest.
    pub tolerance: f64,
    /// Smallest singular value: how far the pair is from one that cannot move this eigenvalue.
    pub smallest_singular_value: f64,
    /// Whether the input can move this eigenvalue.
    pub controllable: bool,
    /// Whether it needs moving: its real part is not negative.
    pub unstable: bool,
}

/// Tests whether the input of the pair can move `eigenvalue`; a pair is stabilisable if it can move all the unstable
/// ones.
///
/// # Errors
/// [`MatrixError`] for matrices that do not fit, are empty or not finite.
pub fn pbh_test(a: &DMatrix<f64>, b: &DMatrix<f64>, eigenvalue: Complex64) -> Result<PbhTest, MatrixError> {
    require_pair(a, b)?;
    let (n, m) = b.shape();
    let pencil = DMatrix::from_fn(n, n + m, |i, j| {
        if j < n {
            let shift = if i == j { eigenvalue } else { Complex64::ZERO };
            shift - a[(i, j)]
        } else {
            Complex64::new(b[(i, j - n)], 0.0)
        }
    });
    let values = complex_singular_values(&pencil);
    let tolerance = n.max(m) as f64 * f64::EPSILON * values[0];
    let smallest_singular_value = values[n - 1];
    let NumericalRank { rank, .. } = rank_above(values, tolerance);
    Ok(PbhTest {
        eigenvalue: [eigenvalue.re, eigenvalue.im],
        rank,
        tolerance,
        smallest_singular_value,
        controllable: rank == n,
        unstable: eigenvalue.re >= 0.0,
    })
}

/// Whether the input of the pair can move `eigenvalue`: by the triangular factor of the pencil where that leaves no doubt, a
/// hundredth of the work of [`pbh_test`], which decides else.
pub(crate) fn moves(a: &DMatrix<f64>, b: &DMatrix<f64>, eigenvalue: Complex64) -> Result<bool, MatrixError> {
    require_pair(a, b)?;
    let (n, m) = b.shape();
    // Its adjoint, n + m rows: the triangular factor has the pencil's singular values.
    let adjoint = DMatrix::from_fn(n + m, n, |i, j| {
        if i < n {
            let shift = if i == j { eigenvalue } else { Complex64::ZERO };
            (shift - a[(j, i)]).conj()
        } else {
            Complex64::new(b[(j, i - n)], 0.0)
        }
    });
    let norm = adjoint.norm();
    // The inverse's Frobenius norm bounds the smallest singular value from below. The test's own tolerance is `max(n, m) eps` of
    // the largest, and the factor is off by some roundings of the norm.
    let bound = inverse_norm(&adjoint.qr().r()).map(|norm| 1.0 / norm);
    let doubtless = 100.0 * n.max(m) as f64 * f64::EPSILON * norm;
    match bound {
        Some(bound) if bound > doubtless => Ok(true),
        _ => Ok(pbh_test(a, b, eigenvalue)?.controllable),
    }
}

/// Frobenius norm of the inverse of an upper triangular matrix; nothing if a diagonal entry is zero.
fn inverse_norm(r: &DMatrix<Complex64>) -> Option<f64> {
    let n = r.nrows();
    let mut sum = 0.0;
    for j in 0..n {
        // Column j of the inverse ends at row j.
        let mut column = DVector::zeros(j + 1);
        column[j] = Complex64::ONE;
        if !r.view((0, 0), (j + 1, j + 1)).solve_upper_triangular_mut(&mut column) {
            return None;
        }
        sum += column.norm_squared();
    }
    Some(sum.sqrt())
}

/// Rank of the controllability matrix, its columns brought to length 1 first (which leaves the rank and removes the
/// growth of the powers of A).
pub(crate) fn controllability_rank(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Result<NumericalRank, MatrixError> {
    let mut matrix = controllability_matrix(a, b)?;
    for mut column in matrix.column_iter_mut() {
        let norm = column.norm();
        if norm > 0.0 && norm.is_finite() {
            column.unscale_mut(norm);
        }
    }
    Ok(numerical_rank(&matrix))
}

fn require_pair(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Result<(), MatrixError> {
    require_square("A", a)?;
    require_finite("B", b)?;
    if b.nrows() == a.nrows() {
        return Ok(());
    }
    let (rows, columns) = b.shape();
    Err(MatrixError::Dimension {
        name: "B",
        rows,
        columns,
        expected_rows: a.nrows(),
        expected_columns: columns,
        fits: "A",
    })
}
