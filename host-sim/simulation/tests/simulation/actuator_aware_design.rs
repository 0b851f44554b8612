//! The actuator-aware design: the hover model against the rigid plant, the Riccati equation, the structure of the gain.

use nalgebra::{DMatrix, UnitQuaternion, Vector3, Vector4};
use quatrack_design::design::actuator_aware::{
    ActuatorAwareDesign, ActuatorAwareWeights, ERRORS, FORCES, actuator_aware, hover_pair, in_parts, parts,
};
use quatrack_design::design::codegen;
use quatrack_design::design::sampled::shaped;
use quatrack_design::vehicle::Vehicle;
use quatrack_simulation::plant::{Craft, RigidState};
use quatrack_simulation::vehicles;

const PERIOD_S: f64 = 0.002;

fn vehicle() -> Vehicle {
    vehicles::by_name("crazyflie-2.1").expect("built in")
}

fn design(lag_s: f64) -> ActuatorAwareDesign {
    actuator_aware(&vehicle(), lag_s, &ActuatorAwareWeights::STANDARD, PERIOD_S).expect("solved")
}

/// Position, velocity, rotation vector, body rates and parts of the forces, as deviations from hover.
fn deviations(state: &RigidState, hover_n: f64) -> [f64; 16] {
    let rotation = 2.0 * state.attitude.imag();
    let forces = parts() * state.thrusts_n.add_scalar(-hover_n);
    let (r, v, rates) = (state.position_m, state.velocity_m_s, state.body_rates_rad_s);
    let all: Vec<f64> =
        [r, v, rotation, rates].iter().flat_map(|x| x.iter().copied()).chain(forces.iter().copied()).collect();
    all.try_into().expect("16 of them")
}

fn displaced(state: usize, by: f64, hover_n: f64) -> RigidState {
    let mut x = RigidState::at_rest(Vector3::zeros(), hover_n);
    match state {
        0..3 => x.position_m[state] = by,
        3..6 => x.velocity_m_s[state - 3] = by,
        6..9 => {
            let mut rotation = Vector3::zeros();
            rotation[state - 6] = by;
            x.attitude = UnitQuaternion::from_scaled_axis(rotation);
        }
        9..12 => x.body_rates_rad_s[state - 9] = by,
        _ => {
            let mut part = Vector4::zeros();
            part[state - FORCES] = by;
            x.thrusts_n += parts().transpose() * part;
        }
    }
    x
}

#[test]
fn the_hover_model_is_the_derivative_of_the_rigid_plant() {
    for name in vehicles::names() {
        let vehicle = vehicles::by_name(name).expect("built in");
        let (hover_n, craft) = (vehicle.hover_thrust_n(), Craft::new(&vehicle));
        let (a, b) = hover_pair(&vehicle, vehicle.motors().lag_s, 1.0, 1.0);
        let (h, by) = (1e-6, 1e-5);
        let rate = |x: &RigidState, commands: &Vector4<f64>| {
            let (before, after) = (deviations(x, hover_n), deviations(&craft.step(x, commands, 0.0, h), hover_n));
            std::array::from_fn::<f64, 16, _>(|i| (after[i] - before[i]) / h)
        };
        let hover = Vector4::repeat(hover_n);
        for column in 0..20 {
            let (states, commands) = if column < 16 {
                ([by, -by].map(|d| displaced(column, d, hover_n)), [hover; 2])
            } else {
                let pattern = parts().row(column - 16).transpose() * by;
                ([RigidState::at_rest(Vector3::zeros(), hover_n); 2], [hover + pattern, hover - pattern])
            };
            let (up, down) = (rate(&states[0], &commands[0]), rate(&states[1], &commands[1]));
            for row in 0..16 {
                let entry = if column < 16 { a[(row, column)] } else { b[(row, column - 16)] };
                let difference = (up[row] - down[row]) / (2.0 * by);
                // The step of 1 us moves the largest slope, the torque's 4e3 / s^2, by h / 2 of its own slope; central
                // differences of 1e-5 round to 1e-16 / (h by).
                assert!(
                    (difference - entry).abs() < 3e-2 + 1e-5 * entry.abs(),
                    "{name} ({row}, {column}): {difference} {entry}"
                );
            }
        }
    }
}

