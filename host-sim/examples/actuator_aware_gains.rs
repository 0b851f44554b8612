//! Prints the source of the core's actuator-aware table:
//! `cargo run --example actuator_aware_gains > core/src/gains/actuator_aware.rs`, then `cargo fmt`.

use quatrack_sim::design::motor_tables::actuator_aware_tables;
use quatrack_sim::vehicle::Vehicle;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    print!("{}", actuator_aware_tables(&Vehicle::by_name("crazyflie-2.1")?)?);
    Ok(())
}
