//! Every message of the link, with any numbers: floats by their bits, so that NaN and infinities are among them.

use proptest::prelude::*;
use proptest::{array, collection, sample};
use quatrack::command::LimitsError;
use quatrack::error::Field;
use quatrack::link::*;
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::{ArmError, Fault, Mode, Reason, Tumble};
use quatrack::trajectory::TrajectoryError;
use quatrack::{
    Command, ErrorForm, FeedForward, FlatSample, Limited, MotorLimited, MotorStep, Quaternion, ReferenceError,
    RigidState, State, StateError, Step, StepError,
};

fn float() -> impl Strategy<Value = f32> + Clone {
    any::<u32>().prop_map(f32::from_bits)
}

fn vector() -> impl Strategy<Value = Vector3<f32>> {
    array::uniform3(float()).prop_map(Vector3::from)
}

fn state_in() -> impl Strategy<Value = StateIn> {
    (any::<u32>(), vector(), array::uniform4(float()), vector()).prop_map(|(tick, r, [w, x, y, z], v)| StateIn {
        tick,
        state: State { position_m: r, attitude: Quaternion::new(w, x, y, z), velocity_m_s: v },
    })
}

fn rigid_state_in() -> impl Strategy<Value = RigidStateIn> {
    (state_in(), vector()).prop_map(|(StateIn { tick, state }, body_rates_rad_s)| RigidStateIn {
        tick,
        state: RigidState { state, body_rates_rad_s },
    })
}

fn flat_sample() -> impl Strategy<Value = FlatSample> {
    (vector(), vector(), vector(), vector(), float(), float()).prop_map(|(r, v, a, j, heading, rate)| FlatSample {
        position_m: r,
        velocity_m_s: v,
        acceleration_m_s2: a,
        jerk_m_s3: j,
        heading_rad: heading,
        heading_rate_rad_s: rate,
    })
}

fn law_choice() -> impl Strategy<Value = LawChoice> {
    let table = prop_oneof![
        sample::select(vec![Table::LyapE, Table::LqrE, Table::LyapF, Table::LqrF, Table::Cascade]),
        any::<u8>().prop_map(Table::Loaded)
    ];
    let feed_forward = sample::select(vec![FeedForward::Without, FeedForward::With]);
    let error_form = sample::select(vec![ErrorForm::HeadingFrame, ErrorForm::Paper]);
    (table, feed_forward, error_form).prop_map(|(table, feed_forward, error_form)| LawChoice {
        table,
        feed_forward,
        error_form,
    })
}

fn parameter() -> impl Strategy<Value = Parameter> {
    let limits = (float(), float(), array::uniform3(float())).prop_map(|(min, max, rates)| {
        Parameter::Limits(LimitsSetting { thrust_min_m_s2: min, thrust_max_m_s2: max, body_rates_max_rad_s: rates })
    });
    prop_oneof![
        limits,
        any::<u32>().prop_map(Parameter::Decimation),
        any::<u32>().prop_map(Parameter::StateAgeMaxTicks),
        any::<u32>().prop_map(Parameter::LinkSilenceMaxTicks),
        any::<u32>().prop_map(Parameter::OverrunsTolerated),
        any::<u32>().prop_map(Parameter::TelemetryPeriodTicks),
        any::<u32>().prop_map(Parameter::UploadsRefused),
        float().prop_map(Parameter::BatteryVoltage),
        array::uniform3(float()).prop_map(Parameter::BodyRateBandwidth),
    ]
}

fn trajectory_command() -> impl Strategy<Value = TrajectoryCommand> {
    sample::select(vec![
        TrajectoryCommand::Start(TrajectoryId::Mild),
        TrajectoryCommand::Start(TrajectoryId::Aggressive),
        TrajectoryCommand::Start(TrajectoryId::Uploaded),
        TrajectoryCommand::Pause,
        TrajectoryCommand::Resume,
        TrajectoryCommand::Stop,
    ])
}

fn blob_kind() -> impl Strategy<Value = BlobKind> {
    sample::select(vec![BlobKind::Trajectory, BlobKind::GainTable])
}

