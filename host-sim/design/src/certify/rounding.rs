//! Gains as they are flown: entries in f64 in; the nearest f32 of each out, or which entry has none.

use nalgebra::DMatrix;
use serde::Serialize;

use super::CertifyError;

/// Distance of the gain as flown from the gain as designed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Rounding {
    /// Largest difference of an entry.
    pub largest_absolute: f64,
    /// Largest difference of an entry over that entry; at most 2^-24 unless an entry is below 1e-38.
    pub largest_relative: f64,
}

/// Every entry the nearest f32.
pub(super) fn single_precision(gain: &DMatrix<f64>) -> Result<DMatrix<f64>, CertifyError> {
    for column in 0..gain.ncols() {
        for row in 0..gain.nrows() {
            let value = gain[(row, column)];
            if !(value as f32).is_finite() {
                return Err(CertifyError::NotSinglePrecision { row, column, value });
            }
        }
    }
    Ok(gain.map(|value| f64::from(value as f32)))
}
