//! The inner loop, per axis in parts: the reference's commands, the LQR's answer to errors of rotation, body rates and forces, and
//! the observed imbalance taken off.

use super::gains::{CascadeGains, TiltGains};
use crate::mixer::Parts;

/// Gains of the fast states; that of the rotation doubled: a step has half the rotation.
#[derive(Clone, Copy, Debug)]
pub(super) struct InnerLoop {
    roll: Axis,
    pitch: Axis,
    yaw: Axis,
    thrust_force: f32,
}

#[derive(Clone, Copy, Debug)]
struct Axis {
    half_rotation: f32,
    body_rate: f32,
    force: f32,
}

/// The errors that the loop answers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Errors {
    pub(super) half_rotation: [f32; 3],
    /// Measured less the reference's, rad/s.
    pub(super) body_rates: [f32; 3],
    /// The observed imbalance: roll, pitch and yaw part, N.
    pub(super) imbalance: [f32; 3],
}

impl InnerLoop {
    pub(super) const fn new(gains: &CascadeGains) -> Self {
        let yaw = gains.yaw();
        Self {
            roll: Axis::of(gains.roll()),
            pitch: Axis::of(gains.pitch()),
            yaw: Axis { half_rotation: 2.0 * yaw.rotation, body_rate: yaw.body_rate, force: yaw.force },
            thrust_force: gains.height().force,
        }
    }

    /// Commands in parts for a thrust part, the reference's forces and commands and the forces that the motors have.
    #[inline(always)]
    pub(super) fn commands(&self, thrust: f32, reference: [&Parts; 2], forces: &Parts, errors: &Errors) -> Parts {
        let ([r, u], e) = (reference, errors);
        let ([ex, ey, ez], [p, q, s], [tx, ty, tz]) = (e.half_rotation, e.body_rates, e.imbalance);
        Parts {
            thrust: thrust + (u.thrust - r.thrust) - self.thrust_force * (forces.thrust - thrust),
            roll: self.roll.command(u.roll, ex, p, forces.roll, r.roll, tx),
            pitch: self.pitch.command(u.pitch, ey, q, forces.pitch, r.pitch, ty),
            yaw: self.yaw.command(u.yaw, ez, s, forces.yaw, r.yaw, tz),
        }
    }
}

impl Axis {
    const fn of(gains: &TiltGains) -> Self {
        Self { half_rotation: 2.0 * gains.rotation, body_rate: gains.body_rate, force: gains.force }
    }

    #[inline(always)]
    fn command(&self, u: f32, half: f32, rate: f32, force: f32, wanted: f32, imbalance: f32) -> f32 {
        let feedback = self.half_rotation * half + self.body_rate * rate + self.force * (force + imbalance - wanted);
        u - feedback - imbalance
    }
}

#[cfg(test)]
mod tests {
    use super::super::gains::tests::BRUSHLESS;
    use super::*;

    #[test]
    fn it_is_the_gain_times_the_errors() {
        let inner = InnerLoop::new(&BRUSHLESS);
        let reference = Parts { thrust: 0.1, roll: 0.01, pitch: -0.01, yaw: 0.001 };
        let commands = Parts { thrust: 0.11, roll: 0.02, pitch: -0.02, yaw: 0.002 };
        let forces = Parts { thrust: 0.09, roll: 0.0, pitch: 0.005, yaw: 0.0 };
        let errors =
            Errors { half_rotation: [0.05, 0.0, 0.02], body_rates: [0.1, -0.2, 0.3], imbalance: [0.001, 0.0, 0.0] };
        let found = inner.commands(0.105, [&reference, &commands], &forces, &errors);
        let wanted = [
            0.105 + 0.01 - 0.585 * (0.09 - 0.105),
            0.02 - (0.2005 * 0.1 + 0.01866 * 0.1 + 1.999 * (0.001 - 0.01)) - 0.001,
            -0.02 - (0.01918 * -0.2 + 1.921 * 0.015),
            0.002 - (0.01115 * 0.04 + 0.0083 * 0.3 + 0.149 * -0.001),
        ];
        for (found, wanted) in [found.thrust, found.roll, found.pitch, found.yaw].into_iter().zip(wanted) {
            assert!((found - wanted).abs() < 1e-7, "{found} {wanted}");
        }
    }
}
