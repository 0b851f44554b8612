//! (LYAP-F) and (LQR-F): linear feedback on the flat state, through the flat map (7).
//!
//! The flat state is `z = [r v a q3]`, with the acceleration that the reference's thrust gives in the measured
//! attitude. The law is computed in the reference's heading frame: the model is symmetric about the vertical, so the
//! paper's law at heading 0, where `q3` of the reference is 0, serves every heading.

use nalgebra::Vector3;

use super::{ControlLaw, FeedForward};
use crate::command::Command;
use crate::flatness::{GRAVITY_M_S2, Tilt};
use crate::gain::Gain;
use crate::math::sqrt;
use crate::reference::Reference;
use crate::state::State;

/// Outputs `[a(3) j(3) q3']` from errors `[r(3) v(3) a(3) q3]`.
pub type FlatOutputGain = Gain<7, 10>;

/// The flat output law.
#[derive(Clone, Copy, Debug)]
pub struct FlatOutput<'a> {
    /// The gain, designed at heading 0.
    pub gain: &'a FlatOutputGain,
    /// Whether the reference's acceleration, jerk and heading rate are added.
    pub feed_forward: FeedForward,
}

impl<'a> FlatOutput<'a> {
    /// The paper's law: no feed-forward.
    pub const fn new(gain: &'a FlatOutputGain) -> Self {
        Self { gain, feed_forward: FeedForward::Without }
    }
}

impl ControlLaw for FlatOutput<'_> {
    #[inline]
    fn command(&self, state: &State, reference: &Reference) -> Command {
        let heading = reference.heading;
        let target = &reference.state;
        let r = heading.to_heading_frame(state.position_m - target.position_m);
        let v = heading.to_heading_frame(state.velocity_m_s - target.velocity_m_s);
        let attitude = heading.attitude_to_heading_frame(state.attitude);
        // The chart's own hemisphere is q0 >= 0.
        let attitude = if attitude.w < 0.0 { -attitude } else { attitude };

        let target_acceleration = heading.to_heading_frame(reference.acceleration_m_s2);
        let axis = attitude.thrust_axis();
        let thrust = reference.input.thrust_m_s2;
        let (ax, ay) = (thrust * axis.x - target_acceleration.x, thrust * axis.y - target_acceleration.y);
        let az = thrust * axis.z - GRAVITY_M_S2 - target_acceleration.z;

        let [v0, v1, v2, v3, v4, v5, v6] = self.gain.times(&[r.x, r.y, r.z, v.x, v.y, v.z, ax, ay, az, attitude.z]);
        let (mut acceleration, mut jerk, mut q3_rate) = (Vector3::new(-v0, -v1, -v2), Vector3::new(-v3, -v4, -v5), -v6);
        if self.feed_forward == FeedForward::With {
            acceleration += target_acceleration;
            jerk += heading.to_heading_frame(reference.jerk_m_s3);
            // q3 = cos(tilt/2) sin(psi/2) in the frame that the heading passes through: psi = 0 there, psi' is not.
            let q = &target.attitude;
            q3_rate += 0.5 * sqrt(q.w * q.w + q.z * q.z) * reference.heading_rate_rad_s;
        }
        Tilt::new(acceleration, jerk).with_q3(attitude.z, q3_rate).input
    }
}
