//! The closed loop of the cascade, chain by chain, at hover: the core's step where nothing is limited, in f64, on a
//! plant that differs from the told one.
//!
//! A chain is a linear map of its states over a control period; its matrix is found by sending unit vectors through it.
//! The states are the plant's, the commands that wait, and the controller's memory.

use nalgebra::{DMatrix, DVector};

use super::held::HeldChain;
use super::observers::{
    ACROSS, ACROSS_PERIOD_S, AIR_LOW_PASS, ALONG, APPROACH_SHARE, DRAG_LEAST_PER_S, HELD_RAD_S, TORQUE_DAMPING,
    TORQUE_RAD_S,
};
use super::{CascadeCraft, CascadeVariation};
use crate::model::GRAVITY_M_S2;

/// A closed loop of one chain.
pub(super) trait Chain {
    /// Number of states.
    fn states(&self) -> usize;
    /// Moves the states on by a period, with something added to the command; gives the command. Every fifth period the
    /// accelerometer is looked at.
    fn advance(&self, x: &mut [f64], added: f64, looks: bool) -> f64;

    /// The matrices of a period: of the states, of an addition to the command, and the command's row.
    fn matrices(&self, looks: bool) -> (DMatrix<f64>, DVector<f64>, DVector<f64>) {
        let n = self.states();
        let (mut a, mut row) = (DMatrix::zeros(n, n), DVector::zeros(n));
        for j in 0..n {
            let mut x = vec![0.0; n];
            x[j] = 1.0;
            row[j] = self.advance(&mut x, 0.0, looks);
            a.set_column(j, &DVector::from_vec(x));
        }
        let mut x = vec![0.0; n];
        let _ = self.advance(&mut x, 1.0, looks);
        (a, DVector::from_vec(x), row)
    }
}

/// `p^`, bias and last velocity: the velocity held to the position.
fn held_velocity(memory: &mut [f64], p: f64, v: f64, h: f64) -> f64 {
    let (moved, bias) = (memory[0] + h * (0.5 * (v + memory[2]) - memory[1]), memory[1]);
    let e = p - moved;
    memory[1] = bias - h * HELD_RAD_S * HELD_RAD_S * e;
    memory[0] = moved + h * 2.0 * HELD_RAD_S * e;
    memory[2] = v;
    v - memory[1]
}

/// A horizontal direction with the tilt along it, of a sign in which all gains are positive.
pub(super) struct TiltChain {
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
    pub(super) fn new(craft: &CascadeCraft, x_axis: bool, at: &CascadeVariation) -> Self {
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

/// Height.
pub(super) struct HeightChain {
    plant: HeldChain,
    h: f64,
    decay: f64,
    quarter_mass: f64,
    outer: [f64; 2],
    force: f64,
    drag: f64,
}

impl HeightChain {
    pub(super) fn new(craft: &CascadeCraft, at: &CascadeVariation) -> Self {
        let (gains, h) = (&craft.gains, craft.period_s);
        let quarter_mass = 0.25 * craft.mass_kg;
        let mut a = DMatrix::zeros(3, 3);
        let mut b = DVector::zeros(3);
        a[(0, 1)] = 1.0;
        a[(1, 1)] = -at.drag_per_s;
        a[(1, 2)] = 1.0 / (quarter_mass * at.mass_factor);
        a[(2, 2)] = -1.0 / at.lag_s;
        b[2] = at.command_factor / at.lag_s;
        let share = quarter_mass * (1.0 + gains[2]);
        Self {
            plant: HeldChain::new(&a, &b, h, at.late(h)),
            h,
            decay: (-h / craft.lag_s).exp(),
            quarter_mass,
            outer: [gains[0] / share, gains[1] / share],
            force: gains[2],
            drag: at.believed_drag_per_s,
        }
    }
}

impl Chain for HeightChain {
    fn states(&self) -> usize {
        self.plant.states() + 8
    }

    fn advance(&self, x: &mut [f64], added: f64, _looks: bool) -> f64 {
        let h = self.h;
        let (plant, memory) = x.split_at_mut(self.plant.states());
        let [p, v] = [plant[0], plant[1]];
        let (held, rest) = memory.split_at_mut(3);
        let [d, v_seen, force, mean_force, v_before] = std::array::from_fn(|i| rest[i]);
        let v_held = held_velocity(held, p, v, h);
        let [k_p, k_v] = self.outer;
        let thrust = self.quarter_mass * (-(k_p * p + k_v * v_held) - d);
        let u = thrust - self.force * (force - thrust);
        let next_force = u + (force - u) * self.decay;
        let expected = v_seen + h * (mean_force / self.quarter_mass + d - self.drag * 0.5 * (v_before + v_held));
        let e = v_held - expected;
        let [rate, damping] = ALONG;
        rest[..5].copy_from_slice(&[
            d + rate * rate * h * e,
            expected + 2.0 * damping * rate * h * e,
            next_force,
            0.5 * (force + next_force),
            v_held,
        ]);
        self.plant.advance(plant, u + added);
        u
    }
}

/// Heading.
pub(super) struct YawChain {
    plant: HeldChain,
    h: f64,
    decay: f64,
    inertia: f64,
    gains: [f64; 3],
}

impl YawChain {
    pub(super) fn new(craft: &CascadeCraft, at: &CascadeVariation) -> Self {
        let h = craft.period_s;
        let inertia = craft.inertia_kg_m2[2] / (4.0 * craft.torque_per_thrust_m);
        let mut a = DMatrix::zeros(3, 3);
        let mut b = DVector::zeros(3);
        a[(0, 1)] = 1.0;
        a[(1, 2)] = 1.0 / (inertia * at.inertia_factor);
        a[(2, 2)] = -1.0 / at.lag_s;
        b[2] = at.command_factor / at.lag_s;
        let plant = HeldChain::new(&a, &b, h, at.late(h));
        let gains = [craft.gains[13], craft.gains[14], craft.gains[15]];
        Self { plant, h, decay: (-h / craft.lag_s).exp(), inertia, gains }
    }
}

impl Chain for YawChain {
    fn states(&self) -> usize {
        self.plant.states() + 4
    }

    fn advance(&self, x: &mut [f64], added: f64, _looks: bool) -> f64 {
        let h = self.h;
        let (plant, rest) = x.split_at_mut(self.plant.states());
        let [turn, w] = [plant[0], plant[1]];
        let [w_seen, t, force, mean_force] = std::array::from_fn(|i| rest[i]);
        let [k_th, k_w, k_f] = self.gains;
        let u = -(k_th * turn + k_w * w + k_f * (force + t)) - t;
        let next_force = u + (force - u) * self.decay;
        let turning = w_seen + h / self.inertia * (mean_force + t);
        let e = w - turning;
        let (rate, damping) = (TORQUE_RAD_S[1], TORQUE_DAMPING);
        rest[..4].copy_from_slice(&[
            turning + 2.0 * damping * rate * h * e,
            t + rate * rate * h * self.inertia * e,
            next_force,
            0.5 * (force + next_force),
        ]);
        self.plant.advance(plant, u + added);
        u
    }
}
