//! About z: inertia over the air's torque, the lead that the rotors' own inertia gives, damping.

use super::drag::Regression;
use super::prior::Base;
use super::problem::{Drive, Prepared};
use crate::filter::derivative;
use crate::flight::STEP_S;

/// `M = J w' + d w - L M'`: the torque of speeding up comes with `M'`, so that the yaw leads.
pub(super) fn yaw(sections: &[Prepared], base: &Base, drive: &Drive, full_m_s2: &[f64]) -> Regression {
    Regression::of(sections, 3, |one| {
        let scale = 0.25 * base.mass_kg * full_m_s2[one.flight] * base.torque_per_thrust_m;
        let torque: Vec<f64> = one.drive(drive).mixture[2].iter().map(|m| scale * m).collect();
        let lead = derivative(&torque, STEP_S).into_iter().map(|m| -m).collect::<Vec<_>>();
        vec![one.centred(&one.angular[2]), one.centred(&one.rates[2]), one.centred(&lead), one.centred(&torque)]
    })
}
