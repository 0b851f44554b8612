//! Anything at all over the line: no panic, no force that is none, and no motor that turns without having been armed.

use proptest::prelude::*;
use quatrack::link::{
    BlobKind, Chunk, Encoder, FRAME_BYTES, LawChoice, LimitsSetting, LoopStatistics, Nonce, Parameter, ParameterId,
    RigidStateIn, StateIn, Table, ToBoard, TrajectoryCommand, TrajectoryId, UploadBegin,
};
use quatrack::nalgebra::Vector3;
use quatrack::{FlatSample, Quaternion, RigidState, State, Tick};
use quatrack_firmware::craft::BodyRates;
use quatrack_firmware::flight::Flight;
use quatrack_firmware::kept::NoFlash;
use quatrack_firmware::provisioned::Keys;
use quatrack_firmware::session::{Session, Shared, Uploads, Vitals};
use quatrack_firmware::vehicle::AIRFRAME;

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

    fn nonce(&self) -> Option<Nonce> {
        None
    }

    fn set_decimation(&self, _decimation: u32) {}
}

#[derive(Clone, Debug)]
enum Event {
    /// A message of one of a few hosts.
    Message(u8, ToBoard),
    /// Bytes that are none.
    Noise(Vec<u8>),
    /// Steps of the loop with these body rates.
    Steps(u8, Option<[f32; 3]>),
}

fn number() -> impl Strategy<Value = f32> {
    prop_oneof![20 => -1.0_f32..1.0, 1 => any::<f32>(), 1 => Just(f32::NAN)]
}

fn vector() -> impl Strategy<Value = Vector3<f32>> {
    [number(), number(), number()].prop_map(Vector3::from)
}

fn state() -> impl Strategy<Value = State> {
    (vector(), vector(), [number(), number(), number()]).prop_map(|(position_m, velocity_m_s, [x, y, z])| State {
        position_m,
        attitude: Quaternion::new(1.0, 0.1 * x, 0.1 * y, 0.1 * z),
        velocity_m_s,
    })
}

fn message() -> impl Strategy<Value = ToBoard> {
    let table =
        prop_oneof![Just(Table::LqrE), Just(Table::LyapF), Just(Table::Cascade), any::<u8>().prop_map(Table::Loaded)];
    let parameter = prop_oneof![
        (0..4_u32).prop_map(Parameter::Decimation),
        any::<u32>().prop_map(Parameter::StateAgeMaxTicks),
        any::<u32>().prop_map(Parameter::LinkSilenceMaxTicks),
        number().prop_map(|volts| Parameter::BatteryVoltage(3.0 + volts)),
        [number(), number()].prop_map(|[least, most]| {
            let body_rates_max_rad_s = [20.0, 20.0, 10.0];
            Parameter::Limits(LimitsSetting {
                thrust_min_m_s2: least,
                thrust_max_m_s2: 15.0 + most,
                body_rates_max_rad_s,
            })
        }),
        [number(), number(), number()].prop_map(Parameter::BodyRateBandwidth),
    ];
    let trajectory = prop_oneof![
        Just(TrajectoryCommand::Start(TrajectoryId::Mild)),
        Just(TrajectoryCommand::Start(TrajectoryId::Uploaded)),
        Just(TrajectoryCommand::Pause),
        Just(TrajectoryCommand::Stop)
    ];
    let chunk = (any::<u32>(), 0..4_u32, prop::collection::vec(any::<u8>(), 0..96))
        .prop_map(|(id, offset, bytes)| ToBoard::UploadChunk(Chunk::new(id, offset, &bytes).unwrap()));
    prop_oneof![
        4 => Just(ToBoard::Hello(Nonce::NONE)),
        4 => Just(ToBoard::Arm),
        1 => Just(ToBoard::Disarm),
        10 => (any::<u32>(), state()).prop_map(|(tick, state)| ToBoard::State(StateIn { tick, state })),
        20 => (any::<u32>(), state(), vector()).prop_map(|(tick, state, body_rates_rad_s)| {
            ToBoard::RigidState(RigidStateIn { tick, state: RigidState { state, body_rates_rad_s } })
        }),
        4 => (state(), vector(), number()).prop_map(|(state, position, heading)| {
            ToBoard::StateAndReference(StateIn { tick: 0, state }, FlatSample::at_rest(position, heading))
        }),
        2 => table.prop_map(|table| ToBoard::SelectLaw(LawChoice::new(table))),
        2 => parameter.prop_map(ToBoard::SetParameter),
        2 => trajectory.prop_map(ToBoard::Trajectory),
        1 => chunk,
        1 => any::<[u32; 3]>().prop_map(|[id, length, checksum]| {
            ToBoard::UploadBegin(UploadBegin { kind: BlobKind::GainTable, id, length: length % 4000, checksum })
        }),
        1 => any::<u32>().prop_map(|id| ToBoard::UploadCommit { id }),
        1 => Just(ToBoard::TelemetryRequest),
        1 => Just(ToBoard::GetParameter(ParameterId::Limits)),
    ]
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        10 => (0..3_u8, message()).prop_map(|(host, message)| Event::Message(host, message)),
        1 => prop::collection::vec(any::<u8>(), 0..200).prop_map(Event::Noise),
        6 => (1..60_u8, prop::option::of([number(), number(), number()])).prop_map(|(n, rates)| Event::Steps(n, rates)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn for_any_frames_forces_are_sound_and_motors_wait_for_an_arm(events in prop::collection::vec(event(), 1..150)) {
        let figures = *AIRFRAME.figures();
        let mut flight = Here(Flight::new(Box::leak(Box::default()), None));
        let mut session = Session::new(Box::leak(Box::new(Uploads::new())), Keys::NONE, NoFlash, None);
        let mut hosts = [Encoder::new(10), Encoder::new(11), Encoder::new(9)];
        let (mut now, mut asked) = (0, false);
        for event in events {
            let mut send = |bytes: &[u8], flight: &mut Here| {
                for byte in bytes {
                    let _ = session.push(*byte, flight, &At(now));
                }
            };
            match event {
                Event::Message(host, message) => {
                    asked |= message == ToBoard::Arm;
                    let mut buffer = [0; FRAME_BYTES];
                    let frame = hosts[usize::from(host)].encode(&message, &mut buffer).unwrap();
                    send(frame, &mut flight);
                }
                Event::Noise(bytes) => send(&bytes, &mut flight),
                Event::Steps(steps, rates) => for _ in 0..steps {
                    now += 2;
                    let rates = rates.map_or(BodyRates::NoGyroscope, |rates| BodyRates::Measured(rates.into()));
                    flight.0.step(now, false, rates);
                    let forces = *flight.0.forces_n();
                    let is_off = forces == [0.0; 4];
                    prop_assert!(is_off || (asked && flight.0.mode().is_in_air()), "{:?}", flight.0.mode());
                    for force in forces {
                        prop_assert!(is_off || (figures.force_min_n..=figures.force_max_n).contains(&force), "{force}");
                    }
                    prop_assert!(flight.0.command().is_finite());
                }
            }
        }
    }
}
