//! The bytes of one frame of every kind, as this version of the protocol has them. A row that changes changes the protocol: it
//! takes a new version, or boards and hosts of different releases misread each other.

use std::fmt::Write;

use quatrack::gain::GainError;
use quatrack::gains::table::{AcceptError, Name, TableError, Vehicle};
use quatrack::link::*;
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::{ArmError, Fault, Mode, Reason};
use quatrack::trajectory::TrajectoryError;
use quatrack::{
    Command, ErrorForm, FeedForward, FlatSample, Limited, MotorLimited, MotorStep, Quaternion, RigidState, State,
    StateError, Step, StepError,
};

fn state_in() -> StateIn {
    let state = State {
        position_m: Vector3::new(1.0, 2.0, 3.0),
        attitude: Quaternion::new(0.5, -0.5, 0.5, -0.5),
        velocity_m_s: Vector3::new(4.0, 5.0, 6.0),
    };
    StateIn { tick: 300, state }
}

fn to_board() -> Vec<ToBoard> {
    let reference = FlatSample {
        position_m: Vector3::new(1.0, 2.0, 3.0),
        velocity_m_s: Vector3::new(4.0, 5.0, 6.0),
        acceleration_m_s2: Vector3::new(7.0, 8.0, 9.0),
        jerk_m_s3: Vector3::new(10.0, 11.0, 12.0),
        heading_rad: 0.25,
        heading_rate_rad_s: -0.25,
    };
    let limits = LimitsSetting { thrust_min_m_s2: 1.0, thrust_max_m_s2: 16.0, body_rates_max_rad_s: [20.0, 20.0, 5.0] };
    vec![
        ToBoard::Hello(Nonce(core::array::from_fn(|i| i as u8))),
        ToBoard::State(state_in()),
        ToBoard::StateAndReference(state_in(), reference),
        ToBoard::SelectLaw(LawChoice {
            table: Table::Loaded(9),
            feed_forward: FeedForward::With,
            error_form: ErrorForm::Paper,
        }),
        ToBoard::Trajectory(TrajectoryCommand::Start(TrajectoryId::Uploaded)),
        ToBoard::Trajectory(TrajectoryCommand::Stop),
        ToBoard::Arm,
        ToBoard::Disarm,
        ToBoard::GetParameter(ParameterId::TelemetryPeriodTicks),
        ToBoard::SetParameter(Parameter::Limits(limits)),
        ToBoard::SetParameter(Parameter::TelemetryPeriodTicks(100)),
        ToBoard::UploadBegin(UploadBegin { kind: BlobKind::GainTable, id: 1, length: 300, checksum: 0x0102_0304 }),
        ToBoard::UploadChunk(Chunk::new(1, 96, &[0, 1, 2]).unwrap()),
        ToBoard::UploadQuery,
        ToBoard::UploadCommit { id: 1 },
        ToBoard::TelemetryRequest,
        ToBoard::RigidState(RigidStateIn {
            tick: 300,
            state: RigidState { state: state_in().state, body_rates_rad_s: Vector3::new(7.0, 8.0, 9.0) },
        }),
        ToBoard::UploadKeep { id: 1 },
        ToBoard::SelectLaw(LawChoice::new(Table::Cascade)),
        ToBoard::SetParameter(Parameter::BatteryVoltage(3.75)),
        ToBoard::SetParameter(Parameter::BodyRateBandwidth([25.0, 25.0, 10.0])),
        ToBoard::SetParameter(Parameter::Leash(1.0)),
    ]
}

