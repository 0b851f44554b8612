//! The signals of the rows and columns of the matrices, with their units.

use quatrack::gains::table::TableKind;
use serde::Serialize;

/// A state or an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Signal {
    /// Its name in the paper.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
}

const fn signal(name: &'static str, unit: &'static str) -> Signal {
    Signal { name, unit }
}

/// States of the model (1), `[r q v]`.
pub(super) const MODEL_STATES: [Signal; 10] = [
    signal("x", "m"),
    signal("y", "m"),
    signal("z", "m"),
    signal("q0", "1"),
    signal("q1", "1"),
    signal("q2", "1"),
    signal("q3", "1"),
    signal("vx", "m/s"),
    signal("vy", "m/s"),
    signal("vz", "m/s"),
];

/// Errors of the equilibrium laws.
pub(super) const EQUILIBRIUM_STATES: [Signal; 9] = [
    signal("x", "m"),
    signal("y", "m"),
    signal("z", "m"),
    signal("q1", "1"),
    signal("q2", "1"),
    signal("q3", "1"),
    signal("vx", "m/s"),
    signal("vy", "m/s"),
    signal("vz", "m/s"),
];

/// Errors of the law with integral action.
pub(super) const INTEGRAL_STATES: [Signal; 12] = [
    signal("x", "m"),
    signal("y", "m"),
    signal("z", "m"),
    signal("q1", "1"),
    signal("q2", "1"),
    signal("q3", "1"),
    signal("vx", "m/s"),
    signal("vy", "m/s"),
    signal("vz", "m/s"),
    signal("ix", "m s"),
    signal("iy", "m s"),
    signal("iz", "m s"),
];

/// Inputs of the model (1).
pub(super) const EQUILIBRIUM_INPUTS: [Signal; 4] =
    [signal("T", "m/s^2"), signal("p", "rad/s"), signal("q", "rad/s"), signal("r", "rad/s")];

/// The flat state (6a).
pub(super) const FLAT_STATES: [Signal; 10] = [
    signal("x", "m"),
    signal("y", "m"),
    signal("z", "m"),
    signal("vx", "m/s"),
    signal("vy", "m/s"),
    signal("vz", "m/s"),
    signal("ax", "m/s^2"),
    signal("ay", "m/s^2"),
    signal("az", "m/s^2"),
    signal("q3", "1"),
];

/// The flat input (6b).
pub(super) const FLAT_INPUTS: [Signal; 7] = [
    signal("ax", "m/s^2"),
    signal("ay", "m/s^2"),
    signal("az", "m/s^2"),
    signal("jx", "m/s^3"),
    signal("jy", "m/s^3"),
    signal("jz", "m/s^3"),
    signal("q3_rate", "1/s"),
];

/// Errors of the actuator-aware law.
pub(super) const MOTOR_STATES: [Signal; 19] = [
    signal("x", "m"),
    signal("y", "m"),
    signal("z", "m"),
    signal("vx", "m/s"),
    signal("vy", "m/s"),
    signal("vz", "m/s"),
    signal("theta_x", "rad"),
    signal("theta_y", "rad"),
    signal("theta_z", "rad"),
    signal("p", "rad/s"),
    signal("q", "rad/s"),
    signal("r", "rad/s"),
    signal("f1", "N"),
    signal("f2", "N"),
    signal("f3", "N"),
    signal("f4", "N"),
    signal("ix", "m s"),
    signal("iy", "m s"),
    signal("iz", "m s"),
];

/// Commanded forces of the motors.
pub(super) const MOTOR_INPUTS: [Signal; 4] =
    [signal("u1", "N"), signal("u2", "N"), signal("u3", "N"), signal("u4", "N")];

/// States of the cascade's model: forces in orthonormal parts.
pub(super) const PART_STATES: [Signal; 16] = [
    signal("x", "m"),
    signal("y", "m"),
    signal("z", "m"),
    signal("vx", "m/s"),
    signal("vy", "m/s"),
    signal("vz", "m/s"),
    signal("theta_x", "rad"),
    signal("theta_y", "rad"),
    signal("theta_z", "rad"),
    signal("p", "rad/s"),
    signal("q", "rad/s"),
    signal("r", "rad/s"),
    signal("f_thrust", "N"),
    signal("f_roll", "N"),
    signal("f_pitch", "N"),
    signal("f_yaw", "N"),
];

/// Commanded parts of the forces.
pub(super) const PART_INPUTS: [Signal; 4] =
    [signal("u_thrust", "N"), signal("u_roll", "N"), signal("u_pitch", "N"), signal("u_yaw", "N")];

/// The gains of the cascade, chain by chain: the error of each, and which part of a motor's force.
pub(super) const CHAIN_GAINS: [Signal; 16] = [
    signal("z", "N/m"),
    signal("vz", "N s/m"),
    signal("f_thrust", "1"),
    signal("y", "N/m"),
    signal("vy", "N s/m"),
    signal("theta_x", "N/rad"),
    signal("p", "N s/rad"),
    signal("f_roll", "1"),
    signal("x", "N/m"),
    signal("vx", "N s/m"),
    signal("theta_y", "N/rad"),
    signal("q", "N s/rad"),
    signal("f_pitch", "1"),
    signal("theta_z", "N/rad"),
    signal("r", "N s/rad"),
    signal("f_yaw", "1"),
];

/// The output of the gains of the cascade: a part of a motor's force.
pub(super) const CHAIN_OUTPUT: [Signal; 1] = [signal("part", "N")];

/// The signals of the rows and the columns of a table.
pub fn signals(kind: TableKind) -> (&'static [Signal], &'static [Signal]) {
    match kind {
        TableKind::Integral => (&EQUILIBRIUM_INPUTS, &INTEGRAL_STATES),
        TableKind::Equilibrium | TableKind::AlongTrajectory => (&EQUILIBRIUM_INPUTS, &EQUILIBRIUM_STATES),
        TableKind::FlatOutput => (&FLAT_INPUTS, &FLAT_STATES),
        TableKind::ActuatorAware => (&MOTOR_INPUTS, &MOTOR_STATES),
        TableKind::Cascade => (&CHAIN_OUTPUT, &CHAIN_GAINS),
        // A kind that the core has and no design makes.
        _ => (&[], &[]),
    }
}
