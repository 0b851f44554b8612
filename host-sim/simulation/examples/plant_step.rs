//! Steps of a plant, for counting: the cost of a step is the difference of two lengths over the difference in steps.
//!
//! ```text
//! cargo build --release --package quatrack-simulation --example plant_step
//! for steps in 1000 2000; do
//!   valgrind --tool=callgrind --callgrind-out-file=/dev/null target/release/examples/plant_step $steps air
//! done
//! ```
//!
//! The second word is `vacuum`, `air` (drag, moment, lift, wind), `turbulence` (that with Dryden's) or `flown` (that with all
//! that is known of the vehicle).

use nalgebra::{Vector3, Vector4};
use quatrack_simulation::plant::{Air, Dryden, Environment, Plant, RigidState, Truth, Wind};
use quatrack_simulation::vehicles;

const STEP_S: f64 = 0.002;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words = std::env::args().skip(1);
    let steps: u32 = words.next().ok_or("how many steps?")?.parse()?;
    let surroundings = words.next().unwrap_or_default();
    let vehicle = vehicles::by_name("crazyflie-2.1-brushless")?;
    let (mut environment, mut truth) = (Environment::VACUUM, Truth::as_designed(&vehicle));
    if surroundings != "vacuum" {
        environment.air = Air::of(&vehicle).ok_or("its air is known")?;
        environment.wind = Wind::constant(Vector3::new(1.0, 0.0, 0.0));
    }
    if surroundings == "turbulence" || surroundings == "flown" {
        environment.wind.turbulence = Some(Dryden::at_low_altitude(Vector3::repeat(0.5), 1.0, 1.0));
    }
    if surroundings == "flown" {
        truth = Truth::as_flown(&vehicle);
    }
    let hover_n = vehicle.hover_thrust_n();
    let start = RigidState { velocity_m_s: Vector3::new(1.0, 0.5, 0.0), ..RigidState::at_rest(Vector3::z(), hover_n) };
    let mut plant = Plant::new(&vehicle, &environment, &truth, &start, 1)?;
    for step in 0..steps {
        let more_n = if step % 2 == 0 { 1e-3 } else { -1e-3 };
        plant.advance(&Vector4::repeat(hover_n + more_n), STEP_S);
    }
    println!("after {:.3} s at {}", plant.time_s(), plant.state().position_m.transpose());
    Ok(())
}
