//! The supervisor's modes, what leads to them, and what follows from them.

use core::fmt;

/// Something that only a restart of the board mends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Fault {
    /// The processor took a fault exception.
    HardFault,
    /// The stack grew into its guard.
    StackExhausted,
    /// The control interrupt did not come when it should have.
    ClockStopped,
}

/// Why a flight, or readiness for one, ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StopReason {
    /// A disarm request.
    Requested,
    /// More overruns in a row than tolerated.
    Overrun,
    /// No accepted frame for longer than allowed.
    LinkLost,
    /// The last state is older than allowed.
    StaleState,
    /// There was nothing to follow while flying.
    NoReference,
    /// State, reference or law gave no command.
    StepFailed,
}

/// What the supervisor is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Mode {
    /// Motors off; why, if it was ever armed since start-up.
    Disarmed(Option<StopReason>),
    /// Motors may turn, the command is zero until there is one.
    Armed,
    /// Commands pass.
    Flying,
    /// Motors off until a restart.
    Faulted(Fault),
}

/// Why an arm request is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ArmError {
    /// A fault that only a restart mends.
    Faulted(Fault),
    /// The link has been silent for too long; the request that came over it is too old.
    LinkSilent,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::HardFault => "hard fault",
            Self::StackExhausted => "stack exhausted",
            Self::ClockStopped => "control clock stopped",
        })
    }
}

impl fmt::Display for StopReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Requested => "by request",
            Self::Overrun => "a tick overran",
            Self::LinkLost => "link lost",
            Self::StaleState => "state too old",
            Self::NoReference => "no reference",
            Self::StepFailed => "no command from the step",
        })
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Disarmed(None) => f.write_str("disarmed"),
            Self::Disarmed(Some(reason)) => write!(f, "disarmed ({reason})"),
            Self::Armed => f.write_str("armed"),
            Self::Flying => f.write_str("flying"),
            Self::Faulted(fault) => write!(f, "faulted ({fault}; restart the board)"),
        }
    }
}

impl fmt::Display for ArmError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Faulted(fault) => write!(f, "arm: {fault} since start-up; restart the board"),
            Self::LinkSilent => f.write_str("arm: the link is silent; send states first"),
        }
    }
}

impl core::error::Error for ArmError {}

impl Mode {
    /// Whether the motors may turn.
    pub const fn motors_allowed(self) -> bool {
        matches!(self, Self::Armed | Self::Flying)
    }

    /// Whether the step's command reaches the motors.
    pub const fn command_passes(self) -> bool {
        matches!(self, Self::Flying)
    }
}
