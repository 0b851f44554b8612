//! The way to the motors: the reference carried on to motor forces, and the actuator-aware law, by the gain in the
//! repository and by a dense one.
//!
//! A trajectory of degree 7 that turns, so quickly that its heading comes by every quarter; each step's reference, and one on
//! which a piece begins. The law at the recorded states, seen from that reference, with motors that hover, and with each in
//! turn far enough from there for its command to be cut, at either end; the measured quaternion of either sign.

use core::hint::black_box;

use quatrack::law::ActuatorAwareGain;
use quatrack::{
    Actuation, ActuatorAware, Airframe, Controller, Limits, Memory, MotorReference, Output, Piece, Player, Rate,
    ReferenceError, RigidState, State, StepError, Target, Tick, Trajectory,
};
use quatrack_firmware::flight::{DECIMATION as TICKS_PER_STEP, TICK_RATE};

use crate::image::{Bench, Calls, hashed, write_words};

#[allow(unreachable_pub, reason = "the generated file as it is in the repository")]
mod table {
    include!("../../../../gains/generated/actuator-aware.rs");
}

/// Heading at the start and its rate, rad and rad/s.
pub(crate) const TURN: [f32; 2] = [0.3, 12.0];

/// Of the sixth and seventh power: next to nothing, but there.
const HIGHEST: f32 = 1e-12;

/// Distance of a motor from hover, N.
const APART_N: f32 = 0.05;

/// The steps that are counted on a course.
pub(crate) struct Motors<'a> {
    designed: Controller<'a>,
    dense: Controller<'a>,
    airframe: Airframe,
    stored: Player<'static>,
    worst: Player<'static>,
    /// At the end of the first piece, and the step on which the next one begins.
    crossing: (Player<'static>, u32),
    memories: [Memory; 9],
}

/// Makes pieces of degree 7.
pub(crate) fn septic(pieces: &mut [Piece]) {
    for axis in pieces.iter_mut().flat_map(|piece| [&mut piece.x, &mut piece.y, &mut piece.z]) {
        let [.., c6, c7] = axis;
        (*c6, *c7) = (HIGHEST, HIGHEST);
    }
}

impl<'a> Motors<'a> {
    pub(crate) fn new(
        dense: &'a ActuatorAwareGain,
        actuation: &'a Actuation,
        stored: &'static [Piece],
        worst: &'static [Piece],
    ) -> Option<Self> {
        let rate = Rate::from_hz(TICK_RATE.hz() / TICKS_PER_STEP)?;
        let airframe = *actuation.airframe();
        let controller =
            |gain: &'a ActuatorAwareGain| Controller::new(ActuatorAware::new(gain, actuation), Limits::NONE);
        let next = (worst.first()?.duration_ns.div_ceil(1_000_000_000 / u64::from(rate.hz()))) as u32;
        let worst = Player::new(Trajectory::new(worst).ok()?, TICK_RATE);
        let mut before = worst;
        before.motor_reference((next - 1) * TICKS_PER_STEP, &airframe).ok()?;
        let hover = Memory::hovering(&airframe);
        let mut memories = [hover; 9];
        for (index, memory) in memories.iter_mut().skip(1).enumerate() {
            let mut forces_n = hover.forces_n();
            *forces_n.get_mut(index / 2)? += if index % 2 == 0 { APART_N } else { -APART_N };
            *memory = Memory::new(forces_n)?;
        }
        Some(Self {
            designed: controller(&table::ACTUATOR_AWARE),
            dense: controller(dense),
            airframe,
            stored: Player::new(Trajectory::new(stored).ok()?, TICK_RATE),
            worst,
            crossing: (before, next),
            memories,
        })
    }

    /// One recorded state.
    pub(crate) fn step(&mut self, bench: &mut Bench, step: u32) -> Option<()> {
        let recorded = bench.read_state()?;
        let mut hash = Calls::NONE.hash;
        let mut calls = [Calls::NONE; 3];
        let [references, designed, dense] = &mut calls;
        let (of_reference, reference) = count_reference(bench, &mut self.stored, step, &self.airframe)?;
        hash = of_motor_reference(hash, &reference);
        let (mut before, next) = self.crossing;
        for (player, step) in [(&mut before, next), (&mut self.worst, step)] {
            let (count, reference) = count_reference(bench, player, step, &self.airframe)?;
            references.add(count);
            hash = of_motor_reference(hash, &reference);
            let turned = recorded.attitude * reference.reference().heading().quaternion();
            let attitude = if step % 2 == 0 { turned } else { -turned };
            let state = State { attitude, ..recorded };
            let state = black_box(RigidState { state, body_rates_rad_s: reference.body_rates_rad_s() });
            for (controller, calls) in [(&self.designed, &mut *designed), (&self.dense, &mut *dense)] {
                for memory in self.memories {
                    let (controller, mut memory) = (black_box(controller), black_box(memory));
                    let start = bench.counter.now();
                    let output = controller.step(&mut memory, (&state).into(), Target::with_forces(&reference));
                    calls.add(bench.since(start));
                    hash = of_step(hash, black_box(output), &memory)?;
                }
            }
        }
        let [[a, b, c], [d, e, f], [g, h, i]] = calls.map(|Calls { least, sum, most, .. }| [least, sum, most]);
        write_words(&mut bench.counts, [of_reference, a, b, c, d, e, f, g, h, i, hash])
    }
}

fn count_reference(
    bench: &Bench,
    player: &mut Player<'_>,
    step: u32,
    airframe: &Airframe,
) -> Option<(u32, MotorReference)> {
    let (tick, airframe) = (black_box(step * TICKS_PER_STEP), black_box(airframe));
    let start = bench.counter.now();
    let reference = motor_reference(player, tick, airframe);
    let count = bench.since(start);
    Some((count, black_box(reference.ok()?)))
}

/// On-board reference: polynomial to the fifth derivative, and the flat map carried on to motor forces and commands.
#[inline(never)]
fn motor_reference(player: &mut Player<'_>, tick: Tick, airframe: &Airframe) -> Result<MotorReference, ReferenceError> {
    player.motor_reference(tick, airframe)
}

fn of_motor_reference(hash: u32, reference: &MotorReference) -> u32 {
    hashed(hashed(hash, reference.forces_n().map(f32::to_bits)), reference.commands_n().map(f32::to_bits))
}

fn of_step(hash: u32, output: Result<Output, StepError>, memory: &Memory) -> Option<u32> {
    let Ok(Output::Forces(step)) = output else { return None };
    let hash = hashed(hash, step.forces_n.map(f32::to_bits));
    Some(hashed(hashed(hash, memory.forces_n().map(f32::to_bits)), [u32::from(step.limited.bits())]))
}
