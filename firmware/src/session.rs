//! The link's side of the board: bytes in; orders to the flight, and frames, out. Runs whenever nothing else does.

mod greeting;
mod orders;
mod parameters;
mod speaker;
mod uploads;

use heapless::Vec;
use quatrack::Tick;
use quatrack::link::{
    Admission, BLOB_BYTES_MAX, BlobReceiver, DELIMITER, Decoder, FRAME_BYTES, FaultReport, FromBoard, LoopStatistics,
    Message as _, Nonce, Refusal, Telemetry, ToBoard, UploadBegin,
};

use self::speaker::Speaker;
use crate::flight::Flight;
use crate::kept::Keep;
use crate::provisioned::Keys;
use crate::signature::Signatures;

/// Access to the flight, which the control interrupt shares.
pub trait Shared {
    /// Runs `access` while the control interrupt waits.
    fn with<R>(&mut self, access: impl FnOnce(&mut Flight) -> R) -> R;
}

/// Telemetry of the board itself, beside the flight.
pub trait Vitals {
    /// The tick of the loop.
    fn now(&self) -> Tick;
    /// Overruns, jitter, longest step, stack, dropped bytes; the steps are the flight's to count.
    fn statistics(&self) -> LoopStatistics;
    /// A number that it has not used before, nor will again; nothing where it has no source of them.
    fn nonce(&self) -> Option<Nonce>;
    /// Takes the ticks for one step.
    fn set_decimation(&self, decimation: u32);
}

/// Room for the blob that is being uploaded.
pub type Uploads = BlobReceiver<BLOB_BYTES_MAX>;

/// Frames of one connection after the other.
pub struct Session<K> {
    decoder: Decoder<ToBoard>,
    speaker: Speaker,
    uploads: &'static mut Uploads,
    kept: K,
    signatures: Signatures,
    telemetry_period_ticks: Tick,
    telemetry_at: Tick,
    /// Commits that did not put an upload to use.
    uploads_refused: u32,
    /// The blob put to use last: a commit may come twice, where its answer is lost.
    committed: Option<UploadBegin>,
    /// The blob kept last: the message may come again while the flash is being written.
    kept_last: Option<UploadBegin>,
    /// The fault that made the board restart, or was found since.
    fault: Option<FaultReport>,
    fault_told: bool,
}

/// The answers to a frame: an identity may bring a fault with it.
pub type Answers = Vec<FromBoard, 2>;

impl<K: Keep> Session<K> {
    /// Nobody connected; with the keys that the image was given, and the store of uploads.
    pub fn new(uploads: &'static mut Uploads, keys: Keys, kept: K, fault: Option<FaultReport>) -> Self {
        let Keys { link, signatures } = keys;
        let decoder = link.as_ref().map_or_else(Decoder::new, |(key, protection)| Decoder::keyed(key, *protection));
        Self {
            decoder,
            speaker: Speaker::new(link),
            uploads,
            kept,
            signatures,
            telemetry_period_ticks: 0,
            telemetry_at: 0,
            uploads_refused: 0,
            committed: None,
            kept_last: None,
            fault,
            fault_told: false,
        }
    }

