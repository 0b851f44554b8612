//! A gain table as a file: read, checked, accepted for this vehicle and rate, and flown.
//!
//! `cargo run --package quatrack --example load_table -- gains/generated/sampled-lqr-e.bin`

use quatrack::gains::table::GainTable;
use quatrack::nalgebra::Vector3;
use quatrack::{Actuation, Airframe, FeedForward, Limits, Measured, Memory, Reference, Settings, State, Target};

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let path = std::env::args().nth(1).ok_or("which table? for example gains/generated/sampled-lqr-e.bin")?;
    let bytes = std::fs::read(path)?;
    // The first gate: a sound table with a certificate.
    let table = GainTable::from_bytes(&bytes)?;
    let head = table.head();
    println!("{}: {} for {}, {} Hz", head.name, table.kind(), head.vehicle.name, head.rate.hz());
    println!("stable up to a delay of {:.1} ms", 1e3 * head.certificate.delay_max_s);

    // The second gate: a board says for which vehicle it is and how often it steps. This one takes the table's word.
    let accepted = table.accept_for(&head.vehicle, head.rate)?;
    let airframe = Airframe::CRAZYFLIE_2_1;
    let actuation = accepted.actuation(&Actuation::new(&airframe, head.rate)?);
    // The tighter of the board's limits and the table's hold.
    let limits = Limits::of(&airframe, Vector3::new(20.0, 20.0, 10.0));
    let controller = accepted.controller(&Settings {
        actuation: Some(&actuation),
        feed_forward: FeedForward::With,
        ..Settings::new(limits, head.rate)
    })?;
    let mut memory = Memory::hovering(&airframe);
    let reference = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0)?;
    let (state, rates) = (State::at_rest(Vector3::new(0.0, 0.0, 0.99)), Vector3::new(0.0, 0.0, 0.0));
    let measured = Measured::new(&state).with_body_rates(&rates);
    let step = controller.step_to_motors(&mut memory, measured, Target::new(&reference))?;
    println!("1 cm too low: {:.4?} N", step.forces_n);
    Ok(())
}
