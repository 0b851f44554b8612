//! A flight that ends at its commands, for an image without the feature `motors`: that image measures the size and the
//! instructions of the paper's laws alone.

use quatrack::link::NoCommand;
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::Looked;
use quatrack::{Leash, Measured, MotorForces, Output, Target, Tick};

use crate::craft::BodyRates;
use crate::drivers::battery::CellVoltage;
use crate::laws::Laws;
use crate::playback::Playback;
use crate::vehicle::STOPPED;

/// Nothing.
pub struct ToMotors;

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

    #[inline(always)]
    pub(super) fn accept(&mut self, _body_rates_rad_s: Option<Vector3<f32>>) {}

    #[inline(always)]
    pub(super) fn look_at(&mut self, _rates: BodyRates) {}

    #[inline(always)]
    pub(super) fn body_rates(&self, _rates: BodyRates, _is_fresh: bool) -> Option<Vector3<f32>> {
        None
    }

    #[inline(always)]
    pub(super) const fn are_driven(&self) -> bool {
        false
    }

    #[inline(always)]
    pub(super) const fn can_level(&self) -> bool {
        false
    }

    /// A step down to its command.
    #[inline(always)]
    pub(super) fn step(
        &mut self,
        laws: &mut Laws,
        playback: &mut Playback,
        leash: &Leash,
        tick: Tick,
        looked: &Looked<'_>,
        _has_body_rates: bool,
    ) -> Result<Output, NoCommand> {
        // Looked at where it lies: to move a reference out costs as many instructions as the product with a gain.
        match &mut playback.reference(tick) {
            Ok(reference) => {
                leash.hold(reference, looked.state);
                laws.step(Measured::new(looked.state), Target::new(reference)).map_err(NoCommand::Step)
            }
            Err(error) => Err(NoCommand::Reference(*error)),
        }
    }

    pub(super) fn pass(&mut self, _output: &Output) {}

    pub(super) fn stop(&mut self) {}

    #[inline(always)]
    pub(super) const fn answers_by_forces(&self) -> bool {
        false
    }
}