#[test]
fn the_gain_solves_its_riccati_equation() {
    for name in vehicles::names() {
        let vehicle = vehicles::by_name(name).expect("built in");
        for lag_s in [0.03, 0.0635, 0.126] {
            let design = actuator_aware(&vehicle, lag_s, &ActuatorAwareWeights::STANDARD, PERIOD_S).expect("solved");
            assert!(design.relative_residual < 1e-14, "{name} {lag_s}: {:e}", design.relative_residual);
            assert!(design.last_correction < 1e-13, "{name} {lag_s}: {:e}", design.last_correction);
            assert!(design.poles.iter().all(|pole| pole.norm() < 1.0));
        }
    }
}

/// Columns of each part: its chain.
const CHAINS: [&[usize]; 4] = [&[2, 5, 12, 18], &[1, 4, 6, 9, 13, 17], &[0, 3, 7, 10, 14, 16], &[8, 11, 15]];

#[test]
fn every_chain_has_all_its_entries_and_no_other() {
    for lag_s in [0.0635, 0.126] {
        let gain = design(lag_s).gain_in_parts;
        for (part, chain) in CHAINS.iter().enumerate() {
            for column in 0..ERRORS {
                let entry = gain[(part, column)];
                assert_eq!(entry != 0.0, chain.contains(&column), "({part}, {column}): {entry}");
            }
        }
    }
}

#[test]
fn as_f32_the_gain_of_the_motors_still_decouples_exactly() {
    let design = design(0.126);
    let flown = codegen::rounded(&shaped::<4, 19>(&design.gain).expect("4 x 19"));
    let flown = DMatrix::from_fn(4, ERRORS, |i, j| f64::from(flown[i][j]));
    let again = in_parts(&flown);
    for (part, chain) in CHAINS.iter().enumerate() {
        for column in 0..ERRORS {
            let entry = again[(part, column)];
            // Sums of four f32 of equal size cancel without rounding.
            assert!(chain.contains(&column) || entry == 0.0, "({part}, {column}): {entry:e}");
            // The forces' columns are sums of four roundings.
            assert!((entry - design.gain_in_parts[(part, column)]).abs() <= 4.0 * 6e-8 * design.gain.amax());
        }
    }
}

#[test]
fn a_full_inertia_couples_the_chains() {
    let text = include_str!("../../../../gains/vehicles/crazyflie-2.1.toml")
        .replace("[16.571710e-6, 0.0, 0.0]", "[16.571710e-6, 0.830806e-6, 0.718277e-6]")
        .replace("[0.0, 16.655602e-6, 0.0]", "[0.830806e-6, 16.655602e-6, 1.800197e-6]")
        .replace("[0.0, 0.0, 29.261652e-6]", "[0.718277e-6, 1.800197e-6, 29.261652e-6]");
    let vehicle = vehicles::from_toml(&text).expect("valid");
    let gain =
        actuator_aware(&vehicle, 0.126, &ActuatorAwareWeights::STANDARD, PERIOD_S).expect("solved").gain_in_parts;
    // Roll now answers to pitch and heading too; thrust still to height alone.
    assert!(gain[(1, 7)].abs() > 1e-3 * gain[(1, 6)].abs());
    assert_eq!(gain[(0, 7)], 0.0);
}

#[test]
fn lags_and_weights_out_of_range_are_refused() {
    for lag_s in [0.0, -0.1, f64::NAN] {
        assert!(actuator_aware(&vehicle(), lag_s, &ActuatorAwareWeights::STANDARD, PERIOD_S).is_err());
    }
    let weights = ActuatorAwareWeights { command: 0.0, ..ActuatorAwareWeights::STANDARD };
    assert!(actuator_aware(&vehicle(), 0.1, &weights, PERIOD_S).is_err());
    let weights = ActuatorAwareWeights { position: [-1.0; 3], ..ActuatorAwareWeights::STANDARD };
    assert!(actuator_aware(&vehicle(), 0.1, &weights, PERIOD_S).is_err());
}
