//! What is done between control steps when nothing else is: one thing at a time, in turn.

/// What there is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chore {
    /// To write into the log how far the last step was off.
    LogErrors,
    /// To write into the log what has been counted.
    LogCounters,
    /// To take over what the app's task has handed over.
    TakeOver,
}

/// Whose turn it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chores {
    next: Chore,
    put_off: u8,
}

/// Calls without time in a row after which a chore is done all the same.
const PUT_OFF_MAX: u8 = 4;

impl Chores {
    pub(super) const fn new() -> Self {
        Self { next: Chore::TakeOver, put_off: 0 }
    }

    /// There is time for one.
    #[inline]
    pub(super) fn next(&mut self) -> Chore {
        let chore = self.next;
        self.put_off = 0;
        self.next = match chore {
            Chore::TakeOver => Chore::LogErrors,
            Chore::LogErrors => Chore::LogCounters,
            Chore::LogCounters => Chore::TakeOver,
        };
        chore
    }

    /// There is none, and something is done only if that goes on.
    #[inline]
    pub(super) fn put_off(&mut self) -> Option<Chore> {
        self.put_off += 1;
        (self.put_off > PUT_OFF_MAX).then(|| self.next())
    }
}
