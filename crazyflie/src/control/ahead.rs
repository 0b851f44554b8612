//! The reference along a stream of setpoints at the next control step, made at the call before it, to keep the step
//! short.

use quatrack::{FifthOrderSample, Heading, Leash, Reference, State};

use crate::heading::HeadingStream;
use crate::stream::Stream;

/// Sample and heading, and the reference made of them for the laws that take one, with the step that they are for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ahead {
    pub(super) sample: FifthOrderSample,
    pub(super) heading: Heading,
    reference: Option<Reference>,
    at_ms: Option<u32>,
}

impl Ahead {
    pub(super) const fn new() -> Self {
        const ORIGIN: quatrack::nalgebra::Vector3<f32> = quatrack::nalgebra::Vector3::new(0.0, 0.0, 0.0);
        Self { sample: FifthOrderSample::at_rest(ORIGIN, 0.0), heading: Heading::ZERO, reference: None, at_ms: None }
    }

    /// Nothing is there any more: setpoint, table or sample have changed.
    #[inline(always)]
    pub(super) fn forget(&mut self) {
        self.at_ms = None;
    }

    /// Whether the sample is that of a step.
    #[inline(always)]
    pub(super) fn is_for(&self, now_ms: u32) -> bool {
        self.at_ms == Some(now_ms)
    }

    /// The reference of a step, where one was made.
    #[inline(always)]
    pub(super) fn reference_for(&self, now_ms: u32) -> Option<&Reference> {
        self.reference.as_ref().filter(|_| self.is_for(now_ms))
    }

    /// Makes the sample of a step on a leash, to its jerk.
    #[inline(always)]
    pub(super) fn sample_on_leash_at(
        &mut self,
        now_ms: u32,
        (stream, headings): (&Stream, &HeadingStream),
        (leash, state): (&Leash, &State),
    ) {
        stream.at(now_ms, false, &mut self.sample);
        self.heading = headings.at(now_ms, &mut self.sample);
        let flat = &mut self.sample.flat;
        leash.draw(&mut flat.position_m, &mut flat.velocity_m_s, state);
        self.at_ms = Some(now_ms);
    }

    /// Makes the reference of the sample; nothing is there where it has none.
    #[inline(always)]
    pub(super) fn refer(&mut self) {
        let flat = &self.sample.flat;
        let is_there = match &mut self.reference {
            Some(reference) => reference.move_to_finite_flat(flat, self.heading).is_ok(),
            None => {
                self.reference = Reference::from_flat_at(flat, self.heading).ok();
                self.reference.is_some()
            }
        };
        if !is_there {
            self.at_ms = None;
        }
    }
}
