//! The core's constants and the host's vehicle files are the same craft.

use quatrack::{Airframe, AirframeFigures};
use quatrack_simulation::vehicles;

use super::CRAFT;

#[test]
fn constants_are_the_vehicle_files() {
    for (name, airframe) in CRAFT {
        let vehicle = vehicles::by_name(name).unwrap();
        let motors = vehicle.motors();
        let expected = AirframeFigures {
            mass_kg: vehicle.mass_kg() as f32,
            inertia_kg_m2: [0, 1, 2].map(|axis| vehicle.inertia_kg_m2()[(axis, axis)] as f32),
            lever_arm_m: motors.half_arm_m() as f32,
            torque_per_thrust_m: motors.torque_per_thrust_m as f32,
            force_min_n: motors.thrust_min_n as f32,
            force_max_n: motors.thrust_max_n as f32,
            motor_lag_s: motors.lag_s as f32,
        };
        assert_eq!(*airframe.figures(), expected, "{name}");
        assert!((f64::from(airframe.hover_force_n()) - vehicle.hover_thrust_n()).abs() < 1e-8, "{name}");
    }
}

#[test]
fn wrench_is_the_hosts_mixing() {
    for (name, airframe) in CRAFT {
        let mixing = vehicles::by_name(name).unwrap().motors().mixing();
        for motor in 0..4 {
            let mut forces = [0.0; 4];
            forces[motor] = 0.1_f32;
            let wrench = airframe.wrench(&forces);
            let [x, y, z] = [wrench.torque_n_m.x, wrench.torque_n_m.y, wrench.torque_n_m.z].map(f64::from);
            for (row, found) in [f64::from(wrench.thrust_n), x, y, z].into_iter().enumerate() {
                // One product, of figures rounded to f32.
                assert!((found - 0.1 * mixing[(row, motor)]).abs() < 1e-8, "{name}: row {row}, motor {motor}");
            }
        }
    }
    let faster = Airframe::CRAZYFLIE_2_1.with_motor_lag(0.0635).unwrap();
    assert_eq!(faster.figures().motor_lag_s, 0.0635);
}
