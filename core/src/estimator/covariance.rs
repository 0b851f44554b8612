//! The covariance of the filter's nine errors as blocks of three, so that zero blocks are not multiplied. Units are those
//! of the errors, squared.

use nalgebra::{Matrix3, Vector3};

use super::column::{Column, Group};
use crate::math::sqrt;

/// The covariance of position (m, world), velocity (m/s, world) and attitude (rad, body) errors: a symmetric matrix of
/// nine rows, kept as its upper six blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Covariance {
    /// Position with position, m^2; symmetric.
    pub position: Matrix3<f32>,
    /// Position (rows) with velocity (columns), m^2/s.
    pub position_velocity: Matrix3<f32>,
    /// Position with attitude, m rad.
    pub position_attitude: Matrix3<f32>,
    /// Velocity with velocity, m^2/s^2; symmetric.
    pub velocity: Matrix3<f32>,
    /// Velocity with attitude, m/s rad.
    pub velocity_attitude: Matrix3<f32>,
    /// Attitude with attitude, rad^2; symmetric.
    pub attitude: Matrix3<f32>,
}

/// The linear map that carries errors over a period: `r+ = r + h (v + G a / 2)`, `v+ = E v + G a`, `a+ = A a`.
pub(super) struct Transition {
    /// `h`, s.
    pub(super) period_s: f32,
    /// `E`; the identity where there is nothing.
    pub(super) velocity: Option<Matrix3<f32>>,
    /// `G`.
    pub(super) velocity_from_attitude: Matrix3<f32>,
    /// `A`.
    pub(super) attitude: Matrix3<f32>,
}

/// The upper triangle on both sides.
#[inline]
fn mirrored(m: &Matrix3<f32>) -> Matrix3<f32> {
    Matrix3::new(m.m11, m.m12, m.m13, m.m12, m.m22, m.m23, m.m13, m.m23, m.m33)
}

impl Covariance {
    /// Independent errors with these variances.
    pub(super) fn of_variances(variances: &Column) -> Self {
        let zero = Matrix3::zeros();
        Self {
            position: Matrix3::from_diagonal(&variances.position),
            position_velocity: zero,
            position_attitude: zero,
            velocity: Matrix3::from_diagonal(&variances.velocity),
            velocity_attitude: zero,
            attitude: Matrix3::from_diagonal(&variances.attitude),
        }
    }

    /// Becomes `F P F'` for the transition F, without the products by zeros and ones.
    pub(super) fn carry(&mut self, transition: &Transition) {
        let (h, g, a) = (transition.period_s, &transition.velocity_from_attitude, &transition.attitude);
        let times = |m: &Matrix3<f32>| match &transition.velocity {
            Some(e) => e * m,
            None => *m,
        };
        // F P without the rows of the attitude, column by column: of the rows of the attitude, only G counts.
        let pushed = g * self.position_attitude.transpose();
        let vr = self.position_velocity.transpose();
        self.position += (vr + pushed * 0.5) * h;
        let pushed = g * self.velocity_attitude.transpose();
        self.position_velocity += (self.velocity + pushed * 0.5) * h;
        self.velocity = times(&self.velocity) + pushed;
        let pushed = g * self.attitude;
        self.position_attitude += (self.velocity_attitude + pushed * 0.5) * h;
        self.velocity_attitude = times(&self.velocity_attitude) + pushed;
        // (F P) F'; E is symmetric.
        let pushed = self.position_attitude * g.transpose();
        self.position = mirrored(&(self.position + (self.position_velocity + pushed * 0.5) * h));
        self.position_velocity = match &transition.velocity {
            Some(e) => self.position_velocity * e,
            None => self.position_velocity,
        } + pushed;
        let pushed = self.velocity_attitude * g.transpose();
        self.velocity = mirrored(&match &transition.velocity {
            Some(e) => self.velocity * e + pushed,
            None => self.velocity + pushed,
        });
        self.turn(a);
    }

    /// Adds noise to velocity (the upper triangle counts) and attitude.
    #[inline]
    pub(super) fn add_noise(&mut self, velocity: &Matrix3<f32>, attitude: &Vector3<f32>) {
        self.velocity = mirrored(&(self.velocity + velocity));
        self.attitude += Matrix3::from_diagonal(attitude);
    }

    /// The attitude's error `a` becomes `T a`.
    #[inline]
    pub(super) fn turn(&mut self, t: &Matrix3<f32>) {
        let transposed = t.transpose();
        self.position_attitude *= transposed;
        self.velocity_attitude *= transposed;
        self.attitude = mirrored(&(t * self.attitude * transposed));
    }

    /// `P h'` for a row h that is zero but in one group.
    #[inline]
    pub(super) fn column(&self, group: Group, row: &Vector3<f32>) -> Column {
        match group {
            Group::Position => Column {
                position: self.position * row,
                velocity: self.position_velocity.transpose() * row,
                attitude: self.position_attitude.transpose() * row,
            },
            Group::Velocity => Column {
                position: self.position_velocity * row,
                velocity: self.velocity * row,
                attitude: self.velocity_attitude.transpose() * row,
            },
            Group::Attitude => Column {
                position: self.position_attitude * row,
                velocity: self.velocity_attitude * row,
                attitude: self.attitude * row,
            },
        }
    }

    /// The block of one group.
    #[inline]
    pub(super) fn block(&self, group: Group) -> &Matrix3<f32> {
        match group {
            Group::Position => &self.position,
            Group::Velocity => &self.velocity,
            Group::Attitude => &self.attitude,
        }
    }

