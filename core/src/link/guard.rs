//! Which frames are taken, by their tags and numbers: a frame in; taken, with how many were skipped, or rejected out.

use super::counters::Rejected;
use super::seal::{Protection, Seal, TAG_BYTES, Tagging};
use super::window::{Admission, Numbers, Window};

/// A frame as far as its sender counts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame<'b> {
    pub(crate) session: u32,
    pub(crate) sequence: u32,
    pub(crate) opens: bool,
    pub(crate) tagging: Tagging,
    /// The bytes that the tag is of.
    pub(crate) signed: &'b [u8],
    pub(crate) tag: Option<&'b [u8; TAG_BYTES]>,
}

/// The check of frames beside their numbers: of tags, or none on a cable.
#[derive(Clone, Debug)]
pub(crate) struct Guard(Option<Keyed>);

/// The seals of a line with a key.
#[derive(Clone, Debug)]
struct Keyed {
    greeting: Seal,
    protection: Protection,
    /// Of the open session.
    seal: Option<Seal>,
    proposed: Option<Proposed>,
}

/// A session that somebody with the key has asked for, and nobody has used yet.
#[derive(Clone, Debug)]
struct Proposed {
    session: u32,
    hello: u32,
    seal: Seal,
}

impl Guard {
    /// The guard of a cable: no tags.
    pub(crate) const CABLE: Self = Self(None);

    pub(crate) const fn keyed(greeting: Seal, protection: Protection) -> Self {
        Self(Some(Keyed { greeting, protection, seal: None, proposed: None }))
    }

    pub(crate) fn propose(&mut self, session: u32, hello: u32, seal: Seal) {
        if let Some(keyed) = &mut self.0 {
            keyed.proposed = Some(Proposed { session, hello, seal });
        }
    }

    pub(crate) fn open(&mut self, seal: Seal, protection: Protection) {
        if let Some(keyed) = &mut self.0 {
            (keyed.seal, keyed.protection) = (Some(seal), protection);
        }
    }

    pub(crate) fn take(
        &mut self,
        frame: &Frame<'_>,
        window: &mut Window,
        admission: Admission,
    ) -> Result<u32, Rejected> {
        match &mut self.0 {
            None => window.take(frame.numbers(false), frame.opens, admission),
            Some(keyed) => keyed.take(frame, window, admission),
        }
    }
}

impl Frame<'_> {
    const fn numbers(&self, is_tagged: bool) -> Numbers {
        Numbers { session: self.session, sequence: self.sequence, is_tagged }
    }

    fn is_tagged_by(&self, seal: &Seal) -> bool {
        self.tag.is_some_and(|tag| seal.is_of(self.signed, tag))
    }
}

impl Keyed {
    fn take(&mut self, frame: &Frame<'_>, window: &mut Window, admission: Admission) -> Result<u32, Rejected> {
        let Frame { session, sequence, .. } = *frame;
        let unauthentic = Rejected::Unauthentic { session, sequence };
        let foreign = Rejected::ForeignSession { session };
        let is_open = window.session() == Some(session);
        if frame.tagging == Tagging::Greeting {
            if !frame.is_tagged_by(&self.greeting) {
                return Err(unauthentic);
            }
            return match is_open {
                true => window.take(frame.numbers(true), false, admission),
                // It opens nothing yet.
                false => window.admits(session, admission).then_some(0).ok_or(foreign),
            };
        }
        if let Some(proposed) = self.proposed.take_if(|proposed| {
            proposed.session == session && proposed.hello < sequence && frame.is_tagged_by(&proposed.seal)
        }) {
            if !window.admits(session, admission) {
                return Err(foreign);
            }
            window.begin(session, sequence);
            self.seal = Some(proposed.seal);
            return Ok(0);
        }
        let seal = match &self.seal {
            Some(seal) if is_open => seal,
            _ => return Err(if is_open { unauthentic } else { foreign }),
        };
        let is_bare = frame.tag.is_none() && !self.protection.covers(frame.tagging);
        if !(is_bare || frame.is_tagged_by(seal)) {
            return Err(unauthentic);
        }
        window.take(frame.numbers(!is_bare), false, admission)
    }
}
