//! A craft that is pushed out of its hover and brought back: the smallest loop around the controller.
//!
//! `cargo run --package quatrack --example hover`

use quatrack::gains::paper;
use quatrack::nalgebra::Vector3;
use quatrack::{Controller, Equilibrium, Limits, Measured, Memory, Output, Reference, State, Target};

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let limits = Limits::new(1.8, 16.5, Vector3::new(20.0, 20.0, 10.0))?;
    let controller = Controller::new(Equilibrium::new(&paper::LYAP_E), limits);
    let mut memory = Memory::at_rest();
    let reference = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0)?;

    // Half a metre too low. From here on the vertical part of the paper's model alone: z'' = T - g.
    let (mut height_m, mut speed_m_s, period_s) = (0.5_f32, 0.0_f32, 0.002);
    for step in 0..=1500 {
        let velocity_m_s = Vector3::new(0.0, 0.0, speed_m_s);
        let state = State { velocity_m_s, ..State::at_rest(Vector3::new(0.0, 0.0, height_m)) };
        // An error means: no command. Stop or level; never hold the last one.
        let output = controller.step(&mut memory, Measured::new(&state), Target::new(&reference))?;
        let Output::Command(taken) = output else { return Err("this law gives thrust and body rates".into()) };
        if step % 250 == 0 {
            let thrust_m_s2 = taken.command.thrust_m_s2;
            println!("{:4.1} s  height {height_m:.3} m  thrust {thrust_m_s2:5.2} m/s^2", f64::from(step) * 0.002);
        }
        speed_m_s += (taken.command.thrust_m_s2 - 9.81) * period_s;
        height_m += speed_m_s * period_s;
    }
    Ok(())
}
