//! The link's side of the board: bytes in; orders to the flight, and frames, out. Runs whenever nothing else does.

use heapless::Vec;
use quatrack::Tick;
use quatrack::gains::table::{GainTable, LoadError};
use quatrack::link::{
    Admission, BLOB_BYTES_MAX, BlobError, BlobKind, BlobReceiver, DELIMITER, Decoder, Encoder, FRAME_BYTES,
    FaultReport, FromBoard, Identity, LoopStatistics, Parameter, ParameterId, Received, Refusal, TRAJECTORY_PIECES,
    Telemetry, ToBoard, TrajectoryCommand, TrajectoryId, UploadBegin, Version,
};

use crate::drivers::battery::CellVoltage;
use crate::flight::{Flight, TICK_RATE_HZ};
use crate::laws::Refused;
use crate::stored;
use crate::vehicle::VEHICLE;

/// Identifies what computes commands: a checksum of its sources, by the build script.
const CONTROL_IMAGE: u32 = include!(concat!(env!("OUT_DIR"), "/control_image.rs"));

/// Longest decimation: one step a second.
const DECIMATION_MAX: u32 = TICK_RATE_HZ;

/// Longest age and silence that can be set, ticks: ten seconds.
const AGE_MAX_TICKS: u32 = 10 * TICK_RATE_HZ;

/// Access to the flight, which the control interrupt shares.
pub trait Shared {
    /// Runs `access` while the control interrupt waits.
    fn with<R>(&mut self, access: impl FnOnce(&mut Flight) -> R) -> R;
}

/// What the board knows of itself beside the flight, for telemetry.
pub trait Vitals {
    /// The tick of the loop.
    fn now(&self) -> Tick;
    /// Overruns, jitter, longest step, stack, dropped bytes; the steps are the flight's to count.
    fn statistics(&self) -> LoopStatistics;
    /// Takes the ticks for one step.
    fn set_decimation(&self, decimation: u32);
}

/// Room for the blob that is being uploaded.
pub type Uploads = BlobReceiver<BLOB_BYTES_MAX>;

/// Frames of one connection after the other.
pub struct Session {
    decoder: Decoder<ToBoard>,
    encoder: Option<Encoder>,
    uploads: &'static mut Uploads,
    telemetry_period_ticks: Tick,
    telemetry_at: Tick,
    /// Commits that did not put an upload to use.
    uploads_refused: u32,
    /// The gain table put to use last: a commit may come twice, where its answer is lost.
    committed: Option<UploadBegin>,
    /// The fault that made the board restart, or was found since.
    fault: Option<FaultReport>,
    fault_told: bool,
}

/// What a frame is answered with: an identity may bring a fault with it.
pub type Answers = Vec<FromBoard, 2>;

