//! Settings and results of the controller, beside setpoint and estimate: the owner's settings in; the output, the limits
//! that cut it, and the counts of faults, out.

use quatrack::mixer::MotorLimited;
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::{self, Reason, Tumble};
use quatrack::{FeedForward, Limits, Quaternion};

use crate::output::Output;
use crate::shaping::Bounds;

/// How the last setpoint is flown, for the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Mode {
    /// Motors off, as asked.
    Off = 0,
    /// As asked.
    Flying = 1,
    /// Not as asked: to rest, or level, and slowly down.
    Descending = 2,
    /// Motors off until a new flight, or until the first sound estimate of this one.
    Stopped = 3,
    /// Motors off: the app has not said which craft this is, or there is no table for it.
    NoCraft = 4,
}

impl Mode {
    /// Whether the motors turn in the mode of a number.
    pub(crate) const fn is_flight(number: u8) -> bool {
        number == Self::Flying as u8 || number == Self::Descending as u8
    }
}

/// Why a flight was left, for the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Why {
    /// It was not.
    Nothing = 0,
    /// The setpoint makes no sense.
    BadSetpoint = 1,
    /// No position or velocity for longer than they are bridged.
    StateLost = 2,
    /// No attitude.
    AttitudeLost = 3,
    /// No body rates.
    BodyRatesLost = 4,
    /// The law gave no output on a sound state.
    StepFailed = 5,
    /// The motors have been at their limits for longer than allowed.
    Saturated = 6,
    /// It has come down.
    Landed = 7,
    /// It has been going down for longer than allowed.
    NoGround = 8,
    /// Tilted beyond 60 degrees for longer than allowed.
    Tilted = 9,
    /// Upside down for longer than allowed.
    UpsideDown = 10,
    /// At rest while its motors give all that they have.
    NoClimb = 11,
}

impl Why {
    /// The reason in the supervisor's mode.
    pub(super) const fn of(mode: supervisor::Mode) -> Option<Self> {
        let reason = match mode {
            supervisor::Mode::Tumbled(Tumble::Tilted) => return Some(Self::Tilted),
            supervisor::Mode::Tumbled(Tumble::UpsideDown) => return Some(Self::UpsideDown),
            supervisor::Mode::Tumbled(Tumble::NoClimb) => return Some(Self::NoClimb),
            other => other.reason(),
        };
        match reason {
            Some(Reason::BadReference) => Some(Self::BadSetpoint),
            Some(Reason::StateLost) => Some(Self::StateLost),
            Some(Reason::AttitudeLost) => Some(Self::AttitudeLost),
            Some(Reason::BodyRatesLost) => Some(Self::BodyRatesLost),
            Some(Reason::StepFailed) => Some(Self::StepFailed),
            Some(Reason::Saturated) => Some(Self::Saturated),
            Some(Reason::Landed) => Some(Self::Landed),
            Some(Reason::NoGround) => Some(Self::NoGround),
            // Of the supervisor's inputs that the object does not have: link, geofence, battery, overruns.
            _ => None,
        }
    }
}

/// The owner's settings beside the table, as the steps take them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Bounds of shaped setpoints.
    pub bounds: Bounds,
    /// Limits of the paper's laws' commands.
    pub limits: Limits,
    /// Feed-forward of the paper's laws.
    pub feed_forward: FeedForward,
}

/// Counts of events over all steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Steps on an estimate or gyroscope that had to be bridged.
    pub bad_states: u16,
    /// Setpoints that make no sense.
    pub bad_setpoints: u16,
    /// Steps that gave something up.
    pub limited_steps: u16,
    /// Setpoints that were not where the ones before led.
    pub jumps: u16,
}

/// The result of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The output.
    pub output: Output,
    /// The limits that cut it.
    pub limited: MotorLimited,
    /// The attitude that the reference has.
    pub target: Quaternion,
    /// Measured position less asked, world frame, m.
    pub error_m: Vector3<f32>,
    /// Whether the law of the table has stepped: its observers may look at that.
    pub has_stepped: bool,
}

impl Outcome {
    /// Motors off.
    pub(super) const OFF: Self = Self {
        output: Output::OFF,
        limited: MotorLimited::NOTHING,
        target: Quaternion::IDENTITY,
        error_m: Vector3::new(0.0, 0.0, 0.0),
        has_stepped: false,
    };
}