    /// Takes a byte from the line; where it ends a sound frame, carries it out and gives the answers.
    pub fn push(&mut self, byte: u8, flight: &mut impl Shared, vitals: &impl Vitals) -> Option<Answers> {
        let now = vitals.now();
        if byte == DELIMITER {
            self.decoder.admit(flight.with(|flight| admission(flight, now)));
        }
        let received = match self.decoder.push(byte)? {
            Ok(received) => received,
            Err(rejected) => {
                let mut answers = Answers::new();
                // There is room for two.
                let _ = answers.push(self.speaker.turned_away(rejected)?);
                return Some(answers);
            }
        };
        // With a key a hello alone opens no session, and is no sign of life: it may be one that was recorded.
        if !(self.speaker.has_key() && received.message.opens_session()) {
            flight.with(|flight| flight.hear(now));
            if self.speaker.goes_over_to(received.session) {
                self.fault_told = false;
            }
        }
        let mut answers = Answers::new();
        let first = match received.message {
            ToBoard::Hello(nonce) => self.greet(&received, nonce, flight, vitals, &mut answers),
            ToBoard::State(state) => {
                flight.with(|flight| flight.accept(state, now));
                None
            }
            ToBoard::StateAndReference(state, sample) => {
                flight.with(|flight| {
                    flight.playback.follow(sample);
                    flight.accept(state, now);
                });
                None
            }
            ToBoard::RigidState(state) => {
                flight.with(|flight| flight.accept_rigid(state, now));
                None
            }
            ToBoard::TelemetryRequest => Some(self.telemetry(flight, vitals)),
            ToBoard::GetParameter(id) => Some(FromBoard::Parameter(self.parameter(id, flight))),
            ToBoard::SetParameter(parameter) => {
                let set = self.set(parameter, flight, vitals);
                Some(answer(
                    received.sequence,
                    set.map(|()| FromBoard::Parameter(self.parameter(parameter.id(), flight))),
                ))
            }
            _ => {
                let sequence = received.sequence;
                let done = self.carry_out(received, flight, now);
                Some(answer(sequence, done.map(|done| done.unwrap_or(FromBoard::Ack { sequence }))))
            }
        };
        if let Some(first) = first {
            // There is room for two.
            let _ = answers.push(first);
        }
        Some(answers)
    }

    /// A message that is due by itself: telemetry at its period, a fault once.
    pub fn unasked(&mut self, flight: &mut impl Shared, vitals: &impl Vitals) -> Option<FromBoard> {
        self.speaker.is_open().then_some(())?;
        if let Some(fault) = self.fault.filter(|_| !self.fault_told) {
            self.fault_told = true;
            return Some(FromBoard::Fault(fault));
        }
        let period = self.telemetry_period_ticks;
        if period == 0 || vitals.now().wrapping_sub(self.telemetry_at) < period {
            return None;
        }
        self.telemetry_at = vitals.now();
        Some(self.telemetry(flight, vitals))
    }

    /// Takes a fault that was found while running.
    pub fn report(&mut self, fault: FaultReport) {
        if self.fault.is_none() {
            self.fault = Some(fault);
        }
    }

    /// A message as a frame of the open session, or of the one that is being opened; nothing before the first hello.
    pub fn frame<'b>(&mut self, message: &FromBoard, buffer: &'b mut [u8; FRAME_BYTES]) -> Option<&'b [u8]> {
        self.speaker.frame(message, buffer)
    }

    fn telemetry(&self, flight: &mut impl Shared, vitals: &impl Vitals) -> FromBoard {
        let (mode, (steps, steps_failed)) = flight.with(|flight| (flight.mode(), flight.steps()));
        let statistics = LoopStatistics { steps, steps_failed, ..vitals.statistics() };
        FromBoard::Telemetry(Telemetry { tick: vitals.now(), mode, statistics, link: *self.decoder.counters() })
    }
}

/// An armed craft stays with its host until that host has been silent for too long.
fn admission(flight: &Flight, now: Tick) -> Admission {
    if flight.is_link_silent(now) {
        Admission::Anybody
    } else if flight.mode().motors_allowed() {
        Admission::Nobody
    } else {
        Admission::Later
    }
}

fn answer(sequence: u32, done: Result<FromBoard, Refusal>) -> FromBoard {
    done.unwrap_or_else(|reason| FromBoard::Nack { sequence, reason })
}

fn disarmed(flight: &mut impl Shared) -> Result<(), Refusal> {
    if flight.with(|flight| flight.mode().motors_allowed()) { Err(Refusal::NotWhileArmed) } else { Ok(()) }
}

#[cfg(test)]
mod tests;
