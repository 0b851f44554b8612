//! Prints the source of the Crazyflie controller's own tables:
//! `cargo run --example crazyflie_tables > crazyflie/src/builtin/motor_gains.rs`.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    print!("{}", quatrack_simulation::crazyflie::motor_gains()?);
    Ok(())
}
