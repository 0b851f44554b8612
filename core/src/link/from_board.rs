//! Messages from the board to a host.

use core::fmt;

use serde::{Deserialize, Serialize};

use super::Message;
use super::counters::Counters;
use super::seal::{Nonce, Protection, Tagging};
use super::to_board::Parameter;
use super::trajectory_store::BlobError;
use super::upload::{Progress, UploadError};
use crate::clock::Tick;
use crate::command::LimitsError;
use crate::control::{MotorStep, Step};
use crate::error::{ReferenceError, StepError};
use crate::supervisor::{ArmError, Fault, Mode};

/// A message from the board.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FromBoard {
    /// Answers a hello.
    Hello(Identity),
    /// Answers a state.
    Command(CommandOut),
    /// Sent on its own, every so many ticks.
    Telemetry(Telemetry),
    /// The request has been carried out.
    Ack {
        /// Sequence number of the request.
        sequence: u32,
    },
    /// The request has been refused; nothing has changed.
    Nack {
        /// Sequence number of the request.
        sequence: u32,
        /// Why.
        reason: Refusal,
    },
    /// Answers an upload's begin, chunk and query.
    Upload(Progress),
    /// Answers a get or a set with the value that is in force.
    Parameter(Parameter),
    /// Sent on its own when a fault is found, and again with every hello until a restart.
    Fault(FaultReport),
    /// Answers a state on which the board knows body rates: those that came with it, or its own gyroscope's.
    Forces(ForcesOut),
}

impl Message for FromBoard {
    const KINDS: u8 = 9;

    fn opens_session(&self) -> bool {
        false
    }

    fn tagging(&self) -> Tagging {
        match self {
            Self::Hello(_) => Tagging::Greeting,
            Self::Command(_) | Self::Forces(_) | Self::Telemetry(_) | Self::Fault(_) => Tagging::Motion,
            _ => Tagging::Always,
        }
    }
}

/// Version of a firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Version {
    /// Incompatible changes.
    pub major: u16,
    /// Additions.
    pub minor: u16,
    /// Corrections.
    pub patch: u16,
}

/// The board's identity. The protocol's version is in every frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Identity {
    /// Version of the firmware.
    pub firmware: Version,
    /// Identifies the control path in the image: images that share it command the same bits.
    pub control_image: u32,
    /// Ticks of the loop a second, Hz.
    pub tick_rate_hz: u32,
    /// Ticks for one control step.
    pub decimation: u32,
    /// Pieces that an uploaded trajectory may have.
    pub trajectory_pieces: u32,
    /// The frames that carry a tag.
    pub protection: Protection,
    /// Whether only signed gain tables are taken.
    pub signed_tables: bool,
    /// The board's own, from which the session's key follows.
    pub nonce: Nonce,
}

/// The command that answers a state, with the exact bits of the step's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CommandOut {
    /// The board's tick of the step.
    pub tick: Tick,
    /// The tick of the state that was stepped on, as it came.
    pub state_tick: Tick,
    /// The command and the limits that cut it, or why there is none.
    pub result: Result<Step, NoCommand>,
}

/// The motor forces that answer a state, with the exact bits of the step's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ForcesOut {
    /// The board's tick of the step.
    pub tick: Tick,
    /// The tick of the state that was stepped on, as it came.
    pub state_tick: Tick,
    /// The forces of M1 to M4 and the limits that cut them, or why there are none.
    pub result: Result<MotorStep, NoCommand>,
}

/// Why a state has no command. The motors are at zero, or will be by the end of this tick.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NoCommand {
    /// The supervisor lets none pass in this mode.
    Mode(Mode),
    /// There was nothing to follow.
    NoReference,
    /// The reference cannot be flown.
    Reference(ReferenceError),
    /// The state cannot be flown on, or the law has no answer.
    Step(StepError),
    /// There are no body rates: the gyroscope does not answer, or there is none and the state came without.
    NoBodyRates,
}

/// Telemetry: counts and timing of the loop since start-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Telemetry {
    /// The board's tick.
    pub tick: Tick,
    /// The supervisor's mode.
    pub mode: Mode,
    /// The loop.
    pub statistics: LoopStatistics,
    /// The frames that came to the board.
    pub link: Counters,
}

/// Counts and extremes of the control loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LoopStatistics {
    /// Control steps.
    pub steps: u32,
    /// Steps without a command.
    pub steps_failed: u32,
    /// Ticks that ran past their period.
    pub overruns: u32,
    /// Longest time from a tick's interrupt to its command, ns.
    pub worst_step_ns: u32,
    /// Largest deviation of a tick's start from its period, ns.
    pub jitter_ns: u32,
    /// Most stack in use, bytes.
    pub stack_bytes: u32,
    /// Bytes from the line that found the receive buffer full.
    pub bytes_dropped: u32,
}

/// A fault and where it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FaultReport {
    /// The fault.
    pub fault: Fault,
    /// The board's tick.
    pub tick: Tick,
    /// Program counter, or 0 where there is none.
    pub address: u32,
}

/// Why a request is refused.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// This firmware does not support the request.
    Unsupported,
    /// Not while the motors may turn.
    NotWhileArmed,
    /// The parameter cannot be set.
    ReadOnly,
    /// The value is out of the parameter's range.
    OutOfRange,
    /// There is no such trajectory on board, or none is playing.
    NoTrajectory,
    /// Arming is refused.
    Arm(ArmError),
    /// The limits are refused.
    Limits(LimitsError),
    /// A part of an upload is refused.
    Upload(UploadError),
    /// A finished upload is refused.
    Blob(BlobError),
    /// No gain table has been loaded in this place, or none can be for the rate of the steps.
    NoTable,
    /// One law is still giving way to another, or the table that an upload would replace is being flown.
    LawChanging,
    /// The hello has no tag of this board's key. Carries none itself.
    Key,
    /// The board has a key and nothing to make a nonce of: its source of random numbers does not work.
    NoNonce,
    /// There is nothing to keep blobs in, or it failed; the blob kept before is unchanged.
    NotKept,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unsupported => f.write_str("board: this firmware does not have it; update it"),
            Self::NotWhileArmed => f.write_str("board: not while armed; disarm first"),
            Self::ReadOnly => f.write_str("board: the parameter is fixed in the image"),
            Self::OutOfRange => f.write_str("board: the value is out of the parameter's range"),
            Self::NoTrajectory => f.write_str("board: no such trajectory; upload and commit, or start one first"),
            Self::Arm(error) => error.fmt(f),
            Self::Limits(error) => error.fmt(f),
            Self::Upload(error) => error.fmt(f),
            Self::Blob(error) => error.fmt(f),
            Self::NoTable => f.write_str("board: no such gain table; upload and commit one for this rate first"),
            Self::Key => f.write_str("board: it answers holders of its key alone; give the file of its key"),
            Self::NoNonce => f.write_str("board: no random numbers to use its key with; restart it"),
            Self::NotKept => f.write_str("board: its flash did not keep it; the upload kept before is unchanged"),
            Self::LawChanging => f.write_str("board: the law is changing; ask again when it has, or disarm first"),
        }
    }
}

impl fmt::Display for NoCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mode(mode) => write!(f, "board: no command while {mode}"),
            Self::NoReference => f.write_str("board: no reference; send one with the state or start a trajectory"),
            Self::Reference(error) => error.fmt(f),
            Self::Step(error) => error.fmt(f),
            Self::NoBodyRates => {
                f.write_str("board: no body rates; send them with the state, or look at the gyroscope")
            }
        }
    }
}

impl core::error::Error for Refusal {}
impl core::error::Error for NoCommand {}
