//! The outcome of a flight with a fault: when it was noticed, how and where the flight ended.

use std::fmt;

use quatrack::supervisor::Mode;
use serde::Serialize;

/// How a flight ended, in the supervisor's words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EndState(pub Mode);

impl Serialize for EndState {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&self.0)
    }
}

impl fmt::Display for EndState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// The result of a fault on a craft.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Its name.
    pub fault: &'static str,
    /// The craft's.
    pub vehicle: String,
    /// From its beginning until the supervisor bridges or does something else than flying on, ms; nothing where it never does.
    pub detected_ms: Option<u32>,
    /// The supervisor's mode at the end.
    pub end_state: EndState,
    /// From its beginning until the motors are off, ms.
    pub motors_off_ms: Option<u32>,
    /// Farthest from the course while it is flown, over ground from where the fault began after that, m.
    pub farthest_m: f64,
    /// Whether the craft came down hard or was lost.
    pub crashed: bool,
    /// Whether nothing may be lost.
    pub recoverable: bool,
    /// The answers of PX4 and of Bitcraze's firmware.
    pub others: &'static str,
}

impl Row {
    /// Whether it is as it should be: no craft lost by a recoverable fault, and motors off or landed otherwise.
    pub fn is_as_promised(&self) -> bool {
        if self.recoverable { !self.crashed } else { !self.crashed || self.motors_off_ms.is_some() }
    }
}
