//! The estimated state: raw numbers from an estimator in, a state whose quaternion has norm 1 out.

use nalgebra::Vector3;

use crate::error::{Field, StateError};
use crate::quaternion::Quaternion;

/// Largest deviation of a measured quaternion's squared norm from 1 that is taken for rounding and normalised away:
/// the norm itself may be off by 1 %. Estimators keep theirs within 1e-6, compressed quaternions of a radio link within
/// 2e-3; what is further off is no attitude.
pub const NORM_SQUARED_TOLERANCE: f32 = 0.02;

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

    /// The state with its quaternion scaled to norm 1.
    ///
    /// Only the norm is looked at: a position or velocity that is not finite shows in the command, which is checked.
    ///
    /// # Errors
    /// [`StateError::QuaternionNorm`] where the norm is off by more than [`NORM_SQUARED_TOLERANCE`] allows, and
    /// [`StateError::NonFinite`] where a component of the quaternion is not finite.
    #[inline]
    pub fn normalised(&self) -> Result<Self, StateError> {
        let norm_squared = self.attitude.dot(self.attitude);
        // Written so that NaN fails it.
        if (norm_squared - 1.0).abs() <= NORM_SQUARED_TOLERANCE {
            Ok(Self { attitude: self.attitude.normalised(norm_squared), ..*self })
        } else {
            Err(self.fault(norm_squared))
        }
    }

    /// Names what is wrong with a state whose quaternion has been refused.
    #[cold]
    fn fault(&self, norm_squared: f32) -> StateError {
        self.non_finite().unwrap_or(StateError::QuaternionNorm { norm_squared })
    }

    /// The first component that is not finite.
    #[cold]
    pub(crate) fn non_finite(&self) -> Option<StateError> {
        let Self { position_m: r, attitude: q, velocity_m_s: v } = self;
        let fields = [
            (Field::Position, [r.x, r.y, r.z, 0.0]),
            (Field::Attitude, [q.w, q.x, q.y, q.z]),
            (Field::Velocity, [v.x, v.y, v.z, 0.0]),
        ];
        fields.iter().find_map(|(field, values)| {
            let value = values.iter().copied().find(|value| !value.is_finite())?;
            Some(StateError::NonFinite { field: *field, value })
        })
    }
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
            let q = with_attitude(raw).normalised().unwrap().attitude;
            assert!((q.dot(q) - 1.0).abs() <= 4.0 * f32::EPSILON, "scale {scale}");
        }
    }

    #[test]
    fn a_quaternion_beyond_the_bound_is_refused_with_its_norm() {
        for scale in [0.0_f32, 0.98, 1.02, 5.0] {
            let raw = Quaternion::new(scale, 0.0, 0.0, 0.0);
            let refused = with_attitude(raw).normalised();
            assert_eq!(refused, Err(StateError::QuaternionNorm { norm_squared: scale * scale }));
        }
    }

    #[test]
    fn a_quaternion_that_is_not_finite_is_named() {
        let refused = with_attitude(Quaternion::new(1.0, f32::INFINITY, 0.0, 0.0)).normalised();
        assert_eq!(refused, Err(StateError::NonFinite { field: Field::Attitude, value: f32::INFINITY }));
    }
}
