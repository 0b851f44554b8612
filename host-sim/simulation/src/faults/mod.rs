//! Flights with something wrong: a kind of fault and a craft in; when it was noticed, how the flight ended and where, out.
//!
//! The core's cascade under the core's supervisor, or the Crazyflie object, at 500 Hz, on the plant in air with the known
//! figures of each craft; estimates with noise at every step. A fault in flight begins after two seconds of it.
//!
//! ```text
//! bench                  one flight
//!   row                  its outcome
//!   under_guard, object  its controller: the core's cascade under the core's supervisor; the Crazyflie object
//! kinds                  every kind of fault: the signals it spoils, and others' answers
//!   signals              the targets of a fault: inputs of a step, controller, craft
//! ```

mod bench;
mod kinds;
mod object;
mod row;
mod signals;
mod under_guard;

pub use self::bench::{Crafts, HEIGHT_M, fly, fly_by, fly_object};
pub use self::kinds::kinds;
pub use self::row::{EndState, Row};
pub use self::signals::{Craft, Fault, Signals, UnderTest};

/// The crafts that are flown.
pub const VEHICLES: [&str; 3] = ["crazyflie-2.1", "crazyflie-2.1-upgrade-kit", "crazyflie-2.1-brushless"];
