//! The estimated state: raw numbers from an estimator (world frame z up, body to world, SI) in, a state whose quaternion
//! has norm 1 out.

use nalgebra::Vector3;

use crate::error::{Field, StateError, first_non_finite};
use crate::quaternion::{Heading, Quaternion};

/// Largest deviation of a measured quaternion's squared norm from 1 that is taken for rounding and normalised away:
/// the norm itself may be off by 1.1 %. Estimators keep theirs within 1e-6, compressed quaternions of a radio link within
/// 2e-3; a quaternion further off is no attitude.
pub const NORM_SQUARED_TOLERANCE: f32 = 3.0 / 128.0;

/// Position, attitude and velocity: `x = [r q v]` of the paper's (2a), regrouped in the canonical order.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    /// Position in the world frame (z up), m.
    pub position_m: Vector3<f32>,
    /// Attitude, body to world.
    pub attitude: Quaternion,
    /// Velocity in the world frame, m/s.
    pub velocity_m_s: Vector3<f32>,
}

impl State {
    /// At rest at `position_m`, level, heading 0.
    pub fn at_rest(position_m: Vector3<f32>) -> Self {
        Self { position_m, attitude: Quaternion::IDENTITY, velocity_m_s: Vector3::new(0.0, 0.0, 0.0) }
    }

    /// Checks that all numbers are finite and the quaternion's norm is near 1, and scales the quaternion to norm 1.
    ///
    /// # Errors
    /// [`StateError::NonFinite`] names a component, [`StateError::QuaternionNorm`] the norm where it is off by more than
    /// [`NORM_SQUARED_TOLERANCE`] allows.
    pub fn validated(&self) -> Result<Self, StateError> {
        match self.fault() {
            None => {
                Ok(Self { attitude: self.attitude.scaled(inverse_norm(self.attitude.dot(self.attitude))), ..*self })
            }
            Some(fault) => Err(fault),
        }
    }

    /// The state as the laws take it; nothing where the quaternion's norm is too far off.
    ///
    /// Only the norm is looked at: a position or velocity that is not finite shows in the command, which is checked.
    #[inline]
    pub fn normalized(&self) -> Option<NormalizedState<'_>> {
        let norm_squared = self.attitude.dot(self.attitude);
        let near = is_near_one(norm_squared);
        near.then(|| NormalizedState { state: self, scale: inverse_norm(norm_squared) })
    }

    /// The first component that is not finite, else a quaternion's norm that is off.
    #[cold]
    pub(crate) fn fault(&self) -> Option<StateError> {
        let Self { position_m: r, attitude: q, velocity_m_s: v } = self;
        let fields = [Field::Position, Field::Velocity, Field::Attitude, Field::Attitude];
        let values = [r.x, r.y, r.z, v.x, v.y, v.z, q.w, q.x, q.y, q.z];
        let non_finite =
            first_non_finite(&fields, &values).map(|(field, value)| StateError::NonFinite { field, value });
        let norm_squared = q.dot(*q);
        non_finite.or((!is_near_one(norm_squared)).then_some(StateError::QuaternionNorm { norm_squared }))
    }
}

/// A state whose quaternion is an attitude: its norm is known, and divided out of every result computed from it.
#[derive(Clone, Copy, Debug)]
pub struct NormalizedState<'a> {
    state: &'a State,
    /// One over the quaternion's norm.
    scale: f32,
}

impl NormalizedState<'_> {
    /// Position in the world frame, m.
    pub fn position_m(&self) -> &Vector3<f32> {
        &self.state.position_m
    }

    /// Velocity in the world frame, m/s.
    pub fn velocity_m_s(&self) -> &Vector3<f32> {
        &self.state.velocity_m_s
    }

    /// The attitude, of norm 1 and of the sign that was measured.
    pub fn attitude(&self) -> Quaternion {
        self.state.attitude.scaled(self.scale)
    }

    /// The attitude of norm 1 seen from a target, `target^-1 q`, of the sign with a scalar part of at least 0: the
    /// measured attitude in the target's hemisphere.
    #[inline]
    pub fn attitude_from(&self, target: Quaternion) -> Quaternion {
        self.shorter(target.conjugate() * self.state.attitude)
    }

    /// The attitude of norm 1 seen from a frame of some heading, of the sign with a scalar part of at least 0.
    #[inline]
    pub fn attitude_from_heading(&self, heading: Heading) -> Quaternion {
        self.shorter(heading.attitude_to_heading_frame(self.state.attitude))
    }

    /// Norm and sign in one product: a turn of the frame keeps both.
    #[inline]
    fn shorter(&self, turned: Quaternion) -> Quaternion {
        turned.scaled(if turned.w < 0.0 { -self.scale } else { self.scale })
    }
}

/// On the bits without the sign, where NaN is above every number. The tolerance is one that a comparison can hold.
#[inline]
fn is_near_one(norm_squared: f32) -> bool {
    (1.0 - norm_squared).to_bits() << 1 <= NORM_SQUARED_TOLERANCE.to_bits() << 1
}

/// `1 / sqrt(norm_squared)` near 1, by the series of `1 / sqrt(1 - d)`: its next term, 35/128 d^4, is below 8.3e-8 within
/// [`NORM_SQUARED_TOLERANCE`], less than the spacing of f32 at 1. No root, no division.
#[inline]
fn inverse_norm(norm_squared: f32) -> f32 {
    let d = 1.0 - norm_squared;
    1.0 + d * (0.5 + d * (0.375 + d * 0.3125))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_attitude(attitude: Quaternion) -> State {
        State { attitude, ..State::at_rest(Vector3::new(1.0, 2.0, 3.0)) }
    }

    #[test]
    fn a_quaternion_within_the_bound_is_normalised() {
        for scale in [0.991_f32, 1.0, 1.009] {
            let raw = Quaternion::new(0.5 * scale, 0.5 * scale, -0.1 * scale, 0.7 * scale);
            let q = with_attitude(raw).validated().unwrap().attitude;
            assert!((q.dot(q) - 1.0).abs() <= 4.0 * f32::EPSILON, "scale {scale}");
        }
    }

    #[test]
    fn a_quaternion_beyond_the_bound_is_refused_with_its_norm() {
        for scale in [0.0_f32, 0.98, 1.02, 5.0] {
            let raw = Quaternion::new(scale, 0.0, 0.0, 0.0);
            let refused = with_attitude(raw).validated();
            assert_eq!(refused, Err(StateError::QuaternionNorm { norm_squared: scale * scale }));
        }
    }

    #[test]
    fn a_quaternion_that_is_not_finite_is_named() {
        let refused = with_attitude(Quaternion::new(1.0, f32::INFINITY, 0.0, 0.0)).validated();
        assert_eq!(refused, Err(StateError::NonFinite { field: Field::Attitude, value: f32::INFINITY }));
    }
}
