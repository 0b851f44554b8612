//! The session and sequence rule: a frame's numbers in; taken, with how many were skipped, or rejected out.

use super::counters::Rejected;

/// Which hellos open another session than the one that is open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Admission {
    /// Those with a later number: late and replayed ones are none.
    #[default]
    Later,
    /// None: a craft in flight keeps its host.
    Nobody,
    /// All of them, with any number: the host has fallen silent, and may come back with a clock of another time.
    Anybody,
}

/// The numbers of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Numbers {
    pub(crate) session: u32,
    pub(crate) sequence: u32,
    /// Whether a tag says whose they are.
    pub(crate) is_tagged: bool,
}

/// The open session of a receiver, if any.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Window {
    session: Option<u32>,
    /// The lowest sequence number that is still taken, without a tag and with one; none when the last number has been used. A frame
    /// with a tag makes those without late, but not the other way about.
    next: [Option<u32>; 2],
}

impl Window {
    pub(crate) const fn closed() -> Self {
        Self { session: None, next: [Some(0); 2] }
    }

    pub(crate) const fn open(session: u32) -> Self {
        Self { session: Some(session), next: [Some(0); 2] }
    }

    pub(crate) const fn session(&self) -> Option<u32> {
        self.session
    }

    /// Takes a frame, which `opens` a session or not, and says how many sequence numbers before it were skipped.
    pub(crate) fn take(&mut self, numbers: Numbers, opens: bool, admission: Admission) -> Result<u32, Rejected> {
        let Numbers { session, sequence, is_tagged } = numbers;
        if self.session != Some(session) {
            if !(opens && self.admits(session, admission)) {
                return Err(Rejected::ForeignSession { session });
            }
            self.begin(session, sequence);
            return Ok(0);
        }
        let [bare, tagged] = self.next;
        let next = if is_tagged { tagged } else { bare };
        let late = || match next.map_or(u32::MAX, |next| next.wrapping_sub(1)) == sequence {
            true => Rejected::Duplicate { sequence },
            false => Rejected::Stale { sequence },
        };
        let skipped = next.and_then(|next| sequence.checked_sub(next)).ok_or_else(late)?;
        let after = sequence.checked_add(1);
        // The later of both: none is after all.
        let later = |next: Option<u32>| next.zip(after).map(|(next, after)| next.max(after));
        self.next = if is_tagged { [later(bare), after] } else { [after, tagged] };
        Ok(if is_tagged { bare.map_or(0, |bare| skipped.min(sequence.saturating_sub(bare))) } else { skipped })
    }

    /// Opens another session with this frame. Earlier frames of its sender are not counted as lost.
    pub(crate) fn begin(&mut self, session: u32, sequence: u32) {
        *self = Self { session: Some(session), next: [sequence.checked_add(1); 2] };
    }

    /// Whether a session of this number may be opened in the place of the one that is.
    pub(crate) fn admits(&self, session: u32, admission: Admission) -> bool {
        match admission {
            Admission::Later => self.is_ahead(session),
            Admission::Nobody => self.session.is_none(),
            Admission::Anybody => true,
        }
    }

    /// Whether a session number is later than the open one: ahead of it by less than half the range.
    fn is_ahead(&self, session: u32) -> bool {
        self.session.is_none_or(|open| (1..1 << 31).contains(&session.wrapping_sub(open)))
    }
}

#[cfg(test)]
mod tests {
    use super::Admission::{Anybody, Later, Nobody};
    use super::*;

    fn bare(session: u32, sequence: u32) -> Numbers {
        Numbers { session, sequence, is_tagged: false }
    }

    #[test]
    fn only_later_numbers_are_taken() {
        let mut window = Window::open(7);
        assert_eq!(window.take(bare(7, 0), false, Later), Ok(0));
        assert_eq!(window.take(bare(7, 0), false, Later), Err(Rejected::Duplicate { sequence: 0 }));
        assert_eq!(window.take(bare(7, 5), false, Later), Ok(4), "1 to 4 were skipped");
        assert_eq!(window.take(bare(7, 4), false, Later), Err(Rejected::Stale { sequence: 4 }), "late");
        assert_eq!(
            window.take(bare(7, 5), true, Later),
            Err(Rejected::Duplicate { sequence: 5 }),
            "a hello counts like any other"
        );
        assert_eq!(window.take(bare(7, 6), true, Later), Ok(0), "a hello may be repeated within its session");
    }

