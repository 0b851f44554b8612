//! The loop's rates: ticks a second, and ticks a control step.

use quatrack::Rate;

/// Ticks of the loop a second.
pub const TICK_RATE_HZ: u32 = 1000;

/// The same as a rate.
pub const TICK_RATE: Rate = match Rate::from_hz(TICK_RATE_HZ) {
    Some(rate) => rate,
    None => panic!("the core does not tick at this rate"),
};

/// Ticks for one control step unless it is set otherwise: 500 Hz.
pub const DECIMATION: u32 = 2;

/// Decimation at which the steps are taken when states come, on the clock of the states: lock-step with a simulation.
pub const LOCK_STEP: u32 = 0;
