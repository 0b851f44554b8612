//! Unit quaternions, the project's one attitude convention: scalar first, Hamilton product, body to world.
//!
//! `q v q*` turns a vector given in the body frame into the world frame, and `dq/dt = 1/2 q (0, omega)` with the body
//! rates `omega`. `q` and `-q` are the same attitude; a comparison of two moves the measured one to the
//! reference's hemisphere first.

use core::ops::{Mul, Neg};

use nalgebra::Vector3;

use crate::math::{sin_cos, sqrt};

/// A quaternion, scalar part first.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Quaternion {
    /// Scalar part, `q0` in the paper.
    pub w: f32,
    /// First vector component, `q1`.
    pub x: f32,
    /// Second vector component, `q2`.
    pub y: f32,
    /// Third vector component, `q3`.
    pub z: f32,
}

impl Quaternion {
    /// Body axes along world axes.
    pub const IDENTITY: Self = Self::new(1.0, 0.0, 0.0, 0.0);

    /// From its components, scalar part first.
    pub const fn new(w: f32, x: f32, y: f32, z: f32) -> Self {
        Self { w, x, y, z }
    }

    /// The inverse of a unit quaternion.
    pub fn conjugate(self) -> Self {
        Self::new(self.w, -self.x, -self.y, -self.z)
    }

    /// Inner product of the four components; below zero for two quaternions of opposite hemispheres.
    pub fn dot(self, other: Self) -> f32 {
        self.w * other.w + self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The same attitude in the hemisphere of `other`.
    pub fn in_hemisphere_of(self, other: Self) -> Self {
        if self.dot(other) < 0.0 { -self } else { self }
    }

    /// Vector part.
    pub fn vector(self) -> Vector3<f32> {
        Vector3::new(self.x, self.y, self.z)
    }

    /// The body z axis in the world frame, along which the thrust acts; `q` of unit norm.
    pub fn thrust_axis(self) -> Vector3<f32> {
        Vector3::new(
            2.0 * (self.x * self.z + self.w * self.y),
            2.0 * (self.y * self.z - self.w * self.x),
            1.0 - 2.0 * (self.x * self.x + self.y * self.y),
        )
    }

    /// Every component times `scale`.
    #[inline]
    pub(crate) fn scaled(self, scale: f32) -> Self {
        Self::new(self.w * scale, self.x * scale, self.y * scale, self.z * scale)
    }
}

impl Mul for Quaternion {
    type Output = Self;

    /// Hamilton product: first `other`, then `self`.
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self, other);
        Self::new(
            a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
            a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
        )
    }
}

impl Neg for Quaternion {
    type Output = Self;

    fn neg(self) -> Self {
        Self::new(-self.w, -self.x, -self.y, -self.z)
    }
}

/// A heading: the rotation about the world's vertical that is left of an attitude `q = q_tilt(n) q_z(psi)` when the
/// smallest rotation that tilts the thrust axis to `n` is taken off. Not Z-Y-X yaw, from which it differs away from
/// hover.
///
/// Held as cosine and sine of half the angle and of the angle; always of unit norm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading {
    cos_half: f32,
    sin_half: f32,
    cos: f32,
    sin: f32,
}

impl Heading {
    /// Heading 0, the paper's.
    pub const ZERO: Self = Self { cos_half: 1.0, sin_half: 0.0, cos: 1.0, sin: 0.0 };

    /// From the angle psi in radians, within +-2000; turns are kept apart (psi and psi + 2 pi give `q` and `-q`).
    #[inline(never)]
    pub fn from_angle(psi_rad: f32) -> Self {
        Self::from_angle_inlined(psi_rad)
    }

    /// The same, inlined for the control step.
    #[inline(always)]
    pub(crate) fn from_angle_inlined(psi_rad: f32) -> Self {
        let (s, c) = sin_cos(0.5 * psi_rad);
        Self::of_half(c, s)
    }

    /// From cosine and sine of half the angle in any common scale: the scalar and the third component of an attitude
    /// `q_tilt q_z(psi)`. Not finite where both are zero.
    #[inline]
    pub fn from_half(cos_half: f32, sin_half: f32) -> Self {
        let scale = 1.0 / sqrt(cos_half * cos_half + sin_half * sin_half);
        Self::of_half(cos_half * scale, sin_half * scale)
    }

    #[inline(always)]
    fn of_half(c: f32, s: f32) -> Self {
        Self { cos_half: c, sin_half: s, cos: c * c - s * s, sin: 2.0 * c * s }
    }

    /// Turned on by a small angle, rad: up to 0.6 its sine and cosine are as good as [`Self::from_angle`]'s.
    #[inline]
    pub fn turned_slightly(self, angle_rad: f32) -> Self {
        let half = 0.5 * angle_rad;
        let h2 = half * half;
        let s = half * (1.0 - h2 * (1.0 / 6.0 - h2 * (1.0 / 120.0)));
        let c = 1.0 - h2 * (0.5 - h2 * (1.0 / 24.0 - h2 * (1.0 / 720.0)));
        Self::of_half(c * self.cos_half - s * self.sin_half, s * self.cos_half + c * self.sin_half)
    }

