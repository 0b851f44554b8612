//! Background work: one thing at a time, in turn, in the calls between control steps in which nothing else is done.

/// The kinds of work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// To write into the log how far the last step was off.
    LogErrors,
    /// To write into the log the counters.
    LogCounters,
    /// To write into the log the learned figures.
    LogLearned,
    /// To take over the table or settings that the app's task has handed over.
    TakeOver,
}

/// The work whose turn it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Background {
    next: Work,
    put_off: u8,
}

/// Calls without time in a row after which something is done all the same.
const PUT_OFF_MAX: u8 = 4;

impl Background {
    pub(super) const fn new() -> Self {
        Self { next: Work::TakeOver, put_off: 0 }
    }

    /// There is time for something.
    #[inline]
    pub(super) fn next(&mut self) -> Work {
        let work = self.next;
        self.put_off = 0;
        self.next = match work {
            Work::TakeOver => Work::LogErrors,
            Work::LogErrors => Work::LogCounters,
            Work::LogCounters => Work::LogLearned,
            Work::LogLearned => Work::TakeOver,
        };
        work
    }

    /// There is none, and something is done only if that goes on.
    #[inline]
    pub(super) fn put_off(&mut self) -> Option<Work> {
        self.put_off += 1;
        (self.put_off > PUT_OFF_MAX).then(|| self.next())
    }
}
