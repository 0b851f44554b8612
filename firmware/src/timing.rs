//! Timing of the loop: counts of a free-running counter in; the tick, overruns, jitter and the longest step
//! out. Shared between interrupts without locks.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

use quatrack::Tick;

use crate::rates::{DECIMATION, LOCK_STEP};

/// All interrupts run on one core and each number has one writer: relaxed order is order enough.
pub struct Timing {
    /// Counts between two ticks, and in a nanosecond of it, as set at start-up.
    counts_per_tick: u32,
    tick: AtomicU32,
    decimation: AtomicU32,
    /// A step is due and has not ended.
    due: AtomicBool,
    overran: AtomicBool,
    overruns: AtomicU32,
    last_count: AtomicU32,
    started: AtomicBool,
    jitter_counts: AtomicU32,
    worst_counts: AtomicU32,
}

/// Period of a tick, ns.
const TICK_NS: u64 = 1_000_000;

impl Timing {
    /// Nothing has happened yet.
    pub const fn new(counts_per_tick: u32) -> Self {
        Self {
            counts_per_tick,
            tick: AtomicU32::new(0),
            decimation: AtomicU32::new(DECIMATION),
            due: AtomicBool::new(false),
            overran: AtomicBool::new(false),
            overruns: AtomicU32::new(0),
            last_count: AtomicU32::new(0),
            started: AtomicBool::new(false),
            jitter_counts: AtomicU32::new(0),
            worst_counts: AtomicU32::new(0),
        }
    }

    /// The timer's interrupt: counts the tick and says whether the control interrupt is to run. In lock-step it is, to
    /// watch.
    pub fn on_timer(&self, count: u32) -> bool {
        let tick = self.tick.load(Relaxed).wrapping_add(1);
        self.tick.store(tick, Relaxed);
        let passed = count.wrapping_sub(self.last_count.load(Relaxed));
        self.last_count.store(count, Relaxed);
        if self.started.load(Relaxed) {
            raise(&self.jitter_counts, passed.abs_diff(self.counts_per_tick));
        }
        self.started.store(true, Relaxed);
        let decimation = self.decimation.load(Relaxed);
        let due = decimation == LOCK_STEP || tick.checked_rem(decimation) == Some(0);
        if due && self.due.load(Relaxed) {
            self.overran.store(true, Relaxed);
            self.overruns.store(self.overruns.load(Relaxed).saturating_add(1), Relaxed);
        }
        if due {
            self.due.store(true, Relaxed);
        }
        due
    }

    /// The control interrupt begins: whether the timer asked for it, and whether an overrun came since the last time.
    pub fn on_begin(&self) -> (bool, bool) {
        let overran = self.overran.load(Relaxed);
        self.overran.store(false, Relaxed);
        (self.due.load(Relaxed), overran)
    }

    /// The control interrupt ends. A step that the timer asked for is timed from the timer's interrupt on, one in
    /// lock-step from its own beginning.
    pub fn on_end(&self, begun_count: u32, count: u32, was_due: bool) {
        let from = if was_due { self.last_count.load(Relaxed) } else { begun_count };
        raise(&self.worst_counts, count.wrapping_sub(from));
        if was_due {
            self.due.store(false, Relaxed);
        }
    }

    /// The tick.
    pub fn now(&self) -> Tick {
        self.tick.load(Relaxed)
    }

    /// Sets the ticks for one step.
    pub fn set_decimation(&self, decimation: u32) {
        self.decimation.store(decimation, Relaxed);
    }

    /// Ticks that ran past their period.
    pub fn overruns(&self) -> u32 {
        self.overruns.load(Relaxed)
    }

    /// Largest deviation of a tick's start from its period, ns.
    pub fn jitter_ns(&self) -> u32 {
        self.nanoseconds(self.jitter_counts.load(Relaxed))
    }

    /// Longest time from a tick's interrupt to its command, ns.
    pub fn worst_step_ns(&self) -> u32 {
        self.nanoseconds(self.worst_counts.load(Relaxed))
    }

    fn nanoseconds(&self, counts: u32) -> u32 {
        let ns = (u64::from(counts) * TICK_NS).checked_div(u64::from(self.counts_per_tick));
        ns.and_then(|ns| u32::try_from(ns).ok()).unwrap_or(u32::MAX)
    }
}

fn raise(most: &AtomicU32, value: u32) {
    if value > most.load(Relaxed) {
        most.store(value, Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_that_is_still_due_at_the_next_one_is_an_overrun() {
        let timing = Timing::new(100);
        assert!(!timing.on_timer(100), "every second tick has a step");
        assert!(timing.on_timer(200));
        assert_eq!(timing.on_begin(), (true, false));
        timing.on_end(205, 230, true);
        assert_eq!(timing.worst_step_ns(), 300_000, "30 of 100 counts, from the timer's interrupt");
        timing.on_timer(300);
        assert!(timing.on_timer(403));
        assert!(!timing.on_timer(500) && timing.on_timer(600), "the step of tick 4 has not ended");
        assert_eq!(timing.overruns(), 1);
        assert_eq!(timing.on_begin(), (true, true));
        timing.on_end(605, 610, true);
        assert_eq!(timing.on_begin(), (false, false), "an overrun is told once");
        assert_eq!(timing.jitter_ns(), 30_000);
        assert_eq!(timing.now(), 6);
    }

    #[test]
    fn in_lock_step_every_tick_is_watched() {
        let timing = Timing::new(100);
        timing.set_decimation(LOCK_STEP);
        assert!(timing.on_timer(100));
        timing.on_begin();
        timing.on_end(101, 102, true);
        assert!(timing.on_timer(200));
        assert_eq!(timing.overruns(), 0);
    }
}
