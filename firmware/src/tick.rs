//! The two interrupts of the loop, without their vectors: the timer's tick, and the control step that it asks for.

use quatrack::supervisor::Fault;

use crate::counter::Counter;
use crate::flight::Flight;
use crate::stack;
use crate::timing::Timing;

/// The control interrupt: looks at the stack, steps if a step is due, watches the ages if not, and times itself.
#[inline]
pub fn control(flight: &mut Flight, timing: &Timing, counter: Counter) {
    let begun = counter.now();
    let (due, overran) = timing.on_begin();
    let now = timing.now();
    if !stack::is_within_bound() {
        flight.fail(Fault::StackExhausted, now);
    }
    let steps = if flight.is_lock_step() { flight.is_waiting() } else { due };
    if steps {
        flight.step(now, overran);
    } else {
        flight.watch(now, overran);
    }
    timing.on_end(begun, counter.now(), due);
}
