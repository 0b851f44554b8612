//! Drivers of parts, against the traits of `embedded-hal`: a bus or pins of any board in, SI units out, or the other way
//! round. No hardware of this board, so that all of it is tested on the host.

pub mod battery;
pub mod bmi088;
pub mod motors;
pub mod thrust_curve;
