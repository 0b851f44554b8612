//! A flight that ends at its commands, for an image without the feature `motors`: what the paper's laws take by themselves
//! is weighed and counted with it.

use quatrack::link::{FromBoard, NoCommand};
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::Mode;
use quatrack::{MotorForces, State, Step, Tick};

use crate::craft::BodyRates;
use crate::drivers::battery::CellVoltage;
use crate::motor_control::STOPPED;
use crate::playback::Playback;

/// Nothing.
pub struct ToMotors;

/// What a step is taken on.
#[expect(dead_code, reason = "nothing is done with it")]
pub(super) struct StepInput<'a> {
    pub(super) now: Tick,
    pub(super) state_tick: Tick,
    pub(super) reference_tick: Tick,
    pub(super) mode: Mode,
    pub(super) rates: BodyRates,
    pub(super) state: Option<&'a State>,
    pub(super) command: &'a Result<Step, NoCommand>,
}

#[expect(clippy::unused_self, reason = "the same to call as with motors")]
impl ToMotors {
    pub(super) const fn new() -> Self {
        Self
    }

    /// Nobody asks.
    pub const fn battery(&self) -> CellVoltage {
        CellVoltage::NOMINAL
    }

    /// None.
    pub const fn forces_n(&self) -> &MotorForces {
        &STOPPED
    }

    pub(super) fn go_straight(&mut self, _is_its_rate: bool) -> bool {
        false
    }

    pub(super) fn follow_commands(&mut self) {}

    #[inline(always)]
    pub(super) const fn is_straight(&self) -> bool {
        false
    }

    #[inline(always)]
    pub(super) fn accept(&mut self, _body_rates_rad_s: Option<Vector3<f32>>) {}

    pub(super) fn begin(&mut self) {}

    #[inline(always)]
    pub(super) fn step(&mut self, _input: &StepInput<'_>, _playback: &mut Playback) {}

    #[inline(always)]
    pub(super) fn refusal<'a>(&'a self, command: &'a Result<Step, NoCommand>) -> Option<&'a NoCommand> {
        command.as_ref().err()
    }

    pub(super) fn pass(&mut self) {}

    pub(super) fn stop(&mut self) {}

    pub(super) fn withdraw(&mut self, _mode: Mode) {}

    pub(super) fn message(&self) -> Option<FromBoard> {
        None
    }
}
