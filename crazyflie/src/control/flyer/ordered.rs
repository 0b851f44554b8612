//! Flight that is not as asked: the supervisor's order to brake or to level in; the output of a step out.

use quatrack::nalgebra::Vector3;
use quatrack::supervisor::{Levelled, Looked, Soundness};
use quatrack::{FifthOrderSample, Followed, Handover, Heading, Quaternion, State};

use super::Flyer;
use crate::control::law_step::Unflown;
use crate::output::Output;

impl Flyer {
    /// To a standstill, and down, along a sample at a heading.
    #[cold]
    #[inline(never)]
    pub(in crate::control) fn brake(
        &mut self,
        looked: &Looked<'_>,
        sample: &FifthOrderSample,
        heading: Heading,
    ) -> Result<(), Unflown> {
        self.leave();
        self.fly_towards(looked, sample, heading, Followed::ALL)
    }

    /// Level, by attitude alone: the cascade by its own way, the paper's laws at a place where nothing is off.
    #[cold]
    #[inline(never)]
    pub(in crate::control) fn level(&mut self, levelled: &Levelled) {
        self.leave();
        let outcome = &mut self.outcome;
        (outcome.has_stepped, outcome.error_m) = (false, Vector3::new(0.0, 0.0, 0.0));
        let is_flown = match self.table.as_cascade() {
            Some(cascade) => match self.memory.level(cascade, levelled) {
                Some((forces_n, limited)) => {
                    (outcome.output, outcome.limited) = (Output::Forces(forces_n), limited);
                    true
                }
                None => false,
            },
            None => self.level_at_rest(levelled).is_ok(),
        };
        if !is_flown {
            self.switch_off();
        }
    }

    #[inline(never)]
    fn level_at_rest(&mut self, levelled: &Levelled) -> Result<(), Unflown> {
        let place = Vector3::new(0.0, 0.0, 0.0);
        let state = State { attitude: levelled.attitude, ..State::at_rest(place) };
        let looked = Looked {
            soundness: Soundness::AttitudeOnly,
            state: &state,
            body_rates_rad_s: &levelled.body_rates_rad_s,
            velocity_bridged_ticks: None,
        };
        let mut sample = FifthOrderSample::at_rest(place, 0.0);
        sample.flat.acceleration_m_s2 = levelled.acceleration_m_s2;
        let Quaternion { w, z, .. } = levelled.attitude;
        let heading = if w * w + z * z > 1e-6 { Heading::from_half(w, z) } else { Heading::ZERO };
        self.fly_towards(&looked, &sample, heading, Followed::ALL)
    }

    /// Forgets the state that a flight as asked would go on from.
    fn leave(&mut self) {
        self.handover = Handover::OVER;
        self.ahead.forget();
        self.shaping.begin();
        if self.table.gives_forces() && matches!(self.outcome.output, Output::Wrench(_)) {
            self.take_motors_over();
        }
    }
}
