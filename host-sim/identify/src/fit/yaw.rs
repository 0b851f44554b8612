//! About z: inertia over the air's torque, the lead that the rotors' own inertia gives, damping.

use super::drag::Regression;
use super::prior::Base;
use super::problem::{Drive, Prepared};
use crate::filter::derivative;
use crate::flight::STEP_S;

/// Largest ratio of the two inertias; beyond it none is told.
const MOST_APART: f64 = 1.35;

/// The yaw balance `M = J w' + d w - L M'`, in which the torque of speeding up comes with `M'`, solved both ways.
pub(super) struct Yaw {
    /// The torque by the motion: J, kg m^2; d, N m s; L, s. Noise of the motion makes its J small.
    pub(super) forward: Regression,
    /// J of the motion by the torque, kg m^2. Disturbances, which the torque answers, make it large.
    backward_kg_m2: f64,
}

impl Yaw {
    pub(super) fn of(sections: &[Prepared], base: &Base, drive: &Drive, full_m_s2: &[f64]) -> Self {
        let columns = |one: &Prepared| {
            let scale = 0.25 * base.mass_kg * full_m_s2[one.flight] * base.torque_per_thrust_m;
            let torque: Vec<f64> = one.drive(drive).mixture[2].iter().map(|m| scale * m).collect();
            let lead = derivative(&torque, STEP_S).into_iter().map(|m| -m).collect::<Vec<_>>();
            [one.centred(&one.angular[2]), one.centred(&one.rates[2]), one.centred(&lead), one.centred(&torque)]
        };
        let forward = Regression::of(sections, 3, |one| columns(one).into());
        let backward = Regression::of(sections, 3, |one| {
            let [angular, rates, lead, torque] = columns(one);
            vec![torque, rates, lead, angular]
        });
        Self { forward, backward_kg_m2: backward.values[0].recip() }
    }

    /// The two inertias, kg m^2, between which the true one lies; nothing where they are too far apart to tell it.
    pub(super) fn bracket(&self) -> Option<[f64; 2]> {
        let ends = [self.forward.values[0], self.backward_kg_m2];
        // A NaN is neither.
        let told = ends.iter().all(|inertia| *inertia > 0.0);
        let [least, most] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        (told && most <= MOST_APART * least).then_some([least, most])
    }

    /// Both inertias for a message.
    pub(super) fn told(&self) -> String {
        format!("{:.2e} and {:.2e} kg m^2", self.forward.values[0], self.backward_kg_m2)
    }
}
