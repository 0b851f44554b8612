//! Cutting numbers and horizontal vectors to a bound, by comparisons: `f32::clamp` may panic, and `f32::min` is a library call
//! on the Cortex-M4. A NaN stays one, so that a later check finds it.

use crate::math::sqrt;

/// Cut to `[-bound, bound]`.
#[inline(always)]
pub(super) fn within(value: f32, bound: f32) -> f32 {
    if value > bound {
        bound
    } else if value < -bound {
        -bound
    } else {
        value
    }
}

/// Cut to `[least, most]`; where these cross, `least`.
#[inline(always)]
pub(super) fn between(value: f32, least: f32, most: f32) -> f32 {
    let below = if value > most { most } else { value };
    if below < least { least } else { below }
}

/// Whether a number is beyond a bound either way, or NaN.
#[inline(always)]
pub(super) fn is_beyond(value: f32, bound: f32) -> bool {
    let is_within = value.abs() <= bound;
    !is_within
}

/// The smaller of two numbers.
#[inline(always)]
pub(super) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The larger of two numbers.
#[inline(always)]
pub(super) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// A horizontal vector, shortened to the length `bound`.
#[inline(always)]
pub(super) fn shortened([x, y]: [f32; 2], bound: f32) -> [f32; 2] {
    let squared = x * x + y * y;
    if squared <= bound * bound {
        return [x, y];
    }
    let scale = bound / sqrt(squared);
    [x * scale, y * scale]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vector_keeps_its_direction() {
        assert_eq!(shortened([3.0, -4.0], 6.0), [3.0, -4.0]);
        let [x, y] = shortened([30.0, -40.0], 5.0);
        // One rounding of a root, a quotient and a product.
        assert!((x - 3.0).abs() < 1e-6 && (y + 4.0).abs() < 1e-6);
    }

    #[test]
    fn a_nan_stays_one() {
        assert!(is_beyond(f32::NAN, 1.0) && is_beyond(-1.1, 1.0) && !is_beyond(-1.0, 1.0));
        assert!(within(f32::NAN, 1.0).is_nan() && between(f32::NAN, 0.0, 1.0).is_nan());
        let [x, y] = shortened([f32::NAN, 0.0], 1.0);
        assert!(x.is_nan() && (y.is_nan() || y == 0.0));
    }

    #[test]
    fn crossed_bounds_give_the_lower_one() {
        assert_eq!([0.0, 2.0, 4.0].map(|value| between(value, 3.0, 1.0)), [3.0; 3]);
    }
}
