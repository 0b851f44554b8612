//! The two interrupts of the loop, without their vectors: the timer's tick, and the control step that it asks for.

use quatrack::supervisor::Fault;

use crate::counter::Counter;
use crate::craft::{BodyRates, Craft};
use crate::flight::Flight;
use crate::stack;
use crate::timing::Timing;

/// The control interrupt: looks at the stack, steps if a step is due, watches the ages if not, drives the motors, and
/// times itself. In lock-step with a simulation the craft is left alone: its motors stay off.
#[inline]
pub fn control(flight: &mut Flight, timing: &Timing, counter: Counter, craft: &mut impl Craft) {
    let begun = counter.now();
    let (due, overran) = timing.on_begin();
    let now = timing.now();
    if !stack::is_within_bound() {
        flight.fail(Fault::StackExhausted, now);
    }
    let steps = if flight.is_lock_step() { flight.is_waiting() } else { due };
    if steps {
        let rates = if flight.takes_body_rates() { craft.body_rates() } else { BodyRates::NoGyroscope };
        flight.step(now, overran, rates);
    } else {
        flight.watch(now, overran);
    }
    craft.drive(flight.driven_forces_n(), flight.motors.battery());
    timing.on_end(begun, counter.now(), due);
}