    /// Cosine of half the angle.
    pub fn cos_half(self) -> f32 {
        self.cos_half
    }

    /// Sine of half the angle.
    pub fn sin_half(self) -> f32 {
        self.sin_half
    }

    /// Cosine and sine of the angle itself.
    pub fn cos_sin(self) -> (f32, f32) {
        (self.cos, self.sin)
    }

    /// The quaternion `q_z(psi)`.
    pub fn quaternion(self) -> Quaternion {
        Quaternion::new(self.cos_half, 0.0, 0.0, self.sin_half)
    }

    /// A world vector in the frame that has this heading.
    pub fn to_heading_frame(self, v: Vector3<f32>) -> Vector3<f32> {
        let (cos, sin) = self.cos_sin();
        Vector3::new(cos * v.x + sin * v.y, cos * v.y - sin * v.x, v.z)
    }

    /// An attitude seen from the frame that has this heading: `q_z(-psi) q`.
    pub fn attitude_to_heading_frame(self, q: Quaternion) -> Quaternion {
        let (c, s) = (self.cos_half, self.sin_half);
        Quaternion::new(c * q.w + s * q.z, c * q.x + s * q.y, c * q.y - s * q.x, c * q.z - s * q.w)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const Q: Quaternion = Quaternion::new(0.5, 0.5, -0.1, 0.7);

    #[test]
    fn product_follows_hamilton() {
        let i = Quaternion::new(0.0, 1.0, 0.0, 0.0);
        let j = Quaternion::new(0.0, 0.0, 1.0, 0.0);
        let k = Quaternion::new(0.0, 0.0, 0.0, 1.0);
        assert_eq!(i * j, k);
        assert_eq!(j * k, i);
        assert_eq!(k * i, j);
        assert_eq!(j * i, -k);
        let squared = Q * Q.conjugate();
        assert!((squared.w - Q.dot(Q)).abs() < 1e-6 && squared.vector().norm() < 1e-6);
    }

    #[test]
    fn thrust_axis_is_the_sandwich_product() {
        assert!((Q.dot(Q) - 1.0).abs() < 1e-6);
        let sandwich = Q * Quaternion::new(0.0, 0.0, 0.0, 1.0) * Q.conjugate();
        // A handful of roundings of numbers below 1.
        assert!((Q.thrust_axis() - sandwich.vector()).norm() < 1e-6);
        assert!(((-Q).thrust_axis() - Q.thrust_axis()).norm() == 0.0);
    }

    /// Largest difference of cosines and sines.
    fn distance(a: Heading, b: Heading) -> f32 {
        [a.cos_half - b.cos_half, a.sin_half - b.sin_half, a.cos - b.cos, a.sin - b.sin]
            .into_iter()
            .fold(0.0, |most, difference| most.max(difference.abs()))
    }

    #[test]
    fn a_heading_is_the_rest_of_an_attitude_without_its_tilt() {
        for k in -30_i8..=30 {
            let psi = 0.2 * f32::from(k);
            let heading = Heading::from_angle(psi);
            // The smallest rotation to a tilt has no third component.
            let tilt = Quaternion::new(0.8, 0.36, -0.48, 0.0);
            let q = tilt * heading.quaternion();
            // Roundings of a product, a norm and a division.
            assert!(distance(Heading::from_half(q.w, q.z), heading) < 5e-7, "{psi}");
        }
        assert!(!Heading::from_half(0.0, 0.0).cos.is_finite());
    }

    #[test]
    fn a_small_turn_is_as_good_as_the_sine() {
        for k in -60_i8..=60 {
            let turn = 0.01 * f32::from(k);
            for psi in [-3.0_f32, 0.0, 0.7] {
                let (found, wanted) = (Heading::from_angle(psi).turned_slightly(turn), Heading::from_angle(psi + turn));
                // The sum of the angles is rounded, and so are four products.
                assert!(distance(found, wanted) < 5e-7, "{psi} + {turn}");
            }
        }
    }

    #[test]
    fn hemisphere_is_that_of_the_other() {
        assert_eq!((-Q).in_hemisphere_of(Q), Q);
        assert_eq!(Q.in_hemisphere_of(-Q), -Q);
        assert_eq!(Q.in_hemisphere_of(Q), Q);
    }

    #[test]
    fn heading_frame_turns_vectors_and_attitudes_alike() {
        let heading = Heading::from_angle(0.7);
        let turned = heading.to_heading_frame(Q.thrust_axis());
        let attitude = heading.attitude_to_heading_frame(Q);
        assert!((turned - attitude.thrust_axis()).norm() < 1e-6);
        let product = heading.quaternion().conjugate() * Q;
        assert!((attitude.dot(product) - 1.0).abs() < 1e-6);
        // A quarter turn to the left: a point to the north of the craft lies ahead of it.
        let north = Heading::from_angle(core::f32::consts::FRAC_PI_2).to_heading_frame(Vector3::new(0.0, 1.0, 0.0));
        assert!((north - Vector3::new(1.0, 0.0, 0.0)).norm() < 1e-6);
    }
}
