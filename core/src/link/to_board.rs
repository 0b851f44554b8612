//! Messages from a host to the board.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::Message;
use super::law_choice::LawChoice;
use super::seal::{Nonce, Tagging};
use super::upload::{Chunk, UploadBegin};
use crate::clock::Tick;
use crate::command::{Limits, LimitsError};
use crate::reference::FlatSample;
use crate::rigid_state::RigidState;
use crate::state::State;

/// A message to the board. States are answered by a command or by motor forces, the hello by an identity, everything else by an
/// acknowledgement, a refusal, or the requested value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ToBoard {
    /// Opens a session and asks for the board's identity, with a nonce of the host. May be repeated until it is answered.
    Hello(Nonce),
    /// A state; the reference comes from the stored trajectory that is playing.
    State(StateIn),
    /// A state and the reference.
    StateAndReference(StateIn, FlatSample),
    /// Which law to fly from the next step on.
    SelectLaw(LawChoice),
    /// Stored trajectories.
    Trajectory(TrajectoryCommand),
    /// Be ready to fly.
    Arm,
    /// Motors off.
    Disarm,
    /// Ask for a parameter.
    GetParameter(ParameterId),
    /// Set a parameter.
    SetParameter(Parameter),
    /// Announce a blob; the same announcement again resumes.
    UploadBegin(UploadBegin),
    /// A piece of the announced blob.
    UploadChunk(Chunk),
    /// Ask which offset is wanted next.
    UploadQuery,
    /// Check the whole blob and put it to use.
    UploadCommit {
        /// Id of the announced blob.
        id: u32,
    },
    /// Ask for telemetry now, beside its period.
    TelemetryRequest,
    /// A state with body rates, for a board without a gyroscope; the reference comes from the stored trajectory that is
    /// playing.
    RigidState(RigidStateIn),
    /// Keep the committed blob over a loss of power, in the place of the one that was kept before. Not while armed: the flash
    /// holds the processor up.
    UploadKeep {
        /// Id of the committed blob.
        id: u32,
    },
}

impl Message for ToBoard {
    const KINDS: u8 = 16;

    fn opens_session(&self) -> bool {
        matches!(self, Self::Hello(_))
    }

    fn tagging(&self) -> Tagging {
        match self {
            Self::Hello(_) => Tagging::Greeting,
            Self::State(_) | Self::StateAndReference(..) | Self::RigidState(_) => Tagging::Motion,
            _ => Tagging::Always,
        }
    }
}

/// A state and when it was.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct StateIn {
    /// The host's tick to which the state belongs; comes back with the command.
    pub tick: Tick,
    /// Position, attitude and velocity as measured or estimated; checked by the step.
    pub state: State,
}

/// A state with body rates and when it was.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RigidStateIn {
    /// The host's tick to which the state belongs; comes back with the forces.
    pub tick: Tick,
    /// Position, attitude, velocity and body rates as measured or estimated; checked by the step.
    pub state: RigidState,
}

/// A stored trajectory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TrajectoryId {
    /// The paper's mild trajectory.
    Mild,
    /// The paper's aggressive trajectory.
    Aggressive,
    /// The uploaded one that was committed last.
    Uploaded,
}

/// Orders about stored trajectories.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TrajectoryCommand {
    /// Play from the start, at the next step.
    Start(TrajectoryId),
    /// Rest at the position and heading that have been reached.
    Pause,
    /// Go on from there.
    Resume,
    /// Take the reference away; a flight without another one ends.
    Stop,
}

/// Names a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ParameterId {
    /// [`Parameter::Decimation`].
    Decimation,
    /// [`Parameter::Limits`].
    Limits,
    /// [`Parameter::StateAgeMaxTicks`].
    StateAgeMaxTicks,
    /// [`Parameter::LinkSilenceMaxTicks`].
    LinkSilenceMaxTicks,
    /// [`Parameter::OverrunsTolerated`].
    OverrunsTolerated,
    /// [`Parameter::TelemetryPeriodTicks`].
    TelemetryPeriodTicks,
    /// [`Parameter::UploadsRefused`].
    UploadsRefused,
    /// [`Parameter::BatteryVoltage`].
    BatteryVoltage,
    /// [`Parameter::BodyRateBandwidth`].
    BodyRateBandwidth,
    /// [`Parameter::Leash`].
    Leash,
}

/// A parameter and its value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Parameter {
    /// Ticks of the loop for one control step.
    Decimation(u32),
    /// Limits of the vehicle's commands.
    Limits(LimitsSetting),
    /// Oldest state that is flown on, ticks.
    StateAgeMaxTicks(Tick),
    /// Longest time without an accepted frame, ticks.
    LinkSilenceMaxTicks(Tick),
    /// Overruns in a row that a flight survives.
    OverrunsTolerated(u32),
    /// Ticks between two telemetry messages; 0 sends none.
    TelemetryPeriodTicks(Tick),
    /// Commits since start-up that did not put an upload to use. Cannot be set.
    UploadsRefused(u32),
    /// The voltage by which the motors' duties are computed, V. May be set in flight, as the battery drains.
    BatteryVoltage(f32),
    /// Bandwidth of the loop that follows a law's body rates about body x, y, z, rad/s.
    BodyRateBandwidth([f32; 3]),
    /// Farthest error that the laws of references act on, m and m/s; infinity for the laws as they are in the paper.
    Leash(f32),
}

impl Parameter {
    /// Its id.
    pub const fn id(&self) -> ParameterId {
        match self {
            Self::Decimation(_) => ParameterId::Decimation,
            Self::Limits(_) => ParameterId::Limits,
            Self::StateAgeMaxTicks(_) => ParameterId::StateAgeMaxTicks,
            Self::LinkSilenceMaxTicks(_) => ParameterId::LinkSilenceMaxTicks,
            Self::OverrunsTolerated(_) => ParameterId::OverrunsTolerated,
            Self::TelemetryPeriodTicks(_) => ParameterId::TelemetryPeriodTicks,
            Self::UploadsRefused(_) => ParameterId::UploadsRefused,
            Self::BatteryVoltage(_) => ParameterId::BatteryVoltage,
            Self::BodyRateBandwidth(_) => ParameterId::BodyRateBandwidth,
            Self::Leash(_) => ParameterId::Leash,
        }
    }
}

/// Limits as numbers, unchecked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LimitsSetting {
    /// Least thrust, m/s^2.
    pub thrust_min_m_s2: f32,
    /// Most thrust, m/s^2.
    pub thrust_max_m_s2: f32,
    /// Largest body rates `p q r`, rad/s.
    pub body_rates_max_rad_s: [f32; 3],
}

impl LimitsSetting {
    /// The limits that these numbers are.
    ///
    /// # Errors
    /// [`LimitsError`] as [`Limits::new`].
    pub fn check(&self) -> Result<Limits, LimitsError> {
        Limits::new(self.thrust_min_m_s2, self.thrust_max_m_s2, Vector3::from(self.body_rates_max_rad_s))
    }
}
