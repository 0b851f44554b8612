//! The inputs of a step: the measurements of the craft, and its target.

use nalgebra::Vector3;

#[cfg(feature = "cascade")]
use crate::cascade::Followed;
#[cfg(feature = "cascade")]
use crate::command::Command;
#[cfg(feature = "cascade")]
use crate::motor_reference::FifthOrderSample;
#[cfg(feature = "actuator-aware")]
use crate::motor_reference::MotorReference;
#[cfg(feature = "cascade")]
use crate::quaternion::{Heading, Quaternion};
use crate::reference::Reference;
use crate::rigid_state::RigidState;
use crate::state::State;
use crate::trajectory::Progress;

/// The measurements of a craft at a step, borrowed.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    pub(crate) state: &'a State,
    pub(crate) body_rates_rad_s: Option<&'a Vector3<f32>>,
    #[cfg(feature = "cascade")]
    pub(crate) specific_force_m_s2: Option<&'a Vector3<f32>>,
}

impl<'a> Measured<'a> {
    /// An estimated state; its quaternion may have either sign.
    #[inline]
    pub const fn new(state: &'a State) -> Self {
        Self {
            state,
            body_rates_rad_s: None,
            #[cfg(feature = "cascade")]
            specific_force_m_s2: None,
        }
    }

    /// With the gyroscope's body rates `p q r`, rad/s: needed by a law of motor forces, and to carry a command to them.
    #[inline]
    pub const fn with_body_rates(self, body_rates_rad_s: &'a Vector3<f32>) -> Self {
        Self { body_rates_rad_s: Some(body_rates_rad_s), ..self }
    }

    #[cfg(feature = "cascade")]
    /// With the accelerometer's specific force in the body frame, m/s^2: from which the cascade learns the air.
    #[inline]
    pub const fn with_specific_force(self, specific_force_m_s2: &'a Vector3<f32>) -> Self {
        Self { specific_force_m_s2: Some(specific_force_m_s2), ..self }
    }

    /// The estimated state.
    pub const fn state(&self) -> &'a State {
        self.state
    }

    /// The body rates, if there are any, rad/s.
    pub const fn body_rates_rad_s(&self) -> Option<&'a Vector3<f32>> {
        self.body_rates_rad_s
    }
}

impl<'a> From<&'a State> for Measured<'a> {
    fn from(state: &'a State) -> Self {
        Self::new(state)
    }
}

impl<'a> From<&'a RigidState> for Measured<'a> {
    fn from(rigid: &'a RigidState) -> Self {
        Self::new(&rigid.state).with_body_rates(&rigid.body_rates_rad_s)
    }
}

/// The target at a step, borrowed: with as many derivatives as the law needs.
#[derive(Clone, Copy, Debug)]
pub struct Target<'a> {
    pub(crate) reference: &'a Reference,
    #[cfg(feature = "actuator-aware")]
    pub(crate) motors: Option<&'a MotorReference>,
    pub(crate) progress: Option<Progress>,
    #[cfg(feature = "cascade")]
    pub(crate) sample: Option<(&'a FifthOrderSample, Heading)>,
    #[cfg(feature = "cascade")]
    pub(crate) followed: Followed,
}

impl<'a> Target<'a> {
    /// State, thrust and body rates.
    #[inline]
    pub const fn new(reference: &'a Reference) -> Self {
        Self {
            reference,
            #[cfg(feature = "actuator-aware")]
            motors: None,
            progress: None,
            #[cfg(feature = "cascade")]
            sample: None,
            #[cfg(feature = "cascade")]
            followed: Followed::ALL,
        }
    }

    #[cfg(feature = "actuator-aware")]
    /// The same with the motor forces that fly it.
    #[inline]
    pub const fn with_forces(motors: &'a MotorReference) -> Self {
        Self { motors: Some(motors), ..Self::new(&motors.reference) }
    }

    #[cfg(feature = "cascade")]
    /// The flat output itself, at a heading: the cascade makes a reference of its own, in the air that it knows. The sample's own
    /// angle of heading is not looked at, and no other law can follow this.
    #[inline]
    pub const fn with_sample(sample: &'a FifthOrderSample, heading: Heading) -> Self {
        Self { sample: Some((sample, heading)), ..Self::new(&NOWHERE) }
    }

    #[cfg(feature = "cascade")]
    /// The same with the flat output, for a way between the cascade and another law.
    #[inline]
    pub const fn and_sample(self, sample: &'a FifthOrderSample, heading: Heading) -> Self {
        Self { sample: Some((sample, heading)), ..self }
    }

    #[cfg(feature = "cascade")]
    /// Of a sample, these directions alone: the rest is flown by a pilot.
    #[inline]
    pub const fn following(self, followed: Followed) -> Self {
        Self { followed, ..self }
    }

    /// Where on which trajectory that is, for gains that change along one; without it they are those of its end.
    #[inline]
    pub const fn at(self, progress: Option<Progress>) -> Self {
        Self { progress, ..self }
    }
}

#[cfg(feature = "cascade")]
/// Of targets without a reference.
static NOWHERE: Reference = Reference {
    state: State {
        position_m: Vector3::new(f32::NAN, f32::NAN, f32::NAN),
        attitude: Quaternion::IDENTITY,
        velocity_m_s: Vector3::new(0.0, 0.0, 0.0),
    },
    input: Command::ZERO,
    acceleration_m_s2: Vector3::new(0.0, 0.0, 0.0),
    jerk_m_s3: Vector3::new(0.0, 0.0, 0.0),
    heading: Heading::ZERO,
    heading_rate_rad_s: 0.0,
};

impl<'a> From<&'a Reference> for Target<'a> {
    fn from(reference: &'a Reference) -> Self {
        Self::new(reference)
    }
}

#[cfg(feature = "actuator-aware")]
impl<'a> From<&'a MotorReference> for Target<'a> {
    fn from(motors: &'a MotorReference) -> Self {
        Self::with_forces(motors)
    }
}
