//! Weights: a design's `[weights]` in; the diagonals of a linearisation out, each key where it belongs.

use quatrack_design::design::synthesis::{EquilibriumWeights, FlatWeights};

use super::entry::{misplaced, missing, non_negative, positive};
use crate::gains::GainsError;
use crate::gains::file::{Linearisation, Weights};

pub(super) fn equilibrium_weights(weights: &Weights) -> Result<EquilibriumWeights, GainsError> {
    let here = Linearisation::Equilibrium;
    absent("acceleration", weights.acceleration, here)?;
    absent("q3", weights.q3, here)?;
    absent("acceleration_input", weights.acceleration_input, here)?;
    absent("jerk_input", weights.jerk_input, here)?;
    absent("q3_rate_input", weights.q3_rate_input, here)?;
    let [x, y, z] = triple("position", weights.position, here)?;
    let [q1, q2, q3] = triple("attitude", weights.attitude, here)?;
    let [vx, vy, vz] = triple("velocity", weights.velocity, here)?;
    let thrust = single("thrust_input", weights.thrust_input, here)?;
    let [p, q, r] = triple("body_rate_input", weights.body_rate_input, here)?;
    Ok(EquilibriumWeights { state: [x, y, z, q1, q2, q3, vx, vy, vz], input: [thrust, p, q, r] })
}

pub(super) fn flat_weights(weights: &Weights) -> Result<FlatWeights, GainsError> {
    let here = Linearisation::FlatOutput;
    absent("attitude", weights.attitude, here)?;
    absent("thrust_input", weights.thrust_input, here)?;
    absent("body_rate_input", weights.body_rate_input, here)?;
    let [x, y, z] = triple("position", weights.position, here)?;
    let [vx, vy, vz] = triple("velocity", weights.velocity, here)?;
    let [ax, ay, az] = triple("acceleration", weights.acceleration, here)?;
    let q3 = single("q3", weights.q3, here)?;
    let [ux, uy, uz] = triple("acceleration_input", weights.acceleration_input, here)?;
    let [jx, jy, jz] = triple("jerk_input", weights.jerk_input, here)?;
    let rate = single("q3_rate_input", weights.q3_rate_input, here)?;
    Ok(FlatWeights { state: [x, y, z, vx, vy, vz, ax, ay, az, q3], input: [ux, uy, uz, jx, jy, jz, rate] })
}

fn absent(key: &str, value: Option<impl std::fmt::Debug>, here: Linearisation) -> Result<(), GainsError> {
    value.map_or(Ok(()), |value| Err(misplaced(&format!("weights.{key}"), &format!("{value:?}"), &here)))
}

fn triple(key: &str, value: Option<[f64; 3]>, here: Linearisation) -> Result<[f64; 3], GainsError> {
    let value = value.ok_or_else(|| missing(&format!("weights.{key}"), &here, "three numbers, [x, y, z]"))?;
    value.iter().try_for_each(|entry| weight(key, *entry))?;
    Ok(value)
}

fn single(key: &str, value: Option<f64>, here: Linearisation) -> Result<f64, GainsError> {
    let value = value.ok_or_else(|| missing(&format!("weights.{key}"), &here, "a number"))?;
    weight(key, value)?;
    Ok(value)
}

/// A state may go without a weight; whether that leaves a mode unseen is for the solver to say. An input may not.
pub(super) fn weight(key: &str, value: f64) -> Result<(), GainsError> {
    let name = format!("weights.{key}");
    if key.ends_with("_input") { positive(&name, value) } else { non_negative(&name, value) }
}