impl Session {
    /// Nobody connected.
    pub const fn new(uploads: &'static mut Uploads, fault: Option<FaultReport>) -> Self {
        Self {
            decoder: Decoder::new(),
            encoder: None,
            uploads,
            telemetry_period_ticks: 0,
            telemetry_at: 0,
            uploads_refused: 0,
            committed: None,
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
        let received = self.decoder.push(byte)?.ok()?;
        flight.with(|flight| flight.hear(now));
        let mut answers = Answers::new();
        let first = match received.message {
            ToBoard::Hello => self.greet(received.session, flight, &mut answers),
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
        self.encoder.as_ref()?;
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

    /// A message as a frame of the open session; nothing before the first hello.
    pub fn frame<'b>(&mut self, message: &FromBoard, buffer: &'b mut [u8; FRAME_BYTES]) -> Option<&'b [u8]> {
        self.encoder.as_mut()?.encode(message, buffer).ok()
    }

    fn greet(&mut self, session: u32, flight: &mut impl Shared, answers: &mut Answers) -> Option<FromBoard> {
        if self.encoder.as_ref().is_none_or(|encoder| encoder.session() != session) {
            self.encoder = Some(Encoder::new(session));
        }
        let identity = Identity {
            firmware: version(),
            control_image: CONTROL_IMAGE,
            tick_rate_hz: TICK_RATE_HZ,
            decimation: flight.with(|flight| flight.decimation()),
            trajectory_pieces: TRAJECTORY_PIECES as u32,
        };
        // There is room for two.
        let _ = answers.push(FromBoard::Hello(identity));
        self.fault_told = true;
        self.fault.map(FromBoard::Fault)
    }

    fn carry_out(
        &mut self,
        received: Received<ToBoard>,
        flight: &mut impl Shared,
        now: Tick,
    ) -> Result<Option<FromBoard>, Refusal> {
        match received.message {
            ToBoard::SelectLaw(law) => flight.with(|flight| flight.select(law)).map(|()| None).map_err(Refusal::from),
            ToBoard::Trajectory(command) => trajectory(command, flight).map(|()| None),
            ToBoard::Arm => flight.with(|flight| flight.arm(now)).map(|()| None).map_err(Refusal::Arm),
            ToBoard::Disarm => {
                flight.with(Flight::disarm);
                Ok(None)
            }
            ToBoard::UploadBegin(begin) => {
                self.uploads.begin(&begin).map(|progress| Some(FromBoard::Upload(progress))).map_err(Refusal::Upload)
            }
            ToBoard::UploadChunk(chunk) => {
                self.uploads.chunk(&chunk).map(|progress| Some(FromBoard::Upload(progress))).map_err(Refusal::Upload)
            }
            ToBoard::UploadQuery => {
                self.uploads.progress().map(|progress| Some(FromBoard::Upload(progress))).map_err(Refusal::Upload)
            }
            ToBoard::UploadCommit { id } => {
                let committed = self.commit(id, flight);
                if committed.is_err() {
                    self.uploads_refused = self.uploads_refused.saturating_add(1);
                }
                committed.map(|()| None)
            }
            _ => Err(Refusal::Unsupported),
        }
    }

    /// Checks the uploaded blob and puts it to use.
    fn commit(&mut self, id: u32, flight: &mut impl Shared) -> Result<(), Refusal> {
        let (begin, blob) = self.uploads.finish(id).map_err(Refusal::Upload)?;
        if self.committed == Some(begin) {
            return Ok(());
        }
        match begin.kind {
            BlobKind::Trajectory => {
                // Checking pieces takes longer than a tick, and must not change what is being flown.
                disarmed(flight)?;
                flight.with(|flight| flight.playback.store().commit(blob)).map_err(Refusal::Blob)
            }
            BlobKind::GainTable => {
                // Read while the loop goes on; it waits only for the copy.
                let rate = flight.with(|flight| flight.table_rate()).ok_or(Refusal::NoTable)?;
                let refused = |error: LoadError| Refusal::Blob(error.into());
                let table = GainTable::from_bytes(blob).map_err(|error| refused(error.into()))?;
                let accepted = table.accept_for(&VEHICLE, rate).map_err(|error| refused(error.into()))?;
                flight.with(|flight| flight.load(&accepted)).map_err(Refusal::from)?;
                self.committed = Some(begin);
                Ok(())
            }
        }
    }

    fn parameter(&self, id: ParameterId, flight: &mut impl Shared) -> Parameter {
        flight.with(|flight| match id {
            ParameterId::Decimation => Parameter::Decimation(flight.decimation()),
            ParameterId::Limits => Parameter::Limits(flight.limits()),
            ParameterId::StateAgeMaxTicks => Parameter::StateAgeMaxTicks(flight.config.state_age_max_ticks),
            ParameterId::LinkSilenceMaxTicks => Parameter::LinkSilenceMaxTicks(flight.config.link_silence_max_ticks),
            ParameterId::OverrunsTolerated => Parameter::OverrunsTolerated(flight.config.overruns_tolerated),
            ParameterId::TelemetryPeriodTicks => Parameter::TelemetryPeriodTicks(self.telemetry_period_ticks),
            ParameterId::UploadsRefused => Parameter::UploadsRefused(self.uploads_refused),
            ParameterId::BatteryVoltage => Parameter::BatteryVoltage(flight.motors.battery().volts()),
            ParameterId::BodyRateBandwidth => Parameter::BodyRateBandwidth(flight.bandwidth_rad_s()),
        })
    }

    fn set(&mut self, parameter: Parameter, flight: &mut impl Shared, vitals: &impl Vitals) -> Result<(), Refusal> {
        if !matches!(parameter, Parameter::TelemetryPeriodTicks(_) | Parameter::BatteryVoltage(_)) {
            disarmed(flight)?;
        }
        let within = |value: u32, max: u32| if value <= max { Ok(value) } else { Err(Refusal::OutOfRange) };
        match parameter {
            Parameter::Decimation(ticks) => {
                let decimation = within(ticks, DECIMATION_MAX)?;
                flight.with(|flight| flight.set_decimation(decimation));
                self.committed = None;
                vitals.set_decimation(decimation);
            }
            Parameter::Limits(limits) => {
                flight.with(|flight| flight.set_limits(limits)).map_err(Refusal::Limits)?;
            }
            Parameter::StateAgeMaxTicks(ticks) => {
                let ticks = within(ticks, AGE_MAX_TICKS)?;
                flight.with(|flight| flight.config.state_age_max_ticks = ticks);
            }
            Parameter::LinkSilenceMaxTicks(ticks) => {
                let ticks = within(ticks, AGE_MAX_TICKS)?;
                flight.with(|flight| flight.config.link_silence_max_ticks = ticks);
            }
            Parameter::OverrunsTolerated(count) => {
                flight.with(|flight| flight.config.overruns_tolerated = count);
            }
            Parameter::TelemetryPeriodTicks(ticks) => self.telemetry_period_ticks = ticks,
            Parameter::UploadsRefused(_) => return Err(Refusal::ReadOnly),
            Parameter::BatteryVoltage(voltage_v) => {
                let battery = CellVoltage::new(voltage_v).map_err(|_| Refusal::OutOfRange)?;
                flight.with(|flight| flight.motors.set_battery(battery));
            }
            Parameter::BodyRateBandwidth(bandwidth_rad_s) => {
                let set = flight.with(|flight| flight.set_bandwidth(bandwidth_rad_s));
                set.map_err(|_| Refusal::OutOfRange)?;
            }
        }
        Ok(())
    }

    fn telemetry(&self, flight: &mut impl Shared, vitals: &impl Vitals) -> FromBoard {
        let (mode, (steps, steps_failed)) = flight.with(|flight| (flight.mode(), flight.steps()));
        let statistics = LoopStatistics { steps, steps_failed, ..vitals.statistics() };
        FromBoard::Telemetry(Telemetry { tick: vitals.now(), mode, statistics, link: *self.decoder.counters() })
    }
}

impl From<Refused> for Refusal {
    fn from(refused: Refused) -> Self {
        match refused {
            Refused::NoTable => Self::NoTable,
            Refused::Busy => Self::LawChanging,
            Refused::Accept(error) => Self::Blob(BlobError::GainTable(error.into())),
        }
    }
}

/// Who is flown keeps who flies it, until that one has been silent for too long.
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

fn trajectory(command: TrajectoryCommand, flight: &mut impl Shared) -> Result<(), Refusal> {
    let found = match command {
        TrajectoryCommand::Start(TrajectoryId::Uploaded) => flight.with(|flight| flight.playback.start_uploaded()),
        TrajectoryCommand::Start(id) => {
            // Checked here, where only the link waits for it.
            let player = stored::player(id).ok_or(Refusal::NoTrajectory)?;
            flight.with(|flight| flight.playback.start(player));
            true
        }
        TrajectoryCommand::Pause => flight.with(|flight| flight.playback.pause()),
        TrajectoryCommand::Resume => flight.with(|flight| flight.playback.resume()),
        TrajectoryCommand::Stop => {
            flight.with(|flight| flight.playback.stop());
            true
        }
    };
    if found { Ok(()) } else { Err(Refusal::NoTrajectory) }
}

/// The package's version.
fn version() -> Version {
    let number = |text: &str| {
        text.bytes().fold(0_u16, |sum, digit| sum.wrapping_mul(10).wrapping_add(u16::from(digit.wrapping_sub(b'0'))))
    };
    Version {
        major: number(env!("CARGO_PKG_VERSION_MAJOR")),
        minor: number(env!("CARGO_PKG_VERSION_MINOR")),
        patch: number(env!("CARGO_PKG_VERSION_PATCH")),
    }
}

#[cfg(test)]
mod tests {
    use quatrack::State;
    use quatrack::link::StateIn;
    use quatrack::nalgebra::Vector3;
    use quatrack::supervisor::Mode;

