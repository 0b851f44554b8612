//! From one law to another in flight, without a jump: a handover of a tenth of a second.
//!
//! `cargo run --package quatrack --example swap_in_flight`

use quatrack::gains::paper;
use quatrack::nalgebra::Vector3;
use quatrack::{Controller, Equilibrium, Handover, Limits, Measured, Memory, Reference, State, Target};

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let limits = Limits::new(1.8, 16.5, Vector3::new(20.0, 20.0, 10.0))?;
    let old = Controller::new(Equilibrium::new(&paper::LYAP_E), limits);
    let new = Controller::new(Equilibrium::new(&paper::LQR_E), limits);
    let mut memory = Memory::at_rest();

    // 2 cm too low: 8 and 100 m/s^2 per metre on top of gravity.
    let state = State::at_rest(Vector3::new(0.0, 0.0, 0.98));
    let reference = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0)?;
    let (measured, target) = (Measured::new(&state), Target::new(&reference));

    let mut handover = Handover::begin(50, old.law(), new.law(), &mut memory);
    let mut step = 0;
    while !handover.is_over() {
        // Both laws are stepped; the share of the new one grows by a fiftieth a step.
        let output = handover.step((&old, &new), &mut memory, measured, target)?;
        step += 1;
        if step % 10 == 0 {
            println!("step {step}: {:.3} m/s^2", output.command().ok_or("a command")?.command.thrust_m_s2);
        }
    }
    // From here on the new one alone.
    let output = new.step(&mut memory, measured, target)?;
    println!("after it: {:.3} m/s^2", output.command().ok_or("a command")?.command.thrust_m_s2);
    Ok(())
}
