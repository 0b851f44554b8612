//! A trajectory of polynomial pieces, played by the ticks of a control loop.
//!
//! `cargo run --package quatrack --example follow_trajectory`

use quatrack::gains::paper;
use quatrack::nalgebra::Vector3;
use quatrack::{
    Controller, Equilibrium, FeedForward, Limits, Measured, Memory, Piece, Player, Rate, Target, Trajectory,
};

/// Half a metre up in two seconds, rest to rest: `0.5 (35 s^4 - 84 s^5 + 70 s^6 - 20 s^7)` with `s = t / 2 s`. Ascending
/// powers of the piece's own time.
static CLIMB: [Piece; 1] = [Piece {
    duration_ns: 2_000_000_000,
    x: [0.0; 8],
    y: [0.0; 8],
    z: [0.0, 0.0, 0.0, 0.0, 1.09375, -1.3125, 0.546875, -0.078125],
    heading: [0.0; 8],
}];

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let limits = Limits::new(1.8, 16.5, Vector3::new(20.0, 20.0, 10.0))?;
    let law = Equilibrium { feed_forward: FeedForward::With, ..Equilibrium::new(&paper::LQR_E) };
    let controller = Controller::new(law, limits);
    let mut memory = Memory::at_rest();

    // The check of the pieces is done once, here; the player then takes them without looking.
    let mut player = Player::new(Trajectory::new(&CLIMB)?, Rate::from_hz(500).ok_or("no rate")?);
    for tick in (0..=player.end_tick()).step_by(100) {
        let reference = player.reference(tick)?;
        // A craft that is where it should be: the command is the reference's own input.
        let output = controller.step(&mut memory, Measured::new(reference.state()), Target::new(&reference))?;
        let thrust_m_s2 = output.command().ok_or("this law gives thrust and body rates")?.command.thrust_m_s2;
        let height_m = reference.state().position_m.z;
        println!("tick {tick:4}  height {height_m:.3} m  thrust {thrust_m_s2:5.2} m/s^2");
    }
    Ok(())
}