    use super::*;
    use crate::flight::{CONFIG, Flight};

    struct Here(Flight);

    impl Shared for Here {
        fn with<R>(&mut self, access: impl FnOnce(&mut Flight) -> R) -> R {
            access(&mut self.0)
        }
    }

    struct At(Tick);

    impl Vitals for At {
        fn now(&self) -> Tick {
            self.0
        }

        fn statistics(&self) -> LoopStatistics {
            LoopStatistics::default()
        }

        fn set_decimation(&self, _decimation: u32) {}
    }

    struct Board {
        flight: Here,
        session: Session,
        now: Tick,
    }

    impl Board {
        fn new() -> Self {
            let flight = Flight::new(Box::leak(Box::default()), None);
            let session = Session::new(Box::leak(Box::new(Uploads::new())), None);
            Self { flight: Here(flight), session, now: 0 }
        }

        /// Whether somebody's message was taken.
        fn hears(&mut self, from: &mut Encoder, message: &ToBoard) -> bool {
            let mut buffer = [0; FRAME_BYTES];
            let frame = from.encode(message, &mut buffer).unwrap().to_vec();
            let at = At(self.now);
            frame.iter().any(|byte| self.session.push(*byte, &mut self.flight, &at).is_some())
        }

        /// Armed by a pilot.
        fn armed() -> (Self, Encoder) {
            let (mut board, mut pilot) = (Self::new(), Encoder::new(1000));
            let state = StateIn { tick: 0, state: State::at_rest(Vector3::new(0.0, 0.0, 0.0)) };
            for message in [ToBoard::Hello, ToBoard::State(state), ToBoard::Arm] {
                assert!(board.hears(&mut pilot, &message));
            }
            assert_eq!(board.flight.0.mode(), Mode::Armed);
            (board, pilot)
        }
    }

