//! The control path: every law of the core over a stored piece, one step a tick.

use core::hint::black_box;

use quatrack::gains::paper;
use quatrack::nalgebra::Vector3;
use quatrack::{Command, Equilibrium, FlatOutput, Limits, Piece, Player, Rate, State, Tracker, Trajectory};

/// Rest to rest, half a metre up in two seconds: `z = 0.5 (35 s^4 - 84 s^5 + 70 s^6 - 20 s^7)` with `s = t / 2 s`.
static CLIMB: [Piece; 1] = [Piece {
    duration_ns: 2_000_000_000,
    x: [0.0; 8],
    y: [0.0; 8],
    z: [0.0, 0.0, 0.0, 0.0, 1.093_75, -1.3125, 0.546_875, -0.078_125],
    heading: [0.0; 8],
}];

/// Control steps a second.
const RATE_HZ: u32 = 500;

/// Crazyflie 2.1: four motors of 0.12 N at 0.029 kg; the rates are the paper's controllers' own choice.
const THRUST_MAX_M_S2: f32 = 16.55;
const BODY_RATE_MAX_RAD_S: f32 = 20.0;

/// Steps for ever; what is commanded is only kept from being optimised away.
pub(crate) fn run() -> ! {
    loop {
        black_box(climb(black_box(&State::at_rest(Vector3::new(0.0, 0.0, 0.0)))));
    }
}

/// The last command of the climb, or none at the first step that gives none.
fn climb(state: &State) -> Command {
    let rates = Vector3::new(BODY_RATE_MAX_RAD_S, BODY_RATE_MAX_RAD_S, BODY_RATE_MAX_RAD_S);
    let (Ok(limits), Some(rate), Ok(trajectory)) =
        (Limits::new(0.0, THRUST_MAX_M_S2, rates), Rate::from_hz(RATE_HZ), Trajectory::new(black_box(&CLIMB)))
    else {
        return Command::ZERO;
    };
    let trackers = [
        Tracker::new(Equilibrium::new(&paper::LQR_E), limits),
        Tracker::new(Equilibrium::new(&paper::LYAP_E), limits),
        Tracker::new(FlatOutput::new(&paper::LQR_F), limits),
        Tracker::new(FlatOutput::new(&paper::LYAP_F), limits),
    ];
    let mut player = Player::new(trajectory, rate);
    let mut command = Command::ZERO;
    for tick in 0..player.end_tick() {
        let Ok(reference) = player.reference(tick) else { return Command::ZERO };
        for tracker in &trackers {
            let Ok(step) = tracker.step(black_box(state), &reference) else { return Command::ZERO };
            command = black_box(step.command);
        }
    }
    command
}
