//! The vertical direction: plant, law and observers in; its closed loop over a period out.

use nalgebra::{DMatrix, DVector};

use super::{Chain, held_velocity};
use crate::certify::cascade::held::HeldChain;
use crate::certify::cascade::observers::ALONG;
use crate::certify::cascade::{CascadeCraft, CascadeVariation};

/// Height.
pub(in crate::certify::cascade) struct HeightChain {
    plant: HeldChain,
    h: f64,
    decay: f64,
    quarter_mass: f64,
    outer: [f64; 2],
    force: f64,
    drag: f64,
}

impl HeightChain {
    pub(in crate::certify::cascade) fn new(craft: &CascadeCraft, at: &CascadeVariation) -> Self {
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
