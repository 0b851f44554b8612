//! The heading: plant and law in; its closed loop over a period out.

use nalgebra::{DMatrix, DVector};

use super::Chain;
use crate::certify::cascade::held::HeldChain;
use crate::certify::cascade::observers::{TORQUE_DAMPING, TORQUE_RAD_S};
use crate::certify::cascade::{CascadeCraft, CascadeVariation};

/// Heading.
pub(in crate::certify::cascade) struct YawChain {
    plant: HeldChain,
    h: f64,
    decay: f64,
    inertia: f64,
    gains: [f64; 3],
}

impl YawChain {
    pub(in crate::certify::cascade) fn new(craft: &CascadeCraft, at: &CascadeVariation) -> Self {
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
