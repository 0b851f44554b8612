//! A horizontal direction with the tilt along it: plant, law and observers in; its closed loop over a period out.

use nalgebra::{DMatrix, DVector};

use super::{Chain, held_velocity};
use crate::certify::cascade::held::HeldChain;
use crate::certify::cascade::observers::{
    ACROSS, ACROSS_PERIOD_S, AIR_LOW_PASS, APPROACH_SHARE, DRAG_LEAST_PER_S, TORQUE_DAMPING, TORQUE_RAD_S,
};
use crate::certify::cascade::{CascadeCraft, CascadeVariation};
use crate::model::GRAVITY_M_S2;

/// A horizontal direction with the tilt along it, of a sign in which all gains are positive.
pub(in crate::certify::cascade) struct TiltChain {
    plant: HeldChain,
    h: f64,
    decay: f64,
    /// Of position and velocity to acceleration; rotation, body rate, force to the part.
    outer: [f64; 2],
    inner: [f64; 3],
    /// Inertia over four levers as told, N s^2.
    inertia: f64,
    /// Drag as it is believed, 1/s; as it is.
    drag: f64,
    drag_felt: f64,
    /// Part of the moment per felt force.
    wind: f64,
    /// Part of the moment per velocity of the approach, as it is believed, N s/m, and the lead of its rate, s.
    moment: f64,
    lead_s: f64,
}

impl TiltChain {
    /// Of the x axis (pitch) or the y axis (roll).
    pub(in crate::certify::cascade) fn new(craft: &CascadeCraft, x_axis: bool, at: &CascadeVariation) -> Self {
        let (gains, h) = (&craft.gains, craft.period_s);
        let first = if x_axis { 8 } else { 3 };
        let k = |i: usize| gains[first + i].abs();
        // The mean of both directions, as the core has it.
        let mean = |i: usize| 0.5 * GRAVITY_M_S2 * ((gains[8 + i] / gains[10]).abs() + (gains[3 + i] / gains[5]).abs());
        let axis = usize::from(x_axis);
        let inertia = craft.inertia_kg_m2[axis] / (4.0 * craft.lever_m);
        let per_part = 1.0 / (inertia * at.inertia_factor);
        let moment = at.moment_factor * craft.moment_n_s[axis] / (craft.inertia_kg_m2[axis] * at.inertia_factor);
        let mut a = DMatrix::zeros(5, 5);
        let mut b = DVector::zeros(5);
        a[(0, 1)] = 1.0;
        a[(1, 1)] = -at.drag_per_s;
        a[(1, 2)] = GRAVITY_M_S2;
        a[(2, 3)] = 1.0;
        a[(3, 1)] = -moment;
        a[(3, 4)] = per_part;
        a[(4, 4)] = -1.0 / at.lag_s;
        b[4] = at.command_factor / at.lag_s;
        let ratio = craft.told_moment_n_s[axis] / craft.told_drag_per_s.max(DRAG_LEAST_PER_S);
        Self {
            plant: HeldChain::new(&a, &b, h, at.late(h)),
            h,
            decay: (-h / craft.lag_s).exp(),
            outer: [mean(0), mean(1)],
            inner: [k(2), k(3), k(4)],
            inertia,
            drag: at.believed_drag_per_s,
            drag_felt: at.drag_per_s,
            wind: craft.gust * at.believed_ratio_factor * ratio / (4.0 * craft.lever_m),
            moment: APPROACH_SHARE * at.believed_ratio_factor * ratio * at.believed_drag_per_s.max(DRAG_LEAST_PER_S)
                / (4.0 * craft.lever_m),
            lead_s: craft.lag_s + 0.5 * h,
        }
    }
}

impl Chain for TiltChain {
    fn states(&self) -> usize {
        self.plant.states() + 16
    }

    fn advance(&self, x: &mut [f64], added: f64, looks: bool) -> f64 {
        let h = self.h;
        let (plant, memory) = x.split_at_mut(self.plant.states());
        let [p, v, tilt, w] = [plant[0], plant[1], plant[2], plant[3]];
        let (held, rest) = memory.split_at_mut(3);
        let [d, s, v_seen, w_seen, t, force, mean_force, tilt_before, v_before, answer_before, low, wind, approach] =
            std::array::from_fn(|i| rest[i]);
        let v_held = held_velocity(held, p, v, h);

        // The command: nothing but errors from rest.
        let (tilt_r, w_r) = (-d / GRAVITY_M_S2, -s / GRAVITY_M_S2);
        let [k_p, k_v] = self.outer;
        let tilt_d = tilt_r - (k_p * p + k_v * v_held) / GRAVITY_M_S2;
        let [k_th, k_w, k_f] = self.inner;
        // The velocity that the position error asks for, and the moment that the air has on it.
        let speeding = k_v * (-k_p / k_v * p - approach);
        let approach = approach + h * speeding;
        let answer = wind + self.moment * approach;
        let u = answer + self.lead_s * self.moment * speeding
            - (k_th * (tilt - tilt_d) + k_w * (w - w_r) + k_f * (force + t - answer))
            - t;
        let next_force = u + (force - u) * self.decay;

        // The observers.
        let expected =
            v_seen + h * (GRAVITY_M_S2 * 0.5 * (tilt_before + tilt) - self.drag * 0.5 * (v_before + v_held) + d);
        let e = v_held - expected;
        let [l1, l2, l3] = ACROSS.map(|gain| gain * h / ACROSS_PERIOD_S);
        let turning = w_seen + h / self.inertia * (mean_force + t - 0.5 * (answer_before + answer));
        let e_w = w - turning;
        let (rate, damping) = (TORQUE_RAD_S[0], TORQUE_DAMPING);
        let (low, wind) = if looks {
            // The accelerometer feels the drag.
            let low = low + AIR_LOW_PASS * (-self.drag_felt * v - low);
            (low, -self.wind * low)
        } else {
            (low, wind)
        };
        rest[..13].copy_from_slice(&[
            d + h * s + l2 * e,
            s + l3 * e,
            expected + l1 * e,
            turning + 2.0 * damping * rate * h * e_w,
            t + rate * rate * h * self.inertia * e_w,
            next_force,
            0.5 * (force + next_force),
            tilt,
            v_held,
            answer,
            low,
            wind,
            approach,
        ]);
        self.plant.advance(plant, u + added);
        u
    }
}