/// Any message to the board but the hello, which has a meaning to the decoder.
pub(crate) fn to_board() -> impl Strategy<Value = ToBoard> {
    let begin = (blob_kind(), any::<u32>(), any::<u32>(), any::<u32>())
        .prop_map(|(kind, id, length, checksum)| UploadBegin { kind, id, length, checksum });
    let chunk = (any::<u32>(), any::<u32>(), collection::vec(any::<u8>(), 0..=CHUNK_BYTES))
        .prop_map(|(id, offset, bytes)| Chunk::new(id, offset, &bytes).unwrap());
    prop_oneof![
        state_in().prop_map(ToBoard::State),
        (state_in(), flat_sample()).prop_map(|(state, reference)| ToBoard::StateAndReference(state, reference)),
        law_choice().prop_map(ToBoard::SelectLaw),
        trajectory_command().prop_map(ToBoard::Trajectory),
        Just(ToBoard::Arm),
        Just(ToBoard::Disarm),
        parameter().prop_map(|parameter| ToBoard::GetParameter(parameter.id())),
        parameter().prop_map(ToBoard::SetParameter),
        begin.prop_map(ToBoard::UploadBegin),
        chunk.prop_map(ToBoard::UploadChunk),
        Just(ToBoard::UploadQuery),
        any::<u32>().prop_map(|id| ToBoard::UploadCommit { id }),
        any::<u32>().prop_map(|id| ToBoard::UploadKeep { id }),
        Just(ToBoard::TelemetryRequest),
        rigid_state_in().prop_map(ToBoard::RigidState),
    ]
}

fn mode() -> impl Strategy<Value = Mode> {
    let reason = prop_oneof![
        fault().prop_map(Reason::Fault),
        sample::select(vec![
            Reason::Overrun,
            Reason::AttitudeLost,
            Reason::StepFailed,
            Reason::StateLost,
            Reason::LinkLost,
            Reason::BadReference,
            Reason::NoReference,
            Reason::NoGround,
        ])
    ];
    let tumble = sample::select(vec![Tumble::Tilted, Tumble::UpsideDown, Tumble::NoClimb]);
    prop_oneof![
        Just(Mode::OnGround),
        Just(Mode::Armed),
        Just(Mode::Flying),
        reason.clone().prop_map(Mode::Holding),
        reason.clone().prop_map(Mode::LevelAndDown),
        reason.prop_map(Mode::Stopped),
        tumble.prop_map(Mode::Tumbled)
    ]
}

fn fault() -> impl Strategy<Value = Fault> {
    sample::select(vec![Fault::HardFault, Fault::StackExhausted, Fault::ClockStopped])
}

fn field() -> impl Strategy<Value = Field> {
    sample::select(vec![
        Field::Position,
        Field::Attitude,
        Field::Velocity,
        Field::Acceleration,
        Field::Jerk,
        Field::Heading,
        Field::HeadingRate,
        Field::BodyRates,
        Field::SnapAndCrackle,
        Field::HeadingDerivatives,
    ])
}

fn no_command() -> impl Strategy<Value = NoCommand> {
    let state = prop_oneof![
        (field(), float()).prop_map(|(field, value)| StateError::NonFinite { field, value }),
        float().prop_map(|norm_squared| StateError::QuaternionNorm { norm_squared }),
    ];
    let reference = prop_oneof![
        (field(), float()).prop_map(|(field, value)| ReferenceError::NonFinite { field, value }),
        float().prop_map(|thrust_m_s2| ReferenceError::NoThrust { thrust_m_s2 }),
        float().prop_map(|axis_z| ReferenceError::Inverted { axis_z }),
        float().prop_map(|q3| ReferenceError::HeadingInfeasible { q3 }),
    ];
    prop_oneof![
        mode().prop_map(NoCommand::Mode),
        Just(NoCommand::NoReference),
        reference.prop_map(NoCommand::Reference),
        state.prop_map(|error| NoCommand::Step(StepError::State(error))),
        Just(NoCommand::Step(StepError::Singular)),
        Just(NoCommand::NoBodyRates),
    ]
}

fn step() -> impl Strategy<Value = Step> {
    (float(), vector(), any::<u8>()).prop_map(|(thrust_m_s2, rates, limited)| Step {
        command: Command { thrust_m_s2, body_rates_rad_s: rates },
        limited: Limited::from_bits(limited),
    })
}

fn motor_step() -> impl Strategy<Value = MotorStep> {
    (array::uniform4(float()), any::<u16>())
        .prop_map(|(forces_n, limited)| MotorStep { forces_n, limited: MotorLimited::from_bits(limited) })
}

