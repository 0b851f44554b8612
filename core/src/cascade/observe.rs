//! The lower half of a step: the step as it was flown and the accelerometer in; the memory of the observers, the air and the
//! ground, moved on, out.

use nalgebra::Vector3;

use super::air_learner::Felt;
use super::bounds::smaller;
use super::force_observer::Pushed;
use super::memory::Before;
use super::{Cascade, CascadeMemory};

/// Most of the drag that the force observer takes of the measured velocity, 1/s. Certificates go as far.
const BELIEVED_DRAG_MAX_PER_S: f32 = 0.6;

impl Cascade {
    /// The updates after a step: the observers, the air, the ground.
    pub fn observe(&self, memory: &mut CascadeMemory, accelerometer: Option<&Vector3<f32>>) {
        let (seen, before) = (memory.seen, memory.before);
        let (flew, period_s) = (memory.ground.is_flying(), self.actuation.lag.period_s());
        memory.before = Before { velocity: seen.now.velocity, axis: seen.axis, answer: seen.answer };
        let push = memory.disturbance.along;
        memory.ground.step(&seen.now, memory.disturbance.is_on_bound(), push, period_s);
        if !(flew && memory.ground.is_flying()) {
            return memory.rest();
        }
        let thrust = seen.mean_forces.thrust / self.airframe().mixing.quarter_mass_kg;
        let (known, mut mean_velocity) =
            (self.air_learner.now(&memory.air).drag, mean(&before.velocity, &seen.now.velocity));
        let drag = smaller(known, BELIEVED_DRAG_MAX_PER_S);
        if known > drag {
            // Drag known beyond that is taken of the reference's velocity, as the reference has it: it is no part of the
            // loop.
            let (rest, v) = ((known - drag) / drag, &seen.wanted);
            mean_velocity += Vector3::new(rest * v.x, rest * v.y, rest * v.z);
        }
        let pushed =
            Pushed { velocity: seen.now.velocity, mean_velocity, axis: mean(&before.axis, &seen.axis), thrust, drag };
        if self.force_observer.step(&mut memory.disturbance, &pushed) {
            memory.ground.stop(&seen.now.position);
            return memory.rest();
        }
        if seen.undisturbed {
            memory.motors.step(thrust, memory.disturbance.along, period_s);
        }
        let ([rx, ry], [sx, sy]) = (before.answer, seen.answer);
        let (rates, answer) = (&seen.now.body_rates, [0.5 * (rx + sx), 0.5 * (ry + sy)]);
        self.torque_observer.step(&mut memory.imbalance, rates, &seen.mean_forces, answer);
        let felt = Felt {
            accelerometer,
            body_velocity: seen.body_velocity,
            body_rates: rates,
            forces: &seen.mean_forces,
            undisturbed: seen.undisturbed,
        };
        self.air_learner.step(&mut memory.air, &felt);
    }
}

#[inline(always)]
fn mean(a: &Vector3<f32>, b: &Vector3<f32>) -> Vector3<f32> {
    Vector3::new(0.5 * (a.x + b.x), 0.5 * (a.y + b.y), 0.5 * (a.z + b.z))
}