    /// Becomes `P - k p'`, of a gain k that is `p` over a number: its symmetric blocks by their upper triangle.
    #[inline]
    pub(super) fn subtract(&mut self, k: &Column, p: &Column) {
        let [r, v, a] = [p.position.transpose(), p.velocity.transpose(), p.attitude.transpose()];
        self.position = mirrored(&(self.position - k.position * r));
        self.position_velocity -= k.position * v;
        self.position_attitude -= k.position * a;
        self.velocity = mirrored(&(self.velocity - k.velocity * v));
        self.velocity_attitude -= k.velocity * a;
        self.attitude = mirrored(&(self.attitude - k.attitude * a));
    }

    /// Adds a part of another's variances.
    #[inline]
    pub(super) fn widen(&mut self, other: &Self, part: f32) {
        self.position += Matrix3::from_diagonal(&(other.position.diagonal() * part));
        self.velocity += Matrix3::from_diagonal(&(other.velocity.diagonal() * part));
        self.attitude += Matrix3::from_diagonal(&(other.attitude.diagonal() * part));
    }

    /// Brings every variance within `min` and `max`: below, the rest is added to the variance; above, the row and the
    /// column are scaled. Neither takes a positive matrix's definiteness.
    pub(super) fn bound(&mut self, min: f32, max: f32) {
        let raised = |variance: f32| if variance < min { min } else { variance };
        let raise = |m: &mut Matrix3<f32>| (m.m11, m.m22, m.m33) = (raised(m.m11), raised(m.m22), raised(m.m33));
        let is_above = |m: &Matrix3<f32>| m.m11 > max || m.m22 > max || m.m33 > max;
        raise(&mut self.position);
        raise(&mut self.velocity);
        raise(&mut self.attitude);
        if is_above(&self.position) || is_above(&self.velocity) || is_above(&self.attitude) {
            *self = self.capped(max);
        }
    }

    #[cold]
    #[inline(never)]
    fn capped(&self, max: f32) -> Self {
        let scale = |m: &Matrix3<f32>| m.diagonal().map(|v| if v > max { sqrt(max / v) } else { 1.0 });
        let [r, v, a] = [scale(&self.position), scale(&self.velocity), scale(&self.attitude)];
        let scaled = |m: &Matrix3<f32>, left: &Vector3<f32>, right: &Vector3<f32>| {
            Matrix3::from_diagonal(left) * m * Matrix3::from_diagonal(right)
        };
        Self {
            position: mirrored(&scaled(&self.position, &r, &r)),
            position_velocity: scaled(&self.position_velocity, &r, &v),
            position_attitude: scaled(&self.position_attitude, &r, &a),
            velocity: mirrored(&scaled(&self.velocity, &v, &v)),
            velocity_attitude: scaled(&self.velocity_attitude, &v, &a),
            attitude: mirrored(&scaled(&self.attitude, &a, &a)),
        }
    }

    /// Whether all of it are numbers.
    pub(super) fn is_finite(&self) -> bool {
        // A number that is not finite stays so in a sum of squares; variances are bounded, so that a finite sum stays
        // finite.
        let sum = self.position.norm_squared()
            + self.position_velocity.norm_squared()
            + self.position_attitude.norm_squared()
            + self.velocity.norm_squared()
            + self.velocity_attitude.norm_squared()
            + self.attitude.norm_squared();
        sum.is_finite()
    }

    /// Standard deviations of position (m), velocity (m/s) and attitude (rad).
    pub fn deviations(&self) -> [Vector3<f32>; 3] {
        [&self.position, &self.velocity, &self.attitude].map(|block| block.diagonal().map(sqrt))
    }

    /// All of it, row by row, in the order position, velocity, attitude.
    pub fn to_rows(&self) -> [[f32; 9]; 9] {
        let row = |left: Vector3<f32>, middle: Vector3<f32>, right: Vector3<f32>| {
            [left.x, left.y, left.z, middle.x, middle.y, middle.z, right.x, right.y, right.z]
        };
        let Self { position: rr, position_velocity: rv, position_attitude: ra, .. } = self;
        let Self { velocity: vv, velocity_attitude: va, attitude: aa, .. } = self;
        let [r0, r1, r2] = columns(&rr.transpose());
        let [rv0, rv1, rv2] = columns(&rv.transpose());
        let [ra0, ra1, ra2] = columns(&ra.transpose());
        let [vr0, vr1, vr2] = columns(rv);
        let [v0, v1, v2] = columns(&vv.transpose());
        let [va0, va1, va2] = columns(&va.transpose());
        let [ar0, ar1, ar2] = columns(ra);
        let [av0, av1, av2] = columns(va);
        let [a0, a1, a2] = columns(&aa.transpose());
        [
            row(r0, rv0, ra0),
            row(r1, rv1, ra1),
            row(r2, rv2, ra2),
            row(vr0, v0, va0),
            row(vr1, v1, va1),
            row(vr2, v2, va2),
            row(ar0, av0, a0),
            row(ar1, av1, a1),
            row(ar2, av2, a2),
        ]
    }
}

fn columns(m: &Matrix3<f32>) -> [Vector3<f32>; 3] {
    [Vector3::new(m.m11, m.m21, m.m31), Vector3::new(m.m12, m.m22, m.m32), Vector3::new(m.m13, m.m23, m.m33)]
}

#[cfg(test)]
mod tests;
