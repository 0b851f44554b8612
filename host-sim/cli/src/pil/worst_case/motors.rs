//! The way to the motors at its worst, computed on the host beside the target: a recorded state in; a hash of all motor
//! references and forces out.
//!
//! The trajectory is of degree 7 and turns so quickly that its heading comes by every quarter; each step has its own reference
//! and one on which a piece begins. The motors hover, and each in turn is far enough from there for its command to be cut, at
//! either end; the measured quaternion changes its sign every step.

use quatrack::law::ActuatorAwareGain;
use quatrack::{
    Actuation, ActuatorAware, Airframe, Controller, Limits, Memory, MotorReference, Output, Piece, Player, Rate,
    RigidState, State, Target, Trajectory,
};
use quatrack_plan::plan::paper::PaperTrajectory;
use quatrack_plan::plan::stored;

use super::{HASH, hashed, turn};
use crate::pil::PilError;
use crate::pil::flights::RATE_HZ;

/// The same file that the image is built from.
#[allow(unreachable_pub, reason = "the image needs it public")]
mod table {
    include!("../../../../../gains/generated/actuator-aware.rs");
}

/// The name of a gain that does not decouple.
pub(in crate::pil) const ANY_TABLE: &str = "any actuator-aware table";

/// Calls of either law for each step, and of the reference at its worst.
pub(in crate::pil) const CALLS: [u64; 2] = [18, 2];

/// Heading at the start and its rate, rad and rad/s.
const TURN: [f32; 2] = [0.3, 12.0];

/// Of the sixth and seventh power: next to nothing, but there.
const HIGHEST: f32 = 1e-12;

/// Distance of a motor from hover, N.
const APART_N: f32 = 0.05;

/// The gain in the repository with one entry that keeps it from falling apart.
pub(super) fn dense() -> [[f32; 19]; 4] {
    let mut rows = *table::ACTUATOR_AWARE.gain().rows();
    let [[entry, ..], ..] = &mut rows;
    *entry += 0.01;
    rows
}

/// The core on the host.
pub(in crate::pil) struct Motors {
    dense: ActuatorAwareGain,
    actuation: Actuation,
    rate: Rate,
    stored: Player<'static>,
    worst: Vec<Piece>,
    memories: [Memory; 9],
}

impl Motors {
    /// On a course.
    pub(in crate::pil) fn new(course: PaperTrajectory) -> Result<Self, PilError> {
        Self::of(course).ok_or_else(|| PilError::Answer("the core refuses the way to the motors".to_owned()))
    }

    fn of(course: PaperTrajectory) -> Option<Self> {
        let rate = Rate::from_hz(RATE_HZ)?;
        let pieces = stored::pieces(course);
        let actuation = Actuation::new(&Airframe::CRAZYFLIE_2_1.commanded_at(rate), rate).ok()?;
        let hover = Memory::hovering(actuation.airframe());
        let mut memories = [hover; 9];
        for (index, memory) in memories.iter_mut().skip(1).enumerate() {
            let mut forces_n = hover.forces_n();
            *forces_n.get_mut(index / 2)? += if index % 2 == 0 { APART_N } else { -APART_N };
            *memory = Memory::new(forces_n)?;
        }
        Some(Self {
            dense: ActuatorAwareGain::new(dense()).ok()?,
            actuation,
            rate,
            stored: Player::new(Trajectory::new(pieces).ok()?, rate),
            worst: turn(&septic(pieces), TURN),
            memories,
        })
    }

    /// The hash of a step.
    pub(in crate::pil) fn step(&mut self, step: u32, recorded: &State) -> Result<u32, PilError> {
        self.hash(step, recorded).ok_or_else(|| PilError::Answer(format!("the core has no forces at step {step}")))
    }

    fn hash(&mut self, step: u32, recorded: &State) -> Option<u32> {
        let airframe = self.actuation.airframe();
        let controller = |gain| Controller::new(ActuatorAware::new(gain, &self.actuation), Limits::NONE);
        let controllers = [controller(&table::ACTUATOR_AWARE), controller(&self.dense)];
        let next = self.worst.first()?.duration_ns.div_ceil(1_000_000_000 / u64::from(RATE_HZ)) as u32;
        let mut worst = Player::new(Trajectory::new(&self.worst).ok()?, self.rate);
        let mut hash = of_reference(HASH, &self.stored.motor_reference(step, airframe).ok()?);
        for step in [next, step] {
            let reference = worst.motor_reference(step, airframe).ok()?;
            hash = of_reference(hash, &reference);
            let turned = recorded.attitude * reference.reference().heading().quaternion();
            let attitude = if step.is_multiple_of(2) { turned } else { -turned };
            let state = State { attitude, ..*recorded };
            let state = RigidState { state, body_rates_rad_s: reference.body_rates_rad_s() };
            for controller in &controllers {
                for mut memory in self.memories {
                    let target = Target::with_forces(&reference);
                    let Output::Forces(step) = controller.step(&mut memory, (&state).into(), target).ok()? else {
                        return None;
                    };
                    hash = hashed(hash, step.forces_n.map(f32::to_bits));
                    hash = hashed(hash, memory.forces_n().map(f32::to_bits));
                    hash = hashed(hash, [u32::from(step.limited.bits())]);
                }
            }
        }
        Some(hash)
    }
}

/// The pieces with degree 7.
fn septic(pieces: &[Piece]) -> Vec<Piece> {
    let raised = |[c0, c1, c2, c3, c4, c5, ..]: [f32; 8]| [c0, c1, c2, c3, c4, c5, HIGHEST, HIGHEST];
    pieces.iter().map(|piece| Piece { x: raised(piece.x), y: raised(piece.y), z: raised(piece.z), ..*piece }).collect()
}

fn of_reference(hash: u32, reference: &MotorReference) -> u32 {
    hashed(hashed(hash, reference.forces_n().map(f32::to_bits)), reference.commands_n().map(f32::to_bits))
}