fn refusal() -> impl Strategy<Value = Refusal> {
    let limits = prop_oneof![
        (float(), float()).prop_map(|(min_m_s2, max_m_s2)| LimitsError::Thrust { min_m_s2, max_m_s2 }),
        float().prop_map(|max_rad_s| LimitsError::BodyRate { max_rad_s }),
    ];
    let upload = (any::<u32>(), any::<u32>()).prop_flat_map(|(a, b)| {
        sample::select(vec![
            UploadError::NotBegun,
            UploadError::OtherBlob { announced: a },
            UploadError::Length { length: a, capacity: b },
            UploadError::Offset { wanted: a },
            UploadError::ChunkLength { wanted: a, length: b },
            UploadError::Incomplete { wanted: a },
            UploadError::Checksum { announced: a, found: b },
        ])
    });
    let trajectory = (any::<u32>(), float()).prop_flat_map(|(piece, size)| {
        let piece = piece as usize;
        sample::select(vec![
            TrajectoryError::Empty,
            TrajectoryError::NoDuration { piece },
            TrajectoryError::TooLong { piece },
            TrajectoryError::NonFinite { piece },
            TrajectoryError::Jump { piece, size },
        ])
    });
    let blob = prop_oneof![
        blob_kind().prop_map(BlobError::Kind),
        (any::<u32>(), any::<u32>()).prop_map(|(pieces, capacity)| BlobError::TooManyPieces { pieces, capacity }),
        any::<u32>().prop_map(|piece| BlobError::Malformed { piece }),
        any::<u32>().prop_map(|bytes| BlobError::BytesLeft { bytes }),
        trajectory.prop_map(BlobError::Trajectory),
    ];
    prop_oneof![
        sample::select(vec![
            Refusal::Unsupported,
            Refusal::NotWhileArmed,
            Refusal::ReadOnly,
            Refusal::NoTable,
            Refusal::LawChanging,
            Refusal::OutOfRange,
            Refusal::NoTrajectory,
            Refusal::Arm(ArmError::LinkSilent),
            Refusal::Arm(ArmError::NotCertified),
        ]),
        any::<u32>().prop_map(|ticks| Refusal::Arm(ArmError::Tolerance { ticks })),
        fault().prop_map(|fault| Refusal::Arm(ArmError::Faulted(fault))),
        limits.prop_map(Refusal::Limits),
        upload.prop_map(Refusal::Upload),
        blob.prop_map(Refusal::Blob),
    ]
}

fn telemetry() -> impl Strategy<Value = Telemetry> {
    (any::<u32>(), mode(), any::<[u32; 7]>(), any::<[u32; 12]>()).prop_map(|(tick, mode, s, c)| Telemetry {
        tick,
        mode,
        statistics: LoopStatistics {
            steps: s[0],
            steps_failed: s[1],
            overruns: s[2],
            worst_step_ns: s[3],
            jitter_ns: s[4],
            stack_bytes: s[5],
            bytes_dropped: s[6],
        },
        link: Counters {
            accepted: c[0],
            truncated: c[1],
            overlong: c[2],
            checksum: c[3],
            version: c[4],
            unknown: c[5],
            malformed: c[6],
            foreign_session: c[7],
            duplicate: c[8],
            stale: c[9],
            lost: c[10],
            unauthentic: c[11],
        },
    })
}

/// Any message from the board.
pub(crate) fn from_board() -> impl Strategy<Value = FromBoard> {
    let protection = sample::select(vec![Protection::CableOnly, Protection::Orders, Protection::Everything]);
    let identity = (any::<[u16; 3]>(), any::<[u32; 4]>(), protection, any::<bool>(), any::<[u8; 16]>()).prop_map(
        |(
            [major, minor, patch],
            [control_image, tick_rate_hz, decimation, trajectory_pieces],
            protection,
            signed_tables,
            nonce,
        )| Identity {
            firmware: Version { major, minor, patch },
            control_image,
            tick_rate_hz,
            decimation,
            trajectory_pieces,
            protection,
            signed_tables,
            nonce: Nonce(nonce),
        },
    );
    let result = prop_oneof![step().prop_map(Ok), no_command().prop_map(Err)];
    let command = (any::<u32>(), any::<u32>(), result).prop_map(|(tick, state_tick, result)| CommandOut {
        tick,
        state_tick,
        result,
    });
    let result = prop_oneof![motor_step().prop_map(Ok), no_command().prop_map(Err)];
    let forces = (any::<u32>(), any::<u32>(), result).prop_map(|(tick, state_tick, result)| ForcesOut {
        tick,
        state_tick,
        result,
    });
    prop_oneof![
        identity.prop_map(FromBoard::Hello),
        command.prop_map(FromBoard::Command),
        forces.prop_map(FromBoard::Forces),
        telemetry().prop_map(FromBoard::Telemetry),
        any::<u32>().prop_map(|sequence| FromBoard::Ack { sequence }),
        (any::<u32>(), refusal()).prop_map(|(sequence, reason)| FromBoard::Nack { sequence, reason }),
        any::<[u32; 3]>()
            .prop_map(|[id, wanted_offset, length]| { FromBoard::Upload(Progress { id, wanted_offset, length }) }),
        parameter().prop_map(FromBoard::Parameter),
        (fault(), any::<u32>(), any::<u32>()).prop_map(|(fault, tick, address)| FromBoard::Fault(FaultReport {
            fault,
            tick,
            address
        })),
    ]
}
