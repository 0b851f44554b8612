//! The closed loop of a gain as it is returned: A, B and a gain of 16 digits in, its poles out.
//!
//! An equation solved in 32 digits has poles of its own. Where A and B are large beside them, the rounding of the gain alone
//! may move them out of the stable region, and the rounded gain is what is flown.

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::double_double::DoubleMatrix;
use crate::analysis::{MatrixError, eigenvalues};

/// Eigenvalues of `A - B K`, sorted by real part: with the product rounded once, so that K's own rounding alone counts, and with the
/// product in 16 digits, as whoever flies it computes it. Where these differ in what they say, nothing is known of the loop.
pub(super) fn poles(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    gain: &DMatrix<f64>,
) -> Result<[Vec<Complex64>; 2], MatrixError> {
    let driven = DoubleMatrix::new(b.clone()).times(&DoubleMatrix::new(gain.clone()));
    Ok([eigenvalues(&DoubleMatrix::new(a.clone()).minus(&driven).hi)?, eigenvalues(&(a - b * gain))?])
}
