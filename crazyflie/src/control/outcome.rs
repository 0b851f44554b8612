//! What goes into the controller beside setpoint and estimate, and what comes out of it: settings in; the output, what
//! was given up for it, and what has been seen on the way, out.

use quatrack::mixer::MotorLimited;
use quatrack::nalgebra::Vector3;
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
    /// To rest and slowly down: the setpoint makes no sense.
    Descending = 2,
    /// Motors off: the estimate or the gyroscope is not to be flown on.
    Blind = 3,
    /// Motors off: the app has not said which craft this is, or there is no table for it.
    NoCraft = 4,
}

/// What the owner may change beside the table, as the steps take it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Of setpoints.
    pub bounds: Bounds,
    /// What the paper's laws may command.
    pub limits: Limits,
    /// Of the paper's laws.
    pub feed_forward: FeedForward,
}

/// What the steps have seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Steps on an estimate or gyroscope that is not to be flown on.
    pub bad_states: u16,
    /// Setpoints that make no sense.
    pub bad_setpoints: u16,
    /// Steps that gave something up.
    pub limited_steps: u16,
    /// Setpoints that were not where the ones before led.
    pub jumps: u16,
}

/// What one step gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// What is put out.
    pub output: Output,
    /// What it gave up.
    pub limited: MotorLimited,
    /// The attitude that the reference has.
    pub target: Quaternion,
    /// Measured position less asked, world frame, m.
    pub error_m: Vector3<f32>,
    /// Whether nothing could be flown on: motors off.
    pub is_blind: bool,
}

impl Outcome {
    /// Motors off.
    pub(super) const OFF: Self = Self {
        output: Output::OFF,
        limited: MotorLimited::NOTHING,
        target: Quaternion::IDENTITY,
        error_m: Vector3::new(0.0, 0.0, 0.0),
        is_blind: false,
    };
}
