//! Jordan block sizes at an eigenvalue, from the ranks of the powers of `A - lambda I`.
//!
//! With `r_k = rank (A - lambda I)^k` and `r_0 = n`, exactly `r_(k-1) - r_k` blocks have size k or more. The Jordan form
//! is not continuous in A: the answer holds for the matrix as given, within the stated tolerance.

use nalgebra::DMatrix;
use num_complex::Complex64;
use serde::Serialize;

use super::singular::{complex_singular_values, rank_above};
use super::{MatrixError, require_square};

/// Jordan blocks at one eigenvalue, and the ranks they were read from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JordanStructure {
    /// Real and imaginary part of the eigenvalue, 1/s.
    pub eigenvalue: [f64; 2],
    /// Sizes of the blocks, largest first; their sum is the algebraic multiplicity. Empty if it is no eigenvalue.
    pub block_sizes: Vec<usize>,
    /// `rank (A - lambda I)^k` for k = 1, 2, ... until it no longer falls.
    pub ranks: Vec<usize>,
    /// Singular values of the k-th power of `(A - lambda I) / |A - lambda I|` count as zero up to k times this.
    pub tolerance: f64,
}

/// Jordan block sizes of a square matrix at `eigenvalue`.
///
/// The powers are taken of the matrix divided by its largest singular value, and a singular value of the k-th power
/// counts as zero up to `k n eps`, the rounding of k products.
///
/// # Errors
/// [`MatrixError`] for a matrix that is not square, empty or not finite.
pub fn jordan_blocks(a: &DMatrix<f64>, eigenvalue: Complex64) -> Result<JordanStructure, MatrixError> {
    require_square("A", a)?;
    let n = a.nrows();
    let tolerance = n as f64 * f64::EPSILON;
    let mut shifted = a.map(|value| Complex64::new(value, 0.0));
    for i in 0..n {
        shifted[(i, i)] -= eigenvalue;
    }
    let norm = complex_singular_values(&shifted)[0];
    if norm > 0.0 {
        shifted.unscale_mut(norm);
    }
    let mut ranks = Vec::new();
    let mut power = DMatrix::<Complex64>::identity(n, n);
    let mut previous = n;
    for k in 1..=n {
        power *= &shifted;
        let rank = rank_above(complex_singular_values(&power), k as f64 * tolerance).rank;
        ranks.push(rank);
        if rank == previous {
            break;
        }
        previous = rank;
    }
    // at_least[k - 1]: how many blocks have size k or more.
    let at_least: Vec<usize> =
        std::iter::once(n).chain(ranks.iter().copied()).zip(&ranks).map(|(before, after)| before - after).collect();
    let blocks = at_least.first().copied().unwrap_or(0);
    let block_sizes = (0..blocks).map(|block| at_least.iter().filter(|count| **count > block).count()).collect();
    Ok(JordanStructure { eigenvalue: [eigenvalue.re, eigenvalue.im], block_sizes, ranks, tolerance })
}

/// Groups eigenvalues that lie within `radius` of each other; each group is its mean and its size.
///
/// The mean of a group is far better conditioned than its members: where a Jordan block scatters them by
/// `eps^(1/k)`, their mean stays within some eps.
pub fn distinct_eigenvalues(eigenvalues: &[Complex64], radius: f64) -> Vec<(Complex64, usize)> {
    let mut remaining: Vec<Complex64> = eigenvalues.to_vec();
    let mut groups = Vec::new();
    while let Some(seed) = remaining.pop() {
        let mut group = vec![seed];
        let mut next = 0;
        while next < group.len() {
            let centre = group[next];
            let (near, far) = remaining.into_iter().partition(|value| (value - centre).norm() <= radius);
            remaining = far;
            group.extend::<Vec<_>>(near);
            next += 1;
        }
        groups.push((group.iter().sum::<Complex64>() / group.len() as f64, group.len()));
    }
    groups.sort_by(|x, y| x.0.re.total_cmp(&y.0.re).then(x.0.im.total_cmp(&y.0.im)));
    groups
}