fn from_board() -> Vec<FromBoard> {
    let step = Step {
        command: Command { thrust_m_s2: 9.81, body_rates_rad_s: Vector3::new(1.0, 2.0, 3.0) },
        limited: Limited::from_bits(0b0101),
    };
    let refused = NoCommand::Step(StepError::State(StateError::QuaternionNorm { norm_squared: 2.0 }));
    let statistics = LoopStatistics {
        steps: 1,
        steps_failed: 2,
        overruns: 3,
        worst_step_ns: 4,
        jitter_ns: 5,
        stack_bytes: 6,
        bytes_dropped: 7,
    };
    let link = Counters {
        accepted: 1,
        truncated: 2,
        overlong: 3,
        checksum: 4,
        version: 5,
        unknown: 6,
        malformed: 7,
        foreign_session: 8,
        duplicate: 9,
        stale: 10,
        unauthentic: 12,
        lost: 11,
    };
    let jump = Refusal::Blob(BlobError::Trajectory(TrajectoryError::Jump { piece: 3, size: 1.0 }));
    let column = TableError::Gain(GainError::UnusedError { column: 3 });
    let other = AcceptError::Vehicle { table: Vehicle { name: Name::literal("crazyflie-2.1"), id: 0x0102_0304 } };
    vec![
        FromBoard::Hello(Identity {
            firmware: Version { major: 0, minor: 1, patch: 2 },
            control_image: 0xC0DE,
            tick_rate_hz: 1000,
            decimation: 2,
            trajectory_pieces: 64,
            protection: Protection::Orders,
            signed_tables: true,
            nonce: Nonce(core::array::from_fn(|i| i as u8)),
        }),
        FromBoard::Command(CommandOut { tick: 7, state_tick: 300, result: Ok(step) }),
        FromBoard::Command(CommandOut { tick: 7, state_tick: 300, result: Err(refused) }),
        FromBoard::Command(CommandOut { tick: 7, state_tick: 300, result: Err(NoCommand::Mode(Mode::Armed)) }),
        FromBoard::Telemetry(Telemetry { tick: 7, mode: Mode::Stopped(Reason::StepFailed), statistics, link }),
        FromBoard::Ack { sequence: 5 },
        FromBoard::Nack { sequence: 5, reason: Refusal::Arm(ArmError::LinkSilent) },
        FromBoard::Nack { sequence: 5, reason: Refusal::Upload(UploadError::Checksum { announced: 1, found: 2 }) },
        FromBoard::Nack { sequence: 5, reason: jump },
        FromBoard::Nack { sequence: 5, reason: Refusal::Key },
        FromBoard::Nack { sequence: 5, reason: Refusal::NotKept },
        FromBoard::Nack { sequence: 5, reason: Refusal::Blob(BlobError::Unsigned) },
        FromBoard::Nack { sequence: 5, reason: Refusal::Blob(BlobError::GainTable(column.into())) },
        FromBoard::Nack { sequence: 5, reason: Refusal::Blob(BlobError::GainTable(other.into())) },
        FromBoard::Upload(Progress { id: 1, wanted_offset: 96, length: 300 }),
        FromBoard::Parameter(Parameter::Decimation(2)),
        FromBoard::Fault(FaultReport { fault: Fault::ClockStopped, tick: 7, address: 0x0800_0000 }),
        FromBoard::Forces(ForcesOut {
            tick: 7,
            state_tick: 300,
            result: Ok(MotorStep { forces_n: [0.0625, 0.125, 0.25, 0.5], limited: MotorLimited::from_bits(0x0123) }),
        }),
        FromBoard::Forces(ForcesOut { tick: 7, state_tick: 300, result: Err(NoCommand::NoBodyRates) }),
    ]
}

/// One line a message: its name and its frame, the first of session 1.
fn lines<M: Message + std::fmt::Debug>(messages: &[M]) -> String {
    let mut lines = String::new();
    for message in messages {
        let mut buffer = [0; FRAME_BYTES];
        let frame = Encoder::new(1).encode(message, &mut buffer).unwrap();
        let name = format!("{message:?}");
        let name = name.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
        let hex: String = frame.iter().map(|byte| format!("{byte:02x}")).collect();
        writeln!(lines, "{name} {hex}").unwrap();
    }
    lines
}

#[test]
fn frames_have_the_bytes_of_their_protocol_version() {
    assert_eq!(PROTOCOL_VERSION, 5, "a new version has frames of its own: write them down");
    insta::assert_snapshot!("to_board_version_5", lines(&to_board()));
    insta::assert_snapshot!("from_board_version_5", lines(&from_board()));
}
