//! A trajectory flown slower, backwards, elsewhere, turned or larger: pieces in, pieces out.

use nalgebra::{Rotation3, Vector3};

use super::polynomial::{COEFFICIENTS, Coordinate, Piece, PiecewisePolynomial, PolynomialError};

/// The steps of a transform, in this order: size, turn and place, then time. Nothing by default.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Duration over that of the original; positive. 2 flies half as fast.
    pub time_scale: f64,
    /// Distances from the start over those of the original; positive.
    pub scale: f64,
    /// Turn about the vertical through the start, rad; the heading turns with it.
    pub turn_rad: f64,
    /// Where the original's start goes, m; stays by default.
    pub start_m: Option<Vector3<f64>>,
    /// Added to every position, m.
    pub shift_m: Vector3<f64>,
    /// From the end to the start.
    pub reverse: bool,
}

impl Default for Transform {
    fn default() -> Self {
        Self { time_scale: 1.0, scale: 1.0, turn_rad: 0.0, start_m: None, shift_m: Vector3::zeros(), reverse: false }
    }
}

impl Transform {
    /// Where a point goes, of a trajectory whose original starts at `origin_m`.
    pub fn point(&self, origin_m: &Vector3<f64>, position_m: &Vector3<f64>) -> Vector3<f64> {
        let start_m = self.start_m.unwrap_or(*origin_m) + self.shift_m;
        start_m + self.vector(&(position_m - origin_m))
    }

    /// Where a difference of points goes.
    pub fn vector(&self, difference: &Vector3<f64>) -> Vector3<f64> {
        let scaled = difference * self.scale;
        // A turn by nothing changes no bit.
        if self.turn_rad == 0.0 {
            scaled
        } else {
            Rotation3::from_axis_angle(&Vector3::z_axis(), self.turn_rad) * scaled
        }
    }

    /// The transformed trajectory. With `reverse`, `start_m` is where it starts then.
    ///
    /// # Errors
    /// [`PolynomialError`] if a coefficient or a duration leaves the range of numbers.
    pub fn apply(&self, trajectory: &PiecewisePolynomial) -> Result<PiecewisePolynomial, PolynomialError> {
        if *self == Self::default() {
            return Ok(trajectory.clone());
        }
        let mut pieces = trajectory.pieces().to_vec();
        if self.reverse {
            pieces = pieces.iter().rev().map(reversed).collect();
        }
        let origin_m = Vector3::from_fn(|axis, _| pieces[0].coefficients[axis][0]);
        for piece in &mut pieces {
            self.apply_to_piece(&origin_m, piece);
        }
        PiecewisePolynomial::joined(pieces)
    }

    fn apply_to_piece(&self, origin_m: &Vector3<f64>, piece: &mut Piece) {
        for power in 0..COEFFICIENTS {
            let coefficient = Vector3::from_fn(|axis, _| piece.coefficients[axis][power]);
            let moved = if power == 0 { self.point(origin_m, &coefficient) } else { self.vector(&coefficient) };
            (0..3).for_each(|axis| piece.coefficients[axis][power] = moved[axis]);
        }
        piece.coefficients[Coordinate::Yaw as usize][0] += self.turn_rad;
        piece.duration_s *= self.time_scale;
        for coefficients in &mut piece.coefficients {
            let mut unit = 1.0;
            for coefficient in coefficients {
                *coefficient /= unit;
                unit *= self.time_scale;
            }
        }
    }
}

/// The piece flown from its end: Taylor coefficients at the end, odd ones with the other sign.
fn reversed(piece: &Piece) -> Piece {
    let mut coefficients = [[0.0; COEFFICIENTS]; 4];
    for coordinate in Coordinate::ALL {
        let mut factorial = 1.0;
        for (power, coefficient) in coefficients[coordinate as usize].iter_mut().enumerate() {
            factorial *= power.max(1) as f64;
            let sign = if power % 2 == 0 { 1.0 } else { -1.0 };
            *coefficient = sign * piece.derivative(coordinate, power, piece.duration_s) / factorial;
        }
    }
    Piece { coefficients, ..*piece }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::Trajectory;

    fn original() -> PiecewisePolynomial {
        let mut first = Piece { duration_s: 2.0, coefficients: [[0.0; COEFFICIENTS]; 4] };
        first.coefficients[0] = [1.0, 0.5, -0.25, 0.1, 0.03, -0.02, 0.01, -0.002];
        first.coefficients[2][0] = 1.0;
        first.coefficients[3][1] = 0.2;
        let mut second = Piece { duration_s: 1.5, coefficients: [[0.0; COEFFICIENTS]; 4] };
        for coordinate in Coordinate::ALL {
            second.coefficients[coordinate as usize][0] = first.derivative(coordinate, 0, 2.0);
        }
        second.coefficients[1][2] = 0.7;
        PiecewisePolynomial::new(vec![first, second]).unwrap()
    }

    #[test]
    fn backwards_and_slower_is_the_original_at_another_time() {
        let original = original();
        let transform = Transform { time_scale: 2.0, reverse: true, ..Transform::default() };
        let flown = transform.apply(&original).unwrap();
        assert_eq!(flown.duration_s(), 7.0);
        for t_s in [0.1, 1.0, 2.9, 3.1, 6.9] {
            let (there, here) = (original.at(3.5 - 0.5 * t_s), flown.at(t_s));
            // Taylor shifts of numbers below 10 by 2 s: some roundings of 1e-15 times 2^7.
            assert!((there.position_m - here.position_m).norm() < 1e-13);
            assert!((there.velocity_m_s * -0.5 - here.velocity_m_s).norm() < 1e-12);
            assert!((there.jerk_m_s3 * -0.125 - here.jerk_m_s3).norm() < 1e-12);
            assert!((there.heading_rad - here.heading_rad).abs() < 1e-13);
        }
    }

    #[test]
    fn elsewhere_turned_and_larger() {
        let original = original();
        let transform = Transform {
            scale: 2.0,
            turn_rad: std::f64::consts::FRAC_PI_2,
            start_m: Some(Vector3::new(10.0, 0.0, 3.0)),
            ..Transform::default()
        };
        let flown = transform.apply(&original).unwrap();
        let moved = original.at(1.0).position_m.x - 1.0;
        let expected = Vector3::new(10.0, 2.0 * moved, 3.0);
        assert!((flown.at(1.0).position_m - expected).norm() < 1e-14);
        assert!((flown.at(1.0).heading_rad - 0.2 - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        // Nothing asked for changes no bit.
        assert_eq!(Transform::default().apply(&original), Ok(original));
    }
}
