//! A column of the filter's nine errors, in groups of three: position (m) and velocity (m/s) in the world frame, attitude
//! (body frame, rad).

use nalgebra::Vector3;

/// One of the three groups of errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Group {
    Position,
    Velocity,
    Attitude,
}

/// Nine numbers, one for each error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Column {
    pub(super) position: Vector3<f32>,
    pub(super) velocity: Vector3<f32>,
    pub(super) attitude: Vector3<f32>,
}

impl Column {
    pub(super) const ZERO: Self = Self {
        position: Vector3::new(0.0, 0.0, 0.0),
        velocity: Vector3::new(0.0, 0.0, 0.0),
        attitude: Vector3::new(0.0, 0.0, 0.0),
    };

    #[inline]
    pub(super) fn of(&self, group: Group) -> &Vector3<f32> {
        match group {
            Group::Position => &self.position,
            Group::Velocity => &self.velocity,
            Group::Attitude => &self.attitude,
        }
    }

    /// `self + other * scale`.
    #[inline]
    pub(super) fn plus(&self, other: &Self, scale: f32) -> Self {
        Self {
            position: self.position + other.position * scale,
            velocity: self.velocity + other.velocity * scale,
            attitude: self.attitude + other.attitude * scale,
        }
    }
}