    #[test]
    fn a_session_ends_with_its_last_number() {
        let mut window = Window::open(0);
        assert_eq!(window.take(bare(0, u32::MAX), false, Later), Ok(u32::MAX));
        assert_eq!(window.take(bare(0, u32::MAX), false, Later), Err(Rejected::Duplicate { sequence: u32::MAX }));
        assert_eq!(
            window.take(bare(0, 0), false, Later),
            Err(Rejected::Stale { sequence: 0 }),
            "numbers never start over"
        );
        assert_eq!(window.take(bare(1, 0), true, Later), Ok(0), "a new session does");
    }

    #[test]
    fn only_a_hello_with_a_later_number_opens_a_session() {
        let mut window = Window::closed();
        assert_eq!(window.take(bare(100, 0), false, Later), Err(Rejected::ForeignSession { session: 100 }));
        assert_eq!(window.take(bare(100, 3), true, Later), Ok(0));
        for earlier in [99, 0, 100_u32.wrapping_sub(1 << 30), 100 + (1 << 31)] {
            let replayed = window.take(bare(earlier, 0), true, Later);
            assert_eq!(replayed, Err(Rejected::ForeignSession { session: earlier }), "{earlier} is not ahead of 100");
        }
        assert_eq!(window.take(bare(100, 4), false, Later), Ok(0), "the session is still open");
        assert_eq!(window.take(bare(100 + (1 << 30), 0), true, Later), Ok(0));
        assert_eq!(
            window.take(bare(100, 5), false, Later),
            Err(Rejected::ForeignSession { session: 100 }),
            "and now it is closed"
        );
    }

    #[test]
    fn session_numbers_wrap() {
        let mut window = Window::open(u32::MAX);
        assert_eq!(window.take(bare(0, 0), true, Later), Ok(0));
    }

    #[test]
    fn the_receiver_admits_sessions() {
        let mut window = Window::closed();
        assert_eq!(window.take(bare(100, 0), true, Nobody), Ok(0), "there is nobody whose it could be");
        let foreign = |session| Err(Rejected::ForeignSession { session });
        assert_eq!(window.take(bare(101, 0), true, Nobody), foreign(101));
        assert_eq!(window.take(bare(100, 1), false, Nobody), Ok(0));
        assert_eq!(window.take(bare(7, 0), false, Anybody), foreign(7), "no hello");
        assert_eq!(window.take(bare(7, 0), true, Anybody), Ok(0), "an earlier number");
        assert_eq!(window.take(bare(100, 2), false, Anybody), foreign(100));
    }

    #[test]
    fn no_frame_without_a_tag_makes_one_with_a_tag_late() {
        let mut window = Window::open(7);
        let tagged = |sequence| Numbers { session: 7, sequence, is_tagged: true };
        assert_eq!(window.take(bare(7, 1), false, Later), Ok(1));
        assert_eq!(window.take(tagged(0), false, Later), Ok(0), "overtaken by one without");
        assert_eq!(window.take(bare(7, u32::MAX), false, Later), Ok(u32::MAX - 2), "somebody's");
        assert_eq!(window.take(tagged(2), false, Later), Ok(0));
        assert_eq!(window.take(tagged(2), false, Later), Err(Rejected::Duplicate { sequence: 2 }));
        assert_eq!(window.take(tagged(1), false, Later), Err(Rejected::Stale { sequence: 1 }));
        let mut window = Window::open(7);
        assert_eq!(window.take(tagged(5), false, Later), Ok(5), "0 to 4 were skipped");
        assert_eq!(window.take(bare(7, 4), false, Later), Err(Rejected::Stale { sequence: 4 }));
        assert_eq!(window.take(bare(7, 6), false, Later), Ok(0));
        assert_eq!(window.take(tagged(8), false, Later), Ok(1), "7 was skipped");
    }
}
