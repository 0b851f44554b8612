//! Gains over time as they are flown: a design in; the gain at each knot out, in the f32 of the table.

use nalgebra::SMatrix;

use crate::certify::CertifyError;
use crate::certify::rounding::Rounding;
use crate::design::along::GainsAlong;
use crate::design::codegen::rounded_along;

/// The gains in the table, in the digits of an f64.
pub(super) fn flown(designed: &GainsAlong) -> Result<Vec<SMatrix<f64, 4, 9>>, CertifyError> {
    let flown: Vec<SMatrix<f64, 4, 9>> = rounded_along(designed)
        .iter()
        .map(|rows| SMatrix::from_fn(|row, column| f64::from(rows[row][column])))
        .collect();
    for (flown, designed) in flown.iter().zip(&designed.gains) {
        if let Some(at) = flown.iter().position(|entry| !entry.is_finite()) {
            let (row, column) = (at % 4, at / 4);
            return Err(CertifyError::NotSinglePrecision { row, column, value: designed[(row, column)] });
        }
    }
    Ok(flown)
}

/// How far the gains at the knots are from those designed.
pub(super) fn rounding(designed: &GainsAlong, flown: &[SMatrix<f64, 4, 9>]) -> Rounding {
    let entries = designed.gains.iter().zip(flown).flat_map(|(designed, flown)| designed.iter().zip(flown.iter()));
    entries.filter(|(designed, _)| **designed != 0.0).fold(
        Rounding { largest_absolute: 0.0, largest_relative: 0.0 },
        |held, (designed, flown)| {
            let difference = (designed - flown).abs();
            Rounding {
                largest_absolute: held.largest_absolute.max(difference),
                largest_relative: held.largest_relative.max(difference / designed.abs()),
            }
        },
    )
}
