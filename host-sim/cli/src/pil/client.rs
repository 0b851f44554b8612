//! A board behind its line: requests and states in; answers and commands out, or why there are none.

mod connection;

use std::time::{Duration, Instant};

use quatrack::link::{
    CommandOut, FRAME_BYTES, FaultReport, ForcesOut, FromBoard, HostSession, Identity, Key, Parameter, RigidStateIn,
    StateIn, Telemetry, ToBoard,
};
use quatrack::{RigidState, State};

use super::PilError;
use super::emulator::Emulator;
use super::interrupt::Interrupt;
use super::line::Line;

/// Longest wait for an answer.
const PATIENCE: Duration = Duration::from_secs(4);

/// After this time a message is sent again: it, or its answer, may have been lost.
const AGAIN: Duration = Duration::from_millis(300);

/// Between two looks at whether the emulator still runs.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// A connected board.
pub struct Client {
    line: Line,
    emulator: Option<Emulator>,
    interrupt: Interrupt,
    session: HostSession,
    key: Option<Key>,
    received: Vec<u8>,
    identity: Identity,
    fault: Option<FaultReport>,
}

impl Client {
    /// The identity of the board that answered.
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// Sends a request that is answered by an acknowledgement.
    ///
    /// # Errors
    /// [`PilError::Refused`] with the board's reason.
    pub fn request(&mut self, message: &ToBoard) -> Result<(), PilError> {
        let waiting_for = format!("the board does not answer {message:?}");
        let result = self.exchange(message, &waiting_for, |answer, sequence| match answer {
            FromBoard::Ack { sequence: of } if *of >= sequence => Some(Ok(())),
            FromBoard::Nack { sequence: of, reason } if *of >= sequence => Some(Err(*reason)),
            _ => None,
        })?;
        result.map_err(|reason| PilError::Refused { request: format!("{message:?}"), reason: reason.to_string() })
    }

    /// Sets a parameter.
    ///
    /// # Errors
    /// [`PilError::Refused`] where the board does not put it in force.
    pub fn set(&mut self, parameter: Parameter) -> Result<(), PilError> {
        let message = ToBoard::SetParameter(parameter);
        let result =
            self.exchange(&message, "the board does not answer a parameter", |answer, sequence| match answer {
                FromBoard::Parameter(in_force) if *in_force == parameter => Some(Ok(())),
                FromBoard::Nack { sequence: of, reason } if *of >= sequence => Some(Err(*reason)),
                _ => None,
            })?;
        result.map_err(|reason| PilError::Refused { request: format!("{parameter:?}"), reason: reason.to_string() })
    }

    /// Counters of the loop.
    ///
    /// # Errors
    /// [`PilError`].
    pub fn telemetry(&mut self) -> Result<Telemetry, PilError> {
        self.exchange(&ToBoard::TelemetryRequest, "the board sends no telemetry", |answer, _| match answer {
            FromBoard::Telemetry(telemetry) => Some(*telemetry),
            _ => None,
        })
    }

    /// Sends a request and waits for its answer, of any kind. A late answer to an earlier request that was sent twice is none.
    ///
    /// # Errors
    /// [`PilError`].
    pub fn ask(&mut self, message: &ToBoard) -> Result<FromBoard, PilError> {
        let uploads = matches!(message, ToBoard::UploadBegin(_) | ToBoard::UploadChunk(_) | ToBoard::UploadQuery);
        self.exchange(message, "the board does not answer", |answer, first| match answer {
            FromBoard::Fault(_) | FromBoard::Telemetry(_) => None,
            FromBoard::Ack { sequence } | FromBoard::Nack { sequence, .. } if *sequence < first => None,
            FromBoard::Upload(_) if !uploads => None,
            answer => Some(*answer),
        })
    }

    /// Sends bytes that are no frame, as a bad line would.
    ///
    /// # Errors
    /// [`PilError`].
    pub fn noise(&mut self, bytes: &[u8]) -> Result<(), PilError> {
        self.line.send(bytes)?;
        self.line.send(&[quatrack::link::DELIMITER])
    }

    /// Sends a state and waits for the command that answers it.
    ///
    /// # Errors
    /// [`PilError`].
    pub fn step(&mut self, tick: u32, state: &State) -> Result<CommandOut, PilError> {
        let message = ToBoard::State(StateIn { tick, state: *state });
        self.exchange(&message, "the board does not answer a state", |answer, _| match answer {
            FromBoard::Command(command) if command.state_tick == tick => Some(*command),
            _ => None,
        })
    }

    /// Sends a state with body rates and waits for the motor forces that answer it.
    ///
    /// # Errors
    /// [`PilError`].
    pub fn step_rigid(&mut self, tick: u32, state: &RigidState) -> Result<ForcesOut, PilError> {
        let message = ToBoard::RigidState(RigidStateIn { tick, state: *state });
        self.exchange(&message, "the board does not answer a state with body rates", |answer, _| match answer {
            FromBoard::Forces(forces) if forces.state_tick == tick => Some(*forces),
            _ => None,
        })
    }

    /// Sends `message`, again where no answer comes, until `pick` takes an answer; it is given the sequence number of
    /// the first sending.
    fn exchange<T>(
        &mut self,
        message: &ToBoard,
        waiting_for: &str,
        pick: impl Fn(&FromBoard, u32) -> Option<T>,
    ) -> Result<T, PilError> {
        let sequence = self.session.next_sequence().unwrap_or_default();
        let start = Instant::now();
        let mut sent_at = start;
        self.send(message)?;
        let mut chunk = [0; 256];
        loop {
            while let Some((received, rest)) = self.session.next(&self.received) {
                let left = rest.len();
                self.received.drain(..self.received.len() - left);
                if let FromBoard::Fault(fault) = received.message {
                    self.fault = Some(fault);
                }
                if let Some(found) = pick(&received.message, sequence) {
                    return Ok(found);
                }
            }
            self.received.clear();
            let count = self.line.receive(&mut chunk, LOOK_EVERY)?;
            self.received.extend_from_slice(chunk.get(..count).unwrap_or_default());
            if count > 0 {
                continue;
            }
            self.interrupt.check()?;
            if let Some(emulator) = &mut self.emulator
                && let Some(status) = emulator.ended()?
            {
                return Err(emulator.ended_early(status));
            }
            if start.elapsed() > PATIENCE {
                return Err(self.silent(waiting_for));
            }
            if sent_at.elapsed() > AGAIN {
                sent_at = Instant::now();
                self.send(message)?;
            }
        }
    }

    fn silent(&self, waiting_for: &str) -> PilError {
        let rejected = self.session.counters().rejected();
        let heard = match (self.fault, rejected) {
            _ if self.session.counters().unauthentic > 0 => {
                format!("{waiting_for} with this key; it has another one, or none, or no random numbers to use it with")
            }
            (Some(fault), _) => format!("{waiting_for}; it has reported a {} at {:#010x}", fault.fault, fault.address),
            (None, 0) => format!("{waiting_for}; check the line, and that the image is quatrack's"),
            (None, _) => format!("{waiting_for}; {rejected} frames came that were none of this protocol version"),
        };
        PilError::Silent { seconds: PATIENCE.as_secs(), waiting_for: heard }
    }

    fn send(&mut self, message: &ToBoard) -> Result<(), PilError> {
        let mut buffer = [0; FRAME_BYTES];
        let frame = self.session.encode(message, &mut buffer).map_err(|error| PilError::Answer(error.to_string()))?;
        self.line.send(frame)
    }
}
