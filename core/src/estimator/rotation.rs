//! Small rotations (rotation vectors, rad) as quaternions and matrices, by series: without the sine and cosine of a
//! library, for the same bits on every target.

use nalgebra::{Matrix3, Vector3};

use crate::math::sqrt;
use crate::quaternion::Quaternion;

/// The quaternion of a rotation vector `theta` (axis times angle, rad): `(cos |theta| / 2, sin(|theta| / 2) theta /
/// |theta|)` by their series, each to the term of the sixth power.
///
/// The next terms are `h^8 / 8!` and `h^8 / 9!` with `h = |theta| / 2`: below 1e-7 for `|theta| <= 1`, which is the
/// rounding of f32.
#[inline]
pub(super) fn quaternion_of(theta: &Vector3<f32>) -> Quaternion {
    let half = theta * 0.5;
    let h2 = half.dot(&half);
    let cos = 1.0 - h2 * (1.0 / 2.0 - h2 * (1.0 / 24.0 - h2 * (1.0 / 720.0)));
    let sin_over_h = 1.0 - h2 * (1.0 / 6.0 - h2 * (1.0 / 120.0 - h2 * (1.0 / 5040.0)));
    let v = half * sin_over_h;
    Quaternion::new(cos, v.x, v.y, v.z)
}

/// `q` turned about its own axes by a rotation vector, of norm 1.
#[inline]
pub(super) fn turned(q: Quaternion, by: &Quaternion) -> Quaternion {
    let product = q * *by;
    product.scaled(1.0 / sqrt(product.dot(product)))
}

/// The matrix that turns as a unit quaternion does: `R v = q v q*`.
#[inline]
pub(super) fn matrix_of(q: &Quaternion) -> Matrix3<f32> {
    let Quaternion { w, x, y, z } = *q;
    let (x2, y2, z2) = (x + x, y + y, z + z);
    let (xx, xy, xz) = (x * x2, x * y2, x * z2);
    let (yy, yz, zz) = (y * y2, y * z2, z * z2);
    let (wx, wy, wz) = (w * x2, w * y2, w * z2);
    Matrix3::new(
        1.0 - (yy + zz),
        xy - wz,
        xz + wy,
        xy + wz,
        1.0 - (xx + zz),
        yz - wx,
        xz - wy,
        yz + wx,
        1.0 - (xx + yy),
    )
}

/// The second-order matrix of a rotation by `-theta`: `I - [theta] + [theta]^2 / 2`; the rest is below
/// `|theta|^3 / 6`.
#[inline]
pub(super) fn matrix_back(theta: &Vector3<f32>) -> Matrix3<f32> {
    let (x, y, z) = (theta.x, theta.y, theta.z);
    let (xx, yy, zz) = (0.5 * x * x, 0.5 * y * y, 0.5 * z * z);
    let (xy, xz, yz) = (0.5 * x * y, 0.5 * x * z, 0.5 * y * z);
    Matrix3::new(1.0 - (yy + zz), z + xy, xz - y, xy - z, 1.0 - (xx + zz), x + yz, y + xz, yz - x, 1.0 - (xx + yy))
}

/// `m [v]`, with the cross product's matrix `[v]`: each row of `m` crossed with `v`.
#[inline]
pub(super) fn times_cross(m: &Matrix3<f32>, v: &Vector3<f32>) -> Matrix3<f32> {
    let row = |x: f32, y: f32, z: f32| [y * v.z - z * v.y, z * v.x - x * v.z, x * v.y - y * v.x];
    let [a, b, c] = row(m.m11, m.m12, m.m13);
    let [d, e, f] = row(m.m21, m.m22, m.m23);
    let [g, h, i] = row(m.m31, m.m32, m.m33);
    Matrix3::new(a, b, c, d, e, f, g, h, i)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_is_the_sine_up_to_a_radian() {
        for step in 0..=100_u8 {
            let angle = 0.01 * f32::from(step);
            let axis = Vector3::new(0.6_f32, -0.48, 0.64);
            let q = quaternion_of(&(axis * angle));
            let half = f64::from(angle) / 2.0;
            let exact = [half.cos(), 0.6 * half.sin(), -0.48 * half.sin(), 0.64 * half.sin()];
            for (found, exact) in [q.w, q.x, q.y, q.z].into_iter().zip(exact) {
                // A few roundings of numbers up to 1.
                assert!((f64::from(found) - exact).abs() < 2e-7, "{angle} rad: {found} {exact}");
            }
        }
    }

    #[test]
    fn the_matrix_turns_as_the_quaternion_does() {
        let q = Quaternion::new(0.5, 0.5, -0.1, 0.7);
        let q = q.scaled(1.0 / q.dot(q).sqrt());
        let (m, v) = (matrix_of(&q), Vector3::new(1.0, -2.0, 0.5));
        let sandwich = q * Quaternion::new(0.0, v.x, v.y, v.z) * q.conjugate();
        assert!((m * v - sandwich.vector()).norm() < 1e-6);
        assert!((m.column(2) - q.thrust_axis()).norm() < 1e-6);
    }

    #[test]
    fn turning_back_is_the_transposed_rotation() {
        let theta = Vector3::new(0.03, -0.02, 0.05);
        let exact = matrix_of(&quaternion_of(&theta)).transpose();
        // |theta|^3 / 6 with |theta| = 0.0616.
        assert!((matrix_back(&theta) - exact).norm() < 2.0 * 3.9e-5);
    }

    #[test]
    fn a_row_crossed_is_the_product_with_the_cross_matrix() {
        let (m, v) = (matrix_of(&Quaternion::new(0.8, 0.36, -0.48, 0.0)), Vector3::new(1.0, 2.0, -3.0));
        assert!((times_cross(&m, &v) - m * v.cross_matrix()).norm() < 1e-6);
    }
}
