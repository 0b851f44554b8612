//! The mode of a craft, the reason for leaving the one before, and the action on its motors.

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

/// Why a flight does not go on as it was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Reason {
    /// A fault that only a restart mends.
    Fault(Fault),
    /// More overruns in a row than tolerated.
    Overrun,
    /// No attitude for longer than the gyroscope can carry one on.
    AttitudeLost,
    /// No body rates for longer than a craft flies without.
    BodyRatesLost,
    /// State, reference or law gave no command.
    StepFailed,
    /// No position or velocity for longer than they are bridged.
    StateLost,
    /// No accepted frame for longer than allowed.
    LinkLost,
    /// The reference makes no sense.
    BadReference,
    /// There was nothing to follow, or it is too old.
    NoReference,
    /// The reference begins farther from the craft than the law can bridge.
    StartTooFar,
    /// The craft has left the space that it is allowed.
    Geofence,
    /// The battery is empty.
    Battery,
    /// The motors have been at their limits for longer than allowed.
    Saturated,
    /// It has come down.
    Landed,
    /// It has been going down for longer than allowed.
    NoGround,
}

/// How a craft that cannot fly any more has tumbled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Tumble {
    /// Tilted beyond 60 degrees for longer than allowed.
    Tilted,
    /// Upside down for longer than allowed.
    UpsideDown,
    /// At rest while its motors give all that they have.
    NoClimb,
}

/// The mode of a craft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Mode {
    /// Motors off, as asked.
    OnGround,
    /// Motors may turn, and do with the first command.
    Armed,
    /// Flown as it is asked to.
    Flying,
    /// Brakes to a standstill and stays there.
    Holding(Reason),
    /// Goes down: above its place where it knows one, else level by attitude.
    LevelAndDown(Reason),
    /// Motors off until it is armed anew.
    Stopped(Reason),
    /// Motors off until it is armed anew, upright.
    Tumbled(Tumble),
}

/// The action on the motors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Nothing: they are off.
    Off,
    /// The law, towards its reference.
    Fly,
    /// The law, towards a standstill and then downwards.
    Brake,
    /// The attitude alone: level, and down.
    Level,
}

impl Mode {
    /// Whether the motors may turn.
    pub const fn motors_allowed(self) -> bool {
        matches!(self, Self::Armed) || self.is_in_air()
    }

    /// Whether it flies, in whichever way.
    pub const fn is_in_air(self) -> bool {
        matches!(self, Self::Flying | Self::Holding(_) | Self::LevelAndDown(_))
    }

    /// Why it does not fly as it was asked to.
    pub const fn reason(self) -> Option<Reason> {
        match self {
            Self::Holding(reason) | Self::LevelAndDown(reason) | Self::Stopped(reason) => Some(reason),
            Self::OnGround | Self::Armed | Self::Flying | Self::Tumbled(_) => None,
        }
    }
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

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Fault(fault) => return write!(f, "{fault}; restart the board"),
            Self::Overrun => "a tick overran",
            Self::AttitudeLost => "no attitude",
            Self::BodyRatesLost => "no body rates",
            Self::StepFailed => "no command from the step",
            Self::StateLost => "no position or velocity",
            Self::LinkLost => "link lost",
            Self::BadReference => "reference that cannot be flown",
            Self::NoReference => "no reference",
            Self::StartTooFar => "start too far from the reference",
            Self::Geofence => "outside the geofence",
            Self::Battery => "battery empty",
            Self::Saturated => "motors at their limits",
            Self::Landed => "landed",
            Self::NoGround => "no ground found",
        })
    }
}

impl fmt::Display for Tumble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Tilted => "tilted beyond 60 degrees",
            Self::UpsideDown => "upside down",
            Self::NoClimb => "no climb at full thrust",
        })
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OnGround => f.write_str("on the ground"),
            Self::Armed => f.write_str("armed"),
            Self::Flying => f.write_str("flying"),
            Self::Holding(reason) => write!(f, "holding ({reason})"),
            Self::LevelAndDown(reason) => write!(f, "going down ({reason})"),
            Self::Stopped(reason) => write!(f, "stopped ({reason})"),
            Self::Tumbled(tumble) => write!(f, "tumbled ({tumble})"),
        }
    }
}
