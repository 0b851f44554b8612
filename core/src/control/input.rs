//! What a step is given: what is measured of the craft, and what it is to follow.

use nalgebra::Vector3;

use crate::motor_reference::MotorReference;
use crate::reference::Reference;
use crate::rigid_state::RigidState;
use crate::state::State;
use crate::trajectory::Progress;

/// What is measured of a craft at a step, borrowed from where it is.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    pub(crate) state: &'a State,
    pub(crate) body_rates_rad_s: Option<&'a Vector3<f32>>,
}

impl<'a> Measured<'a> {
    /// An estimated state; its quaternion may have either sign.
    #[inline]
    pub const fn new(state: &'a State) -> Self {
        Self { state, body_rates_rad_s: None }
    }

    /// With the gyroscope's body rates `p q r`, rad/s: what a law of motor forces takes, and who carries a command to them.
    #[inline]
    pub const fn with_body_rates(self, body_rates_rad_s: &'a Vector3<f32>) -> Self {
        Self { body_rates_rad_s: Some(body_rates_rad_s), ..self }
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

/// What is to be followed at a step, borrowed from where it is: as deep as the law needs it ([`super::Law::follows_forces`]).
#[derive(Clone, Copy, Debug)]
pub struct Target<'a> {
    pub(crate) reference: &'a Reference,
    pub(crate) motors: Option<&'a MotorReference>,
    pub(crate) progress: Option<Progress>,
}

impl<'a> Target<'a> {
    /// State, thrust and body rates.
    #[inline]
    pub const fn new(reference: &'a Reference) -> Self {
        Self { reference, motors: None, progress: None }
    }

    /// The same with the motor forces that fly it.
    #[inline]
    pub const fn with_forces(motors: &'a MotorReference) -> Self {
        Self { reference: &motors.reference, motors: Some(motors), progress: None }
    }

    /// Where on which trajectory that is, for gains that change along one; without it they are those of its end.
    #[inline]
    pub const fn at(self, progress: Option<Progress>) -> Self {
        Self { progress, ..self }
    }
}

impl<'a> From<&'a Reference> for Target<'a> {
    fn from(reference: &'a Reference) -> Self {
        Self::new(reference)
    }
}

impl<'a> From<&'a MotorReference> for Target<'a> {
    fn from(motors: &'a MotorReference) -> Self {
        Self::with_forces(motors)
    }
}
