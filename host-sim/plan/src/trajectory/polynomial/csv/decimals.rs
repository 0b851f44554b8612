//! How far numbers of so many decimals may be off: a table in; the gap that rounding alone can make at a joint out.

use crate::trajectory::polynomial::{Coordinate, Piece};
use crate::trajectory::table::Table;

/// Most that is taken for rounding at a joint, m or rad: a craft still follows the smooth step that closes it.
const LARGEST_ROUNDING: f64 = 0.05;

/// How finely the numbers of a file are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Decimals {
    /// Most digits behind the point.
    places: i32,
    /// Most digits from the first that is not 0.
    significant: i32,
}

impl Decimals {
    pub(super) fn of(table: &Table) -> Self {
        let mut most = Self { places: 0, significant: 1 };
        for cell in table.rows.iter().flat_map(|row| &row.cells) {
            let (mantissa, exponent) = cell.split_once(['e', 'E']).unwrap_or((cell, "0"));
            let exponent: i32 = exponent.parse().unwrap_or(0);
            let behind = mantissa.split_once(['.', ',']).map_or("", |(_, behind)| behind);
            let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
            let digits = digits.trim_start_matches('0');
            most.places = most.places.max(behind.len() as i32 - exponent);
            most.significant = most.significant.max(digits.len() as i32);
        }
        most
    }

    /// How far a number can be from the one that was written, at most: half a unit of the last place. Where more places
    /// are written than there are digits in any number, numbers were cut to significant digits instead.
    pub(super) fn rounding(self, value: f64) -> f64 {
        let fixed = 0.5 * 10_f64.powi(-self.places);
        if self.places <= self.significant || value == 0.0 {
            return fixed;
        }
        let first = value.abs().log10().floor() as i32;
        fixed.max(0.5 * 10_f64.powi(first + 1 - self.significant))
    }

    /// How far two pieces that met can be apart at their joint by the rounding of their numbers, for each coordinate.
    /// Numbers of few places were written by hand, and a coordinate at rest is meant to be.
    pub(super) fn roundings_at_joint(self, before: &Piece, after: &Piece) -> [f64; 4] {
        const FEWEST_PLACES: i32 = 4;
        let t_s = before.duration_s;
        Coordinate::ALL.map(|coordinate| {
            let coefficients = &before.coefficients[coordinate as usize];
            if self.places < FEWEST_PLACES || coefficients[1..].iter().all(|coefficient| *coefficient == 0.0) {
                return 0.0;
            }
            let of_coefficients =
                coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * t_s + self.rounding(*coefficient));
            let of_duration = before.derivative(coordinate, 1, t_s).abs() * self.rounding(t_s);
            let sum = of_coefficients + of_duration + self.rounding(after.coefficients[coordinate as usize][0]);
            sum.min(LARGEST_ROUNDING)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::polynomial::COEFFICIENTS;

    fn decimals(row: &str) -> Decimals {
        Decimals::of(&Table::of(row).unwrap())
    }

    #[test]
    fn rounding_is_that_of_fixed_places_or_of_significant_digits() {
        // C's %.6f and its %g with six digits.
        assert_eq!(decimals("2.000000,-123.456789,0.000100"), Decimals { places: 6, significant: 9 });
        assert_eq!(decimals("2,-123.457,0.0123457,1e-05"), Decimals { places: 7, significant: 6 });
        let (fixed, significant) = (decimals("123.456789"), decimals("123.457,0.0123457"));
        assert_eq!((fixed.rounding(123.4), fixed.rounding(0.1)), (0.5e-6, 0.5e-6));
        assert_eq!((significant.rounding(123.4), significant.rounding(0.02)), (0.5e-3, 0.5e-7));
        // Seven powers of 2 s, half a millionth each, on top of the next piece's own half.
        let piece = Piece { duration_s: 2.0, coefficients: [[0.1; COEFFICIENTS]; 4] };
        let rest = Piece { duration_s: 2.0, coefficients: [[0.0; COEFFICIENTS]; 4] };
        let rounding = fixed.roundings_at_joint(&piece, &rest)[0];
        let velocity_m_s = piece.derivative(Coordinate::X, 1, 2.0);
        assert!((rounding - 0.5e-6 * (255.0 + velocity_m_s + 1.0)).abs() < 1e-18);
    }
}
