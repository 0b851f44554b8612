//! The jerk of a motion as it was sent and the accelerations beside it in; which of them the jerk is taken from out.

use quatrack::nalgebra::Vector3;

use super::Stream;
use crate::motion::Motion;

/// Largest difference of a sound jerk, in the mean of two setpoints, from the slope of their accelerations: m/s^3, summed over
/// the axes, and a share of the jerk for dates that are half a millisecond off.
const JERK_OFF_MAX_M_S3: f32 = 0.5;
const JERK_OFF_SHARE: f32 = 0.15;

/// Jerks in a row that are not sound after which they are no longer taken, and sound ones after which they are again: a quarter
/// of a second.
const UNSOUND_JERKS: u8 = 3;
const SOUND_JERKS: u8 = 25;

/// Source of a motion's jerk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Source {
    /// As it is sent; how many in a row were not the slope of the accelerations.
    Sent { unsound: u8 },
    /// The accelerations: none is sent.
    Accelerations,
    /// The accelerations: the sent jerk is not their slope. How many in a row were.
    Mistrusted { sound: u8 },
}

impl Stream {
    /// Where the jerk of a motion so many seconds after the newest setpoint is to come from.
    ///
    /// The firmware turns a trajectory that is started with a relative yaw, but for its jerk (`traj_eval_transform`). Jerks
    /// that are not the slope of the accelerations are not taken.
    #[inline(always)]
    pub(super) fn source_of(&self, motion: &Motion, gap_s: f32) -> Source {
        let (new, j) = (&motion.acceleration_m_s2, &motion.jerk_m_s3);
        let (old, k) = (&self.newest.acceleration_m_s2, &self.sent_jerk_m_s3);
        if is_zero(j) && !matches!(self.source, Source::Mistrusted { .. }) {
            return Source::Accelerations;
        }
        let twice = 2.0 / gap_s;
        let axis = |new: f32, old: f32, j: f32, k: f32| {
            let sum = j + k;
            ((twice * (new - old) - sum).abs(), sum.abs())
        };
        let (x, y, z) = (axis(new.x, old.x, j.x, k.x), axis(new.y, old.y, j.y, k.y), axis(new.z, old.z, j.z, k.z));
        let is_sound = x.0 + y.0 + z.0 <= 2.0 * JERK_OFF_MAX_M_S3 + JERK_OFF_SHARE * (x.1 + y.1 + z.1);
        match self.source {
            Source::Accelerations => Source::Sent { unsound: 0 },
            Source::Sent { .. } if is_sound => Source::Sent { unsound: 0 },
            Source::Sent { unsound } if unsound + 1 < UNSOUND_JERKS => Source::Sent { unsound: unsound + 1 },
            Source::Sent { .. } => Source::Mistrusted { sound: 0 },
            Source::Mistrusted { .. } if !is_sound => Source::Mistrusted { sound: 0 },
            Source::Mistrusted { sound } if sound < SOUND_JERKS => Source::Mistrusted { sound: sound + 1 },
            Source::Mistrusted { .. } => Source::Sent { unsound: 0 },
        }
    }
}

#[inline(always)]
pub(super) fn is_zero(v: &Vector3<f32>) -> bool {
    v.x == 0.0 && v.y == 0.0 && v.z == 0.0
}
