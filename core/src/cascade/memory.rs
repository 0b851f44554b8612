//! The cascade's memory from step to step: estimates of its observers, and values for the next step.

use nalgebra::Vector3;

use super::air_learner::SeenAir;
use super::estimate::{Carried, HeldVelocity, Now};
use super::force_observer::Disturbance;
use super::ground::Ground;
use super::reference::Approach;
use super::torque_observer::Imbalance;
use super::yield_learner::MotorYield;
use crate::mixer::Parts;
use crate::quaternion::Quaternion;

/// The memory of a [`super::Cascade`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CascadeMemory {
    pub(super) carried: Carried,
    pub(super) held: HeldVelocity,
    pub(super) disturbance: Disturbance,
    pub(super) imbalance: Imbalance,
    pub(super) air: SeenAir,
    pub(super) motors: MotorYield,
    pub(super) ground: Ground,
    /// On the way to the reference.
    pub(super) approach: Approach,
    /// Mean of the forces over the step that has begun, in parts, N.
    pub(super) coming: Parts,
    pub(super) seen: Seen,
    /// The values of the step before.
    pub(super) before: Before,
}

/// Values at a step's beginning, for the means over it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Before {
    pub(super) velocity: Vector3<f32>,
    pub(super) axis: Vector3<f32>,
    pub(super) answer: [f32; 2],
}

/// The values of a step that its observers take.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Seen {
    pub(super) now: Now,
    pub(super) axis: Vector3<f32>,
    /// Mean of the motors' forces over the step that has ended, in parts, N.
    pub(super) mean_forces: Parts,
    /// The part of them that answers the air: roll and pitch, N.
    pub(super) answer: [f32; 2],
    /// The reference's velocity in the world frame, and x and y of it in its own body frame, m/s.
    pub(super) wanted: Vector3<f32>,
    pub(super) body_velocity: [f32; 2],
    /// Whether the craft was where it was sent, with motors within their range.
    pub(super) undisturbed: bool,
    /// Half the rotation from the attitude that was wanted, body frame, rad.
    pub(super) half_rotation: [f32; 3],
}

impl CascadeMemory {
    /// Of a craft on the ground with its motors off.
    pub const STANDING: Self = Self::new(Ground::STANDING);

    /// Of a craft in flight that has seen nothing yet.
    pub const IN_FLIGHT: Self = Self::new(Ground::FLYING);

    const fn new(ground: Ground) -> Self {
        let (zero, up) = (Vector3::new(0.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 1.0));
        let now = Now { position: zero, velocity: zero, attitude: Quaternion::IDENTITY, body_rates: zero };
        let none = Parts { thrust: 0.0, roll: 0.0, pitch: 0.0, yaw: 0.0 };
        Self {
            carried: Carried::NONE,
            held: HeldVelocity::NONE,
            disturbance: Disturbance::NONE,
            imbalance: Imbalance::NONE,
            air: SeenAir::NONE,
            motors: MotorYield::TOLD,
            ground,
            approach: Approach::NONE,
            coming: none,
            before: Before { velocity: zero, axis: up, answer: [0.0; 2] },
            seen: Seen {
                now,
                axis: up,
                mean_forces: none,
                answer: [0.0; 2],
                wanted: zero,
                body_velocity: [0.0; 2],
                undisturbed: false,
                half_rotation: [0.0; 3],
            },
        }
    }

    /// The cascade is selected in flight, after another law: the learned figures of the air and of the motors stay.
    pub(crate) fn begin_in_flight(&mut self) {
        let mut air = self.air;
        air.rest();
        *self = Self { air, motors: self.motors, ..Self::IN_FLIGHT };
    }

    /// Observers that see nothing, as those of a craft that does not fly.
    #[cold]
    #[inline(never)]
    pub(super) fn rest(&mut self) {
        self.disturbance.rest(&self.seen.now.velocity);
        self.imbalance.rest(&self.seen.now.body_rates);
        self.air.rest();
    }

    /// The motors are off: the craft is taken to stand on the ground until it moves.
    pub(crate) fn motors_off(&mut self) {
        self.ground = Ground::STANDING;
    }

    /// Whether the next look of the observers takes longer than others: every 10 ms they look at the air.
    pub const fn is_air_due(&self) -> bool {
        self.air.wait == 0 && matches!(self.ground, Ground::Flying { .. })
    }

    /// Whether the craft is taken to stand on the ground, or to be held.
    pub fn stands(&self) -> bool {
        self.ground.is_standing()
    }

    /// Rotation vector from the attitude that the last step wanted to the craft's, body frame, rad.
    pub fn rotation_error_rad(&self) -> Vector3<f32> {
        let [x, y, z] = self.seen.half_rotation;
        Vector3::new(2.0 * x, 2.0 * y, 2.0 * z)
    }

    /// Force of the motors as a share of the commanded one, as learned in flight.
    pub fn motor_share(&self) -> f32 {
        self.motors.share
    }

    /// The disturbance that is seen: x and y in the world frame and along the thrust, m/s^2.
    pub fn disturbance_m_s2(&self) -> Vector3<f32> {
        let [x, y] = self.disturbance.across;
        Vector3::new(x, y, self.disturbance.along)
    }

    /// The imbalance that is seen, as roll, pitch and yaw parts of the motors' forces, N.
    pub fn imbalance_n(&self) -> [f32; 3] {
        self.imbalance.parts
    }
}
