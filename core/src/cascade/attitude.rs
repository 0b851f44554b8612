//! The attitude error of the cascade: the wanted specific force (world frame, m/s^2), a heading and the craft's attitude
//! in; half the rotation vector from the wanted attitude to the craft's (body frame, rad) out.

use nalgebra::Vector3;

use crate::math::sqrt;
use crate::quaternion::{Heading, Quaternion};

/// Vector part of `q_d^-1 q` of the sign with a scalar part of at least 0, for the attitude q_d whose thrust axis lies along `wanted`,
/// with a heading: half the rotation vector near it. `wanted` points upwards, which its limits see to.
#[inline(always)]
pub(super) fn half_error(wanted: &Vector3<f32>, heading: Heading, q: Quaternion) -> [f32; 3] {
    let inverse = 1.0 / sqrt(wanted.x * wanted.x + wanted.y * wanted.y + wanted.z * wanted.z);
    let (nx, ny, nz) = (wanted.x * inverse, wanted.y * inverse, wanted.z * inverse);
    // The smallest rotation that tilts the vertical to n: `(root, -n_y half, n_x half, 0)`.
    let root = sqrt(0.5 * (1.0 + nz));
    let half = 0.5 / root;
    let (tx, ty) = (-(ny * half), nx * half);
    // Its inverse times q.
    let w = root * q.w + tx * q.x + ty * q.y;
    let x = root * q.x - tx * q.w - ty * q.z;
    let y = root * q.y - ty * q.w + tx * q.z;
    let z = root * q.z - tx * q.y + ty * q.x;
    // Turned back by the heading.
    let (c, s) = (heading.cos_half(), heading.sin_half());
    let scalar = c * w + s * z;
    let error = [c * x + s * y, c * y - s * x, c * z - s * w];
    if scalar < 0.0 { error.map(|part| -part) } else { error }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_product_of_quaternions() {
        let wanted = Vector3::new(3.0_f32, -4.0, 9.0);
        let n = wanted / wanted.norm();
        let root = (0.5 * (1.0 + n.z)).sqrt();
        let tilt = Quaternion::new(root, -n.y / (2.0 * root), n.x / (2.0 * root), 0.0);
        let heading = Heading::from_angle(0.9);
        let q_d = tilt * heading.quaternion();
        assert!((q_d.thrust_axis() - n).norm() < 1e-6);
        for q in [Quaternion::new(0.5, 0.5, -0.1, 0.7), Quaternion::new(-0.1, 0.5, 0.5, 0.7), q_d] {
            let product = q_d.conjugate() * q;
            let product = if product.w < 0.0 { -product } else { product };
            let found = Vector3::from(half_error(&wanted, heading, q));
            assert!((found - product.vector()).norm() < 1e-6, "{found}");
        }
    }
}
