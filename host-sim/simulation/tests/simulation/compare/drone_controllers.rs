//! Our Mellinger beside that of drone-controllers 0.1.0, step by step, with that package's own gains.
//!
//! The package reckons with the mass that the firmware has for each craft and keeps the firmware's factor of force to command,
//! which is for motors of 0.124 N: its thrust is 0.967 to 1.611 of the law's, so that its craft hover
//! at 0.88, 1.24 and 1.46 of their weight. Both figures are parameters here, so that the laws are compared and not the craft.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use quatrack_simulation::control_law::{Estimate, Input, Setpoint};
use quatrack_simulation::rivals::{Actuation, Mellinger, MellingerConfig};
use serde_json::Value;

/// Written by `drone_controllers_mellinger.py` beside it.
const FIXTURE: &str = include_str!("../../fixtures/mellinger/drone_controllers_mellinger.json");

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from_column_slice(&numbers(value))
}

fn law(parameters: &Value) -> Mellinger {
    let (state, attitude) = (&parameters["state"], &parameters["attitude"]);
    let number = |value: &Value| value.as_f64().unwrap();
    let actuation = Actuation {
        half_arm_m: number(&attitude["L"]),
        torque_per_thrust_m: number(&attitude["thrust2torque"]),
        thrust_max_n: number(&attitude["thrust_max"]),
    };
    let own = MellingerConfig::firmware(number(&state["mass"]), &actuation);
    // Numbers of the firmware, as the configuration has them from the same gains.
    let torque = own.rates.x / 20_000.0;
    let yaw = own.rates.z / 12_000.0;
    let torques = |value: &Value| vector(value).component_mul(&Vector3::new(torque, torque, yaw));
    let config = MellingerConfig {
        thrust_factor: number(&state["mass_thrust"]) * 4.0 * actuation.thrust_max_n / number(&state["pwm_max"]),
        position: vector(&state["kp"]),
        velocity: vector(&state["kd"]),
        position_integral: vector(&state["ki"]),
        position_integral_max: vector(&state["int_err_max"]),
        rotation: 2.0 * torques(&attitude["kR"]),
        rates: torques(&attitude["kw"]),
        rotation_integral: 2.0 * torques(&attitude["ki_m"]),
        rotation_integral_max: 0.5 * vector(&attitude["int_err_max"]),
        rates_derivative: torques(&attitude["kd_omega"]),
        torque_max_n_m: torques(&attitude["torque_pwm_max"]),
        ..own
    };
    // All the same as the firmware's but for the damping of height, which is 0.5 there.
    let firmware = MellingerConfig { thrust_factor: config.thrust_factor, velocity: config.velocity, ..own };
    let close = |a: Vector3<f64>, b: Vector3<f64>| (a - b).amax() <= 1e-15 * b.amax();
    assert!(close(config.rotation, firmware.rotation) && close(config.rates, firmware.rates));
    assert!(config.velocity.z == 0.5 && own.velocity.z == 0.4 && config.position == own.position);
    Mellinger::new(config, actuation)
}

#[test]
fn mellinger_is_that_of_drone_controllers() {
    let craft: Value = serde_json::from_str(FIXTURE).unwrap();
    let mut steps = 0;
    for (name, craft) in craft.as_object().unwrap() {
        for flight in craft["flights"].as_array().unwrap() {
            let mut law = law(&craft["parameters"]);
            for row in flight.as_array().unwrap() {
                let row = numbers(row);
                let at = |i: usize| Vector3::new(row[i], row[i + 1], row[i + 2]);
                let attitude = UnitQuaternion::from_quaternion(Quaternion::new(row[3], row[4], row[5], row[6]));
                let zero = Vector3::zeros();
                let input = Input {
                    time_s: 0.0,
                    estimate: Estimate {
                        position_m: at(0),
                        velocity_m_s: at(7),
                        attitude,
                        body_rates_rad_s: at(10),
                        specific_force_m_s2: zero,
                    },
                    setpoint: Setpoint {
                        sent_s: 0.0,
                        position_m: at(13),
                        velocity_m_s: at(16),
                        acceleration_m_s2: at(19),
                        jerk_m_s3: zero,
                        snap_m_s4: zero,
                        crackle_m_s5: zero,
                        heading_rad: row[22],
                        heading_rate_rad_s: 0.0,
                        // The package has no rates to follow.
                        body_rates_rad_s: zero,
                    },
                    battery_v: 4.0,
                };
                let ours = law.force_torque(&input).unwrap();
                // Its way leads through Euler angles and back, and through commands of 16 bits as f64: a few roundings.
                assert!((ours.force_n - row[23]).abs() < 1e-14, "{name}: {} {}", ours.force_n, row[23]);
                assert!((ours.torque_n_m - at(24)).amax() < 1e-15, "{name}: {} {}", ours.torque_n_m, at(24));
                steps += 1;
            }
        }
    }
    assert!(steps > 120, "{steps}");
}
