//! The built-in actuator-aware table is the design's, for the craft that the core flies it with.

use quatrack::Airframe;
use quatrack::gains::actuator_aware;
use quatrack_sim::design::motor_tables::rounded_gain;
use quatrack_sim::vehicle::Vehicle;

#[test]
fn the_table_in_the_core_is_the_design() {
    let designed = rounded_gain(&Vehicle::by_name("crazyflie-2.1").unwrap()).unwrap();
    let table = actuator_aware::CRAZYFLIE_2_1.gain().rows();
    let largest = designed.iter().flatten().fold(0.0_f32, |most, entry| most.max(entry.abs()));
    for (row, (stored, designed)) in table.iter().zip(&designed).enumerate() {
        for (column, (stored, designed)) in stored.iter().zip(designed).enumerate() {
            // The last digits of a solver differ between machines.
            assert!((stored - designed).abs() <= 1e-6 * largest, "({row}, {column}): {stored} {designed}");
        }
    }
    assert!(actuator_aware::CRAZYFLIE_2_1.is_decoupled(), "a quarter of the products");
}

#[test]
fn the_cores_craft_is_the_vehicle_of_the_design() {
    let (core, vehicle) = (Airframe::CRAZYFLIE_2_1, Vehicle::by_name("crazyflie-2.1").unwrap());
    let (figures, motors) = (core.figures(), vehicle.motors());
    let inertia = vehicle.inertia_kg_m2().diagonal();
    let pairs = [
        (figures.mass_kg, vehicle.mass_kg()),
        (figures.inertia_kg_m2[0], inertia.x),
        (figures.inertia_kg_m2[1], inertia.y),
        (figures.inertia_kg_m2[2], inertia.z),
        (figures.lever_arm_m, motors.half_arm_m()),
        (figures.torque_per_thrust_m, motors.torque_per_thrust_m),
        (figures.force_min_n, motors.thrust_min_n),
        (figures.force_max_n, motors.thrust_max_n),
        (figures.motor_lag_s, motors.lag_s),
    ];
    for (core, vehicle) in pairs {
        // The core's figures are written with four digits or more; the lever arm is 0.046 m over the root of two, 0.0325.
        assert!((f64::from(core) / vehicle - 1.0).abs() < 1e-3, "{core} {vehicle}");
    }
}
