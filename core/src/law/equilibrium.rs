//! (LYAP-E) and (LQR-E): `u = u_e - K (x - x_r)`, the gain designed on the model linearised at hover.

use nalgebra::Vector3;

use super::{ControlLaw, FeedForward};
use crate::command::Command;
use crate::flatness::GRAVITY_M_S2;
use crate::gain::Gain;
use crate::reference::Reference;
use crate::state::State;

/// Outputs `[T p q r]` from errors `[x y z q1 q2 q3 vx vy vz]`.
pub type EquilibriumGain = Gain<4, 9>;

/// What `x - x_r` means when the craft is turned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ErrorForm {
    /// Position and velocity errors in the reference's heading frame, vector part of `q_r^-1 q`: the same closed loop
    /// at every heading.
    #[default]
    HeadingFrame,
    /// The paper's own form: errors in the world frame, vector part of `q - q_r`. The same to first order near heading
    /// 0, unstable at 90 degrees.
    Paper,
}

/// The equilibrium law.
#[derive(Clone, Copy, Debug)]
pub struct Equilibrium<'a> {
    /// The gain, designed at heading 0.
    pub gain: &'a EquilibriumGain,
    /// How the error is formed.
    pub error_form: ErrorForm,
    /// Whether the reference's input replaces the hover input `u_e`.
    pub feed_forward: FeedForward,
}

impl<'a> Equilibrium<'a> {
    /// The law as one flies it: errors in the heading frame, no feed-forward.
    pub const fn new(gain: &'a EquilibriumGain) -> Self {
        Self { gain, error_form: ErrorForm::HeadingFrame, feed_forward: FeedForward::Without }
    }

    fn error(&self, state: &State, reference: &Reference) -> [f32; 9] {
        let target = &reference.state;
        let r = state.position_m - target.position_m;
        let v = state.velocity_m_s - target.velocity_m_s;
        match self.error_form {
            ErrorForm::HeadingFrame => {
                let r = reference.heading.to_heading_frame(r);
                let v = reference.heading.to_heading_frame(v);
                let q = target.attitude.conjugate() * state.attitude;
                // The measured attitude in the reference's hemisphere: its error has a scalar part above zero.
                let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
                [r.x, r.y, r.z, sign * q.x, sign * q.y, sign * q.z, v.x, v.y, v.z]
            }
            ErrorForm::Paper => {
                let q = state.attitude.in_hemisphere_of(target.attitude);
                let (dx, dy, dz) = (q.x - target.attitude.x, q.y - target.attitude.y, q.z - target.attitude.z);
                [r.x, r.y, r.z, dx, dy, dz, v.x, v.y, v.z]
            }
        }
    }
}

impl ControlLaw for Equilibrium<'_> {
    #[inline]
    fn command(&self, state: &State, reference: &Reference) -> Command {
        let [thrust, p, q, r] = self.gain.times(&self.error(state, reference));
        match self.feed_forward {
            FeedForward::Without => {
                Command { thrust_m_s2: GRAVITY_M_S2 - thrust, body_rates_rad_s: Vector3::new(-p, -q, -r) }
            }
            FeedForward::With => {
                let input = &reference.input;
                let rates = &input.body_rates_rad_s;
                Command {
                    thrust_m_s2: input.thrust_m_s2 - thrust,
                    body_rates_rad_s: Vector3::new(rates.x - p, rates.y - q, rates.z - r),
                }
            }
        }
    }
}
