//! Our parts with others' figures: accelerations at random states against RotorPy 3.0.0 and crazyflow 0.4.0, which
//! `tests/fixtures/plants/make.sh` writes.

use std::path::Path;

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3, Vector4};
use quatrack_simulation::plant::{
    Airflow, Craft, LinearWind, Motor, MotorBank, Propeller, RigidBody, RigidState, RotorDrag, SpeedResponse,
};
use serde_json::Value;

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    std::array::from_fn(|i| value[i].as_f64().expect("a number"))
}

fn craft(plant: &Value) -> Craft {
    let signs: [f64; 4] = numbers(&plant["torque_signs"]);
    let motor = |i: usize| Motor {
        position_m: Vector3::from(numbers::<3>(&plant["rotors_m"][i])),
        // The propeller's own torque takes its place; its sign counts.
        torque_per_thrust_m: signs[i],
        rise_lag_s: 1.0,
        fall_lag_s: 1.0,
        thrust_min_n: 0.0,
        thrust_max_n: f64::INFINITY,
    };
    let propeller = Propeller {
        thrust: numbers(&plant["thrust"]),
        torque: Some(numbers(&plant["torque"])),
        inertia_kg_m2: plant["rotor_inertia_kg_m2"].as_f64().expect("a number"),
        response: Some(SpeedResponse { rise: numbers(&plant["rise"]), fall: numbers(&plant["fall"]) }),
    };
    let [across_n_s2_m, along_n_s2_m, lift_n_s2_m2] = numbers(&plant["rotor_drag"]);
    let inertia: [[f64; 3]; 3] = std::array::from_fn(|i| numbers(&plant["inertia_kg_m2"][i]));
    let body = RigidBody::new(plant["mass_kg"].as_f64().expect("a number"), Matrix3::from_fn(|i, j| inertia[i][j]));
    Craft {
        body: body.expect("positive definite"),
        motors: MotorBank {
            motors: [0, 1, 2, 3].map(motor),
            propeller: Some(propeller),
            torque_bias_n_m: Vector3::zeros(),
        },
        air: Some(Airflow {
            drag_n_s_m: Vector3::from(numbers::<3>(&plant["drag_n_s_m"])),
            rotors: Some(RotorDrag { across_n_s2_m, along_n_s2_m, lift_n_s2_m2 }),
            ..Airflow::default()
        }),
        loads: Vec::new(),
    }
}

/// Largest difference of each kind over the rows of a package: m/s^2, rad/s^2, and of the speeds rad/s^2.
fn worst(package: &str, file: &str) -> ([f64; 3], usize) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/plants").join(file);
    let made: Value = serde_json::from_str(&std::fs::read_to_string(path).expect("a fixture")).expect("JSON");
    assert_eq!(made["package"], package);
    let (mut worst, mut count) = ([0.0_f64; 3], 0);
    for plant in made["plants"].as_array().expect("plants") {
        let craft = craft(plant);
        let propeller = craft.motors.propeller.expect("has one");
        let thrusts = |speeds: &[f64]| {
            let [linear, quadratic] = propeller.thrust;
            Vector4::from_fn(|i, _| (linear + quadratic * speeds[i]) * speeds[i])
        };
        for row in plant["rows"].as_array().expect("rows") {
            let row: [f64; 31] = numbers(row);
            let vector = |at: usize| Vector3::from_column_slice(&row[at..at + 3]);
            let state = RigidState {
                position_m: Vector3::zeros(),
                velocity_m_s: vector(4),
                attitude: UnitQuaternion::from_quaternion(Quaternion::new(row[0], row[1], row[2], row[3])),
                body_rates_rad_s: vector(7),
                thrusts_n: thrusts(&row[13..17]),
            };
            let wind = LinearWind { from_m_s: vector(10), ..LinearWind::default() };
            let motion = craft.motion(&state, &thrusts(&row[17..21]), &wind, 0.0);
            worst[0] = worst[0].max((motion.acceleration_m_s2 - vector(21)).amax());
            worst[1] = worst[1].max((motion.angular_acceleration_rad_s2 - vector(24)).amax());
            for i in 0..4 {
                let [linear, quadratic] = propeller.thrust;
                let speed_rate = motion.thrust_rates_n_s[i] / (linear + 2.0 * quadratic * row[13 + i]);
                worst[2] = worst[2].max((speed_rate - row[27 + i]).abs());
            }
            count += 1;
        }
    }
    println!("{package}: {count} states, {worst:?}");
    (worst, count)
}

#[test]
fn accelerations_are_rotorpy_s() {
    let (worst, count) = worst("rotorpy 3.0.0", "rotorpy.json");
    assert_eq!(count, 200);
    // Accelerations up to some 3000 rad/s^2 and 20,000 rad/s^2 of the rotors, in doubles.
    assert!(worst[0] < 1e-9 && worst[1] < 1e-9 && worst[2] < 1e-9, "{worst:?}");
}

#[test]
fn accelerations_are_crazyflow_s() {
    let (worst, count) = worst("crazyflow 0.4.0", "crazyflow.json");
    assert_eq!(count, 200);
    assert!(worst[0] < 1e-9 && worst[1] < 1e-9 && worst[2] < 1e-9, "{worst:?}");
}
