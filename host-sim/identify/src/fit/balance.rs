//! The balance of torques along a stretch of flight, for pictures: the motors' torque, the part that rotation and air
//! explain, and the rest.

use super::model::{FlightFit, Model};
use super::prior::Base;
use super::problem::Prepared;
use crate::flight::{Flight, RATE_HZ, STEP_S};

/// A stretch of at most 20 s, low-passed, each section's mean taken off, N m.
#[derive(Clone, Debug, PartialEq)]
pub struct Balance {
    /// Its file.
    pub flight: String,
    /// s.
    pub times_s: Vec<f64>,
    /// About x and y: of the motors.
    pub motors: [Vec<f64>; 2],
    /// The part that rotation and air explain.
    pub explained: [Vec<f64>; 2],
}

/// Of the longest section.
pub(super) fn balance(
    flights: &[Flight],
    sections: &[Prepared],
    base: &Base,
    model: &Model,
    fits: &[FlightFit],
) -> Option<Balance> {
    let one = sections.iter().max_by_key(|one| one.inner.len())?;
    let full = fits.get(one.flight)?.full_m_s2;
    let driven = one.drive(&model.drive);
    let arm_n_m = 0.25 * base.mass_kg * full * base.half_arm_m;
    let count = one.inner.len().min((20.0 * RATE_HZ) as usize);
    let from = one.inner.len() - count;
    let shown = |signal: Vec<f64>| signal[from..].to_vec();
    let explained = [0, 1].map(|axis| {
        let (angular, across, rates) =
            (one.centred(&one.angular[axis]), one.centred(&one.velocity[1 - axis]), one.centred(&one.rates[axis]));
        let moment = if axis == 0 { -model.moment[0] } else { model.moment[1] };
        shown(
            (0..angular.len())
                .map(|i| model.inertia[axis] * angular[i] + moment * across[i] + model.damping[axis] * rates[i])
                .collect(),
        )
    });
    Some(Balance {
        flight: flights.get(one.flight)?.name.clone(),
        times_s: (0..count).map(|i| one.start_s + (one.inner.start + from + i) as f64 * STEP_S).collect(),
        motors: [0, 1].map(|axis| shown(one.centred(&driven.mixture[axis]).into_iter().map(|m| arm_n_m * m).collect())),
        explained,
    })
}
