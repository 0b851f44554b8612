//! The inputs that make a step cost most, computed on the host beside the target: a recorded state in; every command out.
//!
//! The reference turns, errors are in its heading frame, the reference's input is left out and fed forward, the limits are
//! off, below and above the command, and the measured quaternion changes its sign every step.

use quatrack::law::EquilibriumGain;
use quatrack::link::{LawChoice, LimitsSetting};
use quatrack::{
    Command, Controller as CoreController, Equilibrium, FeedForward, Law, Limits, Measured, Memory, Piece, Player,
    Quaternion, Rate, Reference, State, Target, Trajectory, gains::paper,
};
use quatrack_plan::plan::paper::PaperTrajectory;
use quatrack_plan::plan::stored;
use quatrack_simulation::reproduction::table::Controller;

use super::PilError;
use super::bits::words;
use super::flights::{RATE_HZ, table};

/// The name of a gain without a zero.
pub(super) const ANY_TABLE: &str = "any E table";

/// Calls of the law for each step.
pub(super) const CALLS: u64 = LIMITS.len() as u64 * FEED_FORWARD.len() as u64;

const FEED_FORWARD: [FeedForward; 2] = [FeedForward::Without, FeedForward::With];

/// Off as in the reproduction of the paper; below and above every command of the flights, so that all four parts are cut.
const LIMITS: [LimitsSetting; 3] = [
    LimitsSetting { thrust_min_m_s2: f32::MIN, thrust_max_m_s2: f32::MAX, body_rates_max_rad_s: [f32::MAX; 3] },
    LimitsSetting { thrust_min_m_s2: 0.0, thrust_max_m_s2: 1e-3, body_rates_max_rad_s: [f32::MIN_POSITIVE; 3] },
    LimitsSetting { thrust_min_m_s2: 1e3, thrust_max_m_s2: 2e3, body_rates_max_rad_s: [f32::MIN_POSITIVE; 3] },
];

/// Heading at the start of a turning course and its rate, rad and rad/s.
const TURN: [f32; 2] = [0.3, 0.5];

/// LQR-E with a tenth in the place of each zero.
fn dense() -> [[f32; 9]; 4] {
    paper::LQR_E.gain().rows().map(|row| row.map(|entry| if entry == 0.0 { 0.1 } else { entry }))
}

/// The target's settings before the flights: the dense gain and the limits.
pub(super) fn head() -> Vec<u8> {
    let limits = LIMITS.iter().flat_map(|limits| {
        let [p, q, r] = limits.body_rates_max_rad_s;
        [limits.thrust_min_m_s2, limits.thrust_max_m_s2, p, q, r]
    });
    dense().into_iter().flatten().chain(limits).flat_map(f32::to_le_bytes).collect()
}

/// The answers expected of the target.
pub(super) struct Expected {
    /// Hash of all commands of the law.
    pub(super) hash: u32,
    /// Of the tick, which is on the trajectory that does not turn.
    pub(super) command: Option<Command>,
}

/// The core on the host.
pub(super) struct Host {
    controller: Option<Controller>,
    dense: EquilibriumGain,
    limits: [Limits; LIMITS.len()],
    stored: Player<'static>,
    turning: Vec<Piece>,
    rate: Rate,
}

impl Host {
    /// At the start of a course, with a controller of the paper's or the dense gain.
    pub(super) fn new(course: PaperTrajectory, controller: Option<Controller>) -> Result<Self, PilError> {
        let refused = |part: &str| PilError::Answer(format!("the core refuses {part}"));
        let rate = Rate::from_hz(RATE_HZ).ok_or_else(|| refused("the rate"))?;
        let pieces = stored::pieces(course);
        let stored = Trajectory::new(pieces).map_err(|_| refused("the stored trajectory"))?;
        let dense = EquilibriumGain::new(dense()).map_err(|_| refused("the dense gain"))?;
        let [off, below, above] = LIMITS.map(|limits| limits.check().map_err(|_| refused("the limits")));
        let limits = [off?, below?, above?];
        Ok(Self { controller, dense, limits, stored: Player::new(stored, rate), turning: turn(pieces, TURN), rate })
    }

    /// Every command of a step.
    pub(super) fn step(&mut self, step: u32, recorded: &State) -> Result<Expected, PilError> {
        self.commands(step, recorded).ok_or_else(|| PilError::Answer(format!("the core has no command at step {step}")))
    }

    fn commands(&mut self, step: u32, recorded: &State) -> Option<Expected> {
        let sign = |q: Quaternion| if step.is_multiple_of(2) { q } else { -q };
        let reference = Player::new(Trajectory::new(&self.turning).ok()?, self.rate).reference(step).ok()?;
        let state = State { attitude: sign(recorded.attitude * reference.heading().quaternion()), ..*recorded };
        let mut hash = HASH;
        for limits in self.limits {
            for feed_forward in FEED_FORWARD {
                let command = command(self.law(feed_forward)?, limits, &state, &reference)?;
                hash = hashed(hash, words(&command));
            }
        }
        let command = match self.controller {
            Some(_) => {
                let [.., last] = self.limits;
                let state = State { attitude: sign(recorded.attitude), ..*recorded };
                let reference = self.stored.reference(step).ok()?;
                Some(command(self.law(FeedForward::With)?, last, &state, &reference)?)
            }
            None => None,
        };
        Some(Expected { hash, command })
    }

    fn law(&self, feed_forward: FeedForward) -> Option<Law<'_>> {
        match self.controller {
            Some(controller) => LawChoice { feed_forward, ..LawChoice::new(table(controller)) }.built_in(),
            None => Some(Equilibrium { feed_forward, ..Equilibrium::new(&self.dense) }.into()),
        }
    }
}

/// The command of a law that remembers nothing.
fn command(law: Law<'_>, limits: Limits, state: &State, reference: &Reference) -> Option<Command> {
    let controller = CoreController::new(law, limits);
    let output = controller.step(&mut Memory::at_rest(), Measured::new(state), Target::new(reference)).ok()?;
    output.command().map(|step| step.command)
}

/// The hash of nothing.
const HASH: u32 = 0x811c_9dc5;

/// A hash carried on.
fn hashed<const N: usize>(hash: u32, words: [u32; N]) -> u32 {
    words.iter().fold(hash, |hash, word| (hash ^ word).wrapping_mul(0x0100_0193))
}

/// The same pieces with a heading that grows all the while, from a start at a rate, by the very operations of the target.
fn turn(pieces: &[Piece], [mut heading, rate]: [f32; 2]) -> Vec<Piece> {
    let turned = pieces.iter().map(|piece| {
        let start = heading;
        heading += rate * (piece.duration_ns as f32 * 1e-9);
        Piece { heading: [start, rate, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], ..*piece }
    });
    turned.collect()
}