    #[test]
    fn nobody_takes_over_an_armed_craft_but_the_pilot_goes_on() {
        let (mut board, mut pilot) = Board::armed();
        for number in [1001, 2000, 999, u32::MAX] {
            let mut thief = Encoder::new(number);
            assert!(!board.hears(&mut thief, &ToBoard::Hello) && !board.hears(&mut thief, &ToBoard::Disarm));
        }
        assert_eq!(board.flight.0.mode(), Mode::Armed);
        assert!(board.hears(&mut pilot, &ToBoard::Disarm));
        assert!(board.hears(&mut Encoder::new(1001), &ToBoard::Hello), "a later session, on the ground");
        assert!(!board.hears(&mut Encoder::new(999), &ToBoard::Hello), "an earlier one has been replayed");
    }

    #[test]
    fn after_silence_a_hello_is_taken_whatever_its_number() {
        for number in [0, 999, 1001, 1000_u32.wrapping_sub(1 << 31)] {
            let (mut board, _) = Board::armed();
            board.now = CONFIG.link_silence_max_ticks;
            assert!(!board.hears(&mut Encoder::new(number), &ToBoard::Hello), "not yet");
            board.now += 1;
            assert!(board.hears(&mut Encoder::new(number), &ToBoard::Hello));
        }
    }

    #[test]
    fn a_frame_is_not_taken_twice() {
        let (mut board, mut pilot) = Board::armed();
        let mut buffer = [0; FRAME_BYTES];
        let frame = pilot.encode(&ToBoard::Disarm, &mut buffer).unwrap().to_vec();
        let at = At(0);
        let hear =
            |board: &mut Board| frame.iter().any(|byte| board.session.push(*byte, &mut board.flight, &at).is_some());
        assert!(hear(&mut board) && !hear(&mut board));
    }
}
