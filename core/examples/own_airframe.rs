//! A craft of one's own, from its figures down to the forces of its four motors.
//!
//! `cargo run --package quatrack --example own_airframe`

use quatrack::gains::paper;
use quatrack::nalgebra::Vector3;
use quatrack::{
    Actuation, Airframe, AirframeFigures, Controller, Equilibrium, Limits, Measured, Memory, Rate, Reference, State,
    Target,
};

fn main() -> Result<(), Box<dyn core::error::Error>> {
    // A 7 inch craft of 900 g. A figure that cannot be is refused by its name: try an arm in millimetres.
    let airframe = Airframe::new(AirframeFigures {
        mass_kg: 0.9,
        inertia_kg_m2: [4.5e-3, 5.0e-3, 8.0e-3],
        lever_arm_m: 0.11,
        torque_per_thrust_m: 0.016,
        force_min_n: 0.2,
        force_max_n: 8.0,
        motor_lag_s: 0.04,
    })?;
    let limits = Limits::of(&airframe, Vector3::new(8.0, 8.0, 3.0));
    // The body-rate loop behind the motors' lag, and the mixer.
    let actuation = Actuation::new(&airframe, Rate::from_hz(500).ok_or("no rate")?)?;
    let controller = Controller::new(Equilibrium::new(&paper::LYAP_E), limits).with_actuation(&actuation);
    let mut memory = Memory::hovering(&airframe);

    let reference = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0)?;
    let state = State::at_rest(Vector3::new(0.1, 0.0, 1.0));
    let body_rates_rad_s = Vector3::new(0.0, 0.0, 0.0);
    let measured = Measured::new(&state).with_body_rates(&body_rates_rad_s);
    let step = controller.step_to_motors(&mut memory, measured, Target::new(&reference))?;
    // 10 cm too far ahead: it pitches back, with more force in front (M1, M4) than behind (M2, M3).
    let [m1, m2, m3, m4] = step.forces_n;
    println!("front right {m1:.3} N, rear right {m2:.3} N, rear left {m3:.3} N, front left {m4:.3} N");
    println!("cut: {}", step.limited.any());
    Ok(())
}
