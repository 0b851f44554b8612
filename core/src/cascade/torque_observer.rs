//! The disturbing torque: an observer of the torque (in parts, N) beside motors, rotation and the known moment of the
//! air: a centre of mass that is off, a weak motor. It is fed by the gyroscope alone.
//!
//! Per axis, with forces in parts and `i` the inertia over four levers: `i w^' = f^ + t^ - m - gyroscopic`, m the part that
//! answers the air; the correction by `e = w - w^` has both poles at w_0, or a pair of the given damping.

use nalgebra::Vector3;

use super::bounds::{is_beyond, within};
use crate::airframe::Airframe;
use crate::mixer::Parts;

/// Natural frequency about body x and y, and about z, rad/s. Faster, an uncertain lag of the motors makes it unstable.
const ACROSS_RAD_S: f32 = 3.0;
const YAW_RAD_S: f32 = 1.0;
const DAMPING: f32 = 0.8;

/// Largest part, over the most force of a motor.
const MOST_SHARE: f32 = 0.15;

/// Difference between measured and predicted body rate that no torque makes in a step, rad/s.
const JUMP_RAD_S: f32 = 10.0;

/// Gains and the craft.
#[derive(Clone, Copy, Debug)]
pub(super) struct TorqueObserver {
    /// Period over inertia over four levers: rad/s per N of a part.
    per_force: [f32; 3],
    gyroscopic: [f32; 3],
    /// Of the rate, a step; of the part, N s/rad a step.
    rate_gain: [f32; 3],
    part_gain: [f32; 3],
    most_n: f32,
}

/// Memory of the torque observer: the predicted body rates and the imbalance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Imbalance {
    body_rates: Vector3<f32>,
    /// As parts of the motors' forces: roll, pitch, yaw, N.
    pub(super) parts: [f32; 3],
}

impl Imbalance {
    /// None, at body rates not seen yet: the first are taken as they are.
    pub(super) const NONE: Self = Self { body_rates: Vector3::new(f32::INFINITY, 0.0, 0.0), parts: [0.0; 3] };
}

impl Imbalance {
    /// Forgotten, at body rates: as for a craft on the ground.
    pub(super) fn rest(&mut self, body_rates: &Vector3<f32>) {
        *self = Self { body_rates: *body_rates, ..Self::NONE };
    }
}

impl TorqueObserver {
    /// For a craft and a control period.
    pub(super) const fn new(airframe: &Airframe, period_s: f32) -> Self {
        let [ix, iy, iz] = airframe.mixing.inertia;
        let across = 2.0 * DAMPING * ACROSS_RAD_S * period_s;
        let squared = ACROSS_RAD_S * ACROSS_RAD_S * period_s;
        Self {
            per_force: [period_s / ix, period_s / iy, period_s / iz],
            gyroscopic: airframe.mixing.gyroscopic,
            rate_gain: [across, across, 2.0 * DAMPING * YAW_RAD_S * period_s],
            part_gain: [squared * ix, squared * iy, YAW_RAD_S * YAW_RAD_S * period_s * iz],
            most_n: MOST_SHARE * airframe.figures().force_max_n,
        }
    }

    /// Moves the memory on by a step that has ended with body rates, under forces in parts and an answer to the air (roll and
    /// pitch), the means over it.
    #[inline(always)]
    pub(super) fn step(&self, memory: &mut Imbalance, w: &Vector3<f32>, forces: &Parts, answer: [f32; 2]) {
        let ([tx, ty, tz], known, [gx, gy, gz]) = (memory.parts, memory.body_rates, self.gyroscopic);
        let ([px, py, pz], [kx, ky, kz], [lx, ly, lz]) = (self.per_force, self.rate_gain, self.part_gain);
        let [mx, my] = answer;
        let expected = Vector3::new(
            known.x + px * (forces.roll + tx - mx - gx * (w.y * w.z)),
            known.y + py * (forces.pitch + ty - my - gy * (w.x * w.z)),
            known.z + pz * (forces.yaw + tz - gz * (w.x * w.y)),
        );
        let (ex, ey, ez) = (w.x - expected.x, w.y - expected.y, w.z - expected.z);
        if is_beyond(ex, JUMP_RAD_S) || is_beyond(ey, JUMP_RAD_S) || is_beyond(ez, JUMP_RAD_S) {
            memory.body_rates = *w;
            return;
        }
        memory.body_rates = Vector3::new(expected.x + kx * ex, expected.y + ky * ey, expected.z + kz * ez);
        let most = self.most_n;
        memory.parts = [within(tx + lx * ex, most), within(ty + ly * ey, most), within(tz + lz * ez, most)];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_torque_that_is_not_the_motors_is_found_as_a_part() {
        let (craft, h) = (Airframe::CRAZYFLIE_2_1, 0.002);
        let (observer, imbalance) = (TorqueObserver::new(&craft, h), [0.002, -0.003, 0.0005]);
        let mut settled = Imbalance::NONE;
        for _ in 0..20_000 {
            let forces = Parts { thrust: 0.07, roll: -0.002, pitch: 0.003, yaw: -0.0005 };
            observer.step(&mut settled, &Vector3::zeros(), &forces, [0.0; 2]);
        }
        for (found, wanted) in settled.parts.iter().zip(imbalance) {
            // 40 s: every pole has settled; roundings of the sums.
            assert!((found - wanted).abs() < 1e-5, "{found} {wanted}");
        }
    }

    #[test]
    fn an_answer_to_the_air_is_no_imbalance() {
        let craft = Airframe::CRAZYFLIE_2_1_BRUSHLESS;
        let (observer, mut memory) = (TorqueObserver::new(&craft, 0.002), Imbalance::NONE);
        for _ in 0..5000 {
            let forces = Parts { thrust: 0.1, roll: 0.004, pitch: -0.002, yaw: 0.0 };
            observer.step(&mut memory, &Vector3::zeros(), &forces, [0.004, -0.002]);
        }
        assert_eq!((memory.body_rates, memory.parts), (Vector3::zeros(), [0.0; 3]));
    }
}
