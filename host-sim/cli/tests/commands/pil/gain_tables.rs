//! Gain tables over the link: uploaded, checked and swapped while the board flies.

use quatrack::gains::paper;
use quatrack::gains::table::{
    AcceptError, Certificate, GainTable, Hash, LoadError, Margins, Name, Rows, ScheduleRows, TABLE_BYTES_MAX,
    TableError, TableHead, Vehicle,
};
use quatrack::link::{
    BlobError, BlobKind, FromBoard, LawChoice, LimitsSetting, Parameter, ParameterId, Refusal, Table, ToBoard,
    TrajectoryCommand, TrajectoryId, UploadBegin,
};
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::Mode;
use quatrack::{
    Controller, Handover, Law, Limits, Measured, Memory, Output, Player, Progress, Rate, Settings, State, Step, Target,
    Trajectory,
};
use quatrack_cli::pil::client::Client;
use quatrack_plan::plan::paper::PaperTrajectory;
use quatrack_plan::plan::stored;

use super::emulated::connected;
use super::support::has_emulator;

/// The board's vehicle, by the figures of `gains/vehicles/crazyflie-2.1.toml`.
const VEHICLE: Vehicle = Vehicle { name: Name::literal("crazyflie-2.1"), id: 0x8983_3c06 };

/// Steps from one law to another, as the board takes them.
const FADE_STEPS: u16 = 50;

const TICK_HZ: u32 = 1000;
const TICKS_PER_STEP: u32 = 2;

fn rate() -> Rate {
    Rate::from_hz(500).unwrap()
}

fn limits() -> Limits {
    Limits::new(0.0, 16.5, Vector3::new(20.0, 20.0, 20.0)).unwrap()
}

/// The figures only have to be possible ones: no test here is about them.
fn head(name: &str, vehicle: Vehicle, rate: Rate) -> TableHead {
    TableHead {
        name: Name::new(name).unwrap(),
        vehicle,
        rate,
        limits: limits(),
        design_hash: Hash([0xD5; 32]),
        certificate: Certificate {
            hash: Hash([0xCE; 32]),
            one_channel: Margins { gain_factor: 3.0, phase_rad: 1.0 },
            all_channels: Margins { gain_factor: 2.0, phase_rad: 0.75 },
            delay_max_s: 0.0625,
            motor_lag_max_s: 0.03125,
            f32_distance: 2.5e-8,
        },
    }
}

/// LQR-E times a factor, for a vehicle and a rate.
fn scaled(factor: f32, vehicle: Vehicle, rate: Rate) -> GainTable<'static> {
    let rows = paper::LQR_E.gain().rows().map(|row| row.map(|entry| factor * entry));
    GainTable::new(head("scaled", vehicle, rate), &Rows::Equilibrium(rows)).unwrap()
}

fn bytes(table: &GainTable<'_>) -> Vec<u8> {
    table.to_bytes(&mut [0; TABLE_BYTES_MAX]).unwrap().to_vec()
}

fn controller<'a>(law: impl Into<Law<'a>>) -> Controller<'a> {
    Controller::new(law, limits())
}

/// A loaded table as the board flies it.
fn loaded<'t>(table: &'t GainTable<'_>) -> Controller<'t> {
    let settings = Settings::new(limits(), Rate::from_hz(TICK_HZ).unwrap());
    table.accept_for(&VEHICLE, rate()).unwrap().controller(&settings).unwrap()
}

/// The command of a law that remembers nothing.
fn step(controller: &Controller<'_>, state: &State, reference: &quatrack::Reference) -> Step {
    command(controller.step(&mut Memory::at_rest(), Measured::new(state), Target::new(reference)).unwrap())
}

fn command(output: Output) -> Step {
    *output.command().expect("it gives a command")
}

fn choice(table: Table) -> LawChoice {
    LawChoice::new(table)
}

/// A board in flight on the aggressive trajectory with LQR-E, and the same flight's references on the host.
struct Flight {
    client: Client,
    player: Player<'static>,
    step: u32,
    uploads: u32,
}

impl Flight {
    fn begin() -> Self {
        let mut client = connected();
        client.set(Parameter::Decimation(0)).unwrap();
        client.set(Parameter::StateAgeMaxTicks(10_000)).unwrap();
        client.set(Parameter::LinkSilenceMaxTicks(10_000)).unwrap();
        let limits = LimitsSetting { thrust_min_m_s2: 0.0, thrust_max_m_s2: 16.5, body_rates_max_rad_s: [20.0; 3] };
        client.set(Parameter::Limits(limits)).unwrap();
        client.request(&ToBoard::SelectLaw(choice(Table::LqrE))).unwrap();
        let trajectory = Trajectory::new(stored::pieces(PaperTrajectory::Aggressive)).unwrap();
        let player = Player::new(trajectory, Rate::from_hz(TICK_HZ).unwrap());
        let mut flight = Self { client, player, step: 0, uploads: 0 };
        flight.start();
        flight
    }

    /// Armed, at the start of the trajectory.
    fn start(&mut self) {
        self.request(&ToBoard::Trajectory(TrajectoryCommand::Start(TrajectoryId::Aggressive)));
        self.request(&ToBoard::Arm);
    }

    fn request(&mut self, message: &ToBoard) {
        self.client.request(message).unwrap();
    }

    /// Some steps, each of which is to give the output of `expected`.
    fn fly(&mut self, steps: u32, mut expected: impl FnMut(&State, &quatrack::Reference) -> Step) {
        for _ in 0..steps {
            let tick = self.step * TICKS_PER_STEP;
            let reference = self.player.reference(tick).unwrap();
            let mut state = *reference.state();
            // Off by an amount that changes from step to step, so that no two laws agree.
            let off = 0.01 + 1e-4 * (self.step % 7) as f32;
            state.position_m += Vector3::new(off, -0.01, 0.005);
            state.velocity_m_s += Vector3::new(-0.1, 0.05, off);
            let found = self.client.step(tick, &state).unwrap().result;
            assert_eq!(found, Ok(expected(&state, &reference)), "step {}", self.step);
            self.step += 1;
        }
    }

    /// All chunks of a blob, announced with some checksum, without the commit; which upload it was.
    fn upload(&mut self, blob: &[u8], damage: u32) -> u32 {
        self.uploads += 1;
        let begin = UploadBegin::of(BlobKind::GainTable, self.uploads, blob).unwrap();
        let begin = UploadBegin { checksum: begin.checksum ^ damage, ..begin };
        let mut wanted = self.progress(&ToBoard::UploadBegin(begin));
        while let Some(chunk) = wanted.next_chunk(blob) {
            wanted = self.progress(&ToBoard::UploadChunk(chunk));
        }
        self.uploads
    }

    fn progress(&mut self, message: &ToBoard) -> quatrack::link::Progress {
        match self.client.ask(message).unwrap() {
            FromBoard::Upload(progress) => progress,
            other => panic!("{message:?} is answered by {other:?}"),
        }
    }

    /// Why a request is refused.
    fn refusal(&mut self, message: &ToBoard) -> Refusal {
        match self.client.ask(message).unwrap() {
            FromBoard::Nack { reason, .. } => reason,
            other => panic!("{message:?} is answered by {other:?}"),
        }
    }

    fn refused(&mut self) -> u32 {
        match self.client.ask(&ToBoard::GetParameter(ParameterId::UploadsRefused)).unwrap() {
            FromBoard::Parameter(Parameter::UploadsRefused(count)) => count,
            other => panic!("a parameter is answered by {other:?}"),
        }
    }
}

/// A way of the board's length, stepped on the host.
fn fading<'a>(old: Controller<'a>, new: Controller<'a>) -> impl FnMut(&State, &quatrack::Reference) -> Step + use<'a> {
    let mut memory = Memory::at_rest();
    let mut way = Handover::begin(FADE_STEPS, old.law(), new.law(), &mut memory);
    move |state, reference| command(way.step((&old, &new), &mut memory, state.into(), reference.into()).unwrap())
}

#[test]
fn a_table_uploaded_in_flight_is_swapped_in_bit_for_bit() {
    if !has_emulator() {
        return;
    }
    let (first, second) = (scaled(1.25, VEHICLE, rate()), scaled(0.75, VEHICLE, rate()));
    let (first_law, second_law) = (loaded(&first), loaded(&second));
    let built_in = controller(choice(Table::LqrE).built_in().unwrap());
    let ahead = FADE_STEPS.into();
    let mut flight = Flight::begin();

    flight.fly(20, |state, reference| step(&built_in, state, reference));
    assert_eq!(flight.refusal(&ToBoard::SelectLaw(choice(Table::Loaded(0)))), Refusal::NoTable);
    let id = flight.upload(&bytes(&first), 0);
    flight.request(&ToBoard::UploadCommit { id });
    flight.fly(20, |state, reference| step(&built_in, state, reference));

    // From the built-in law to the loaded table, over the board's own number of steps, the last of which is the table's.
    flight.request(&ToBoard::SelectLaw(choice(Table::Loaded(0))));
    let mut way = fading(built_in, first_law);
    flight.fly(10, &mut way);
    assert_eq!(flight.refusal(&ToBoard::SelectLaw(choice(Table::LqrE))), Refusal::LawChanging);
    flight.request(&ToBoard::SelectLaw(choice(Table::Loaded(0))));
    flight.fly(ahead, &mut way);
    flight.fly(20, |state, reference| step(&first_law, state, reference));

    // The next table takes the place of the one that is flown. A commit that comes twice does it once.
    let id = flight.upload(&bytes(&second), 0);
    flight.fly(5, |state, reference| step(&first_law, state, reference));
    flight.request(&ToBoard::UploadCommit { id });
    let mut way = fading(first_law, second_law);
    flight.fly(25, &mut way);
    flight.request(&ToBoard::UploadCommit { id });
    flight.fly(ahead, &mut way);

    // Back to the one before, and on the ground to it again: the tables on board and the choice survive a disarm.
    flight.request(&ToBoard::SelectLaw(choice(Table::Loaded(1))));
    let mut way = fading(second_law, first_law);
    flight.fly(25, &mut way);
    flight.request(&ToBoard::Disarm);
    flight.start();
    flight.step = 0;
    flight.fly(50, |state, reference| step(&first_law, state, reference));
    assert_eq!(flight.refused(), 0);
}

#[test]
fn bad_tables_are_refused_each_for_its_reason_and_the_flight_goes_on() {
    if !has_emulator() {
        return;
    }
    let built_in = controller(choice(Table::LqrE).built_in().unwrap());
    let good = bytes(&scaled(1.25, VEHICLE, rate()));
    let other_vehicle = Vehicle { id: 1, ..VEHICLE };
    let slower = Rate::from_hz(100).unwrap();
    let mut flipped = good.clone();
    flipped[200] ^= 1;
    let mut flight = Flight::begin();
    let mut count = 0;
    let mut refusal = |blob: &[u8], damage: u32| {
        flight.fly(10, |state, reference| step(&built_in, state, reference));
        let id = flight.upload(blob, damage);
        let reason = flight.refusal(&ToBoard::UploadCommit { id });
        count += 1;
        assert_eq!(flight.refused(), count);
        flight.fly(10, |state, reference| step(&built_in, state, reference));
        assert_eq!(flight.refusal(&ToBoard::SelectLaw(choice(Table::Loaded(0)))), Refusal::NoTable);
        assert_eq!(flight.client.telemetry().unwrap().mode, Mode::Flying);
        reason
    };
    assert!(matches!(refusal(&good, 1), Refusal::Upload(_)), "not the announced blob");
    let mut table_error = |blob: &[u8]| match refusal(blob, 0) {
        Refusal::Blob(BlobError::GainTable(error)) => error,
        other => panic!("refused as {other:?}"),
    };
    assert!(matches!(table_error(&flipped), LoadError::Table(TableError::Checksum { .. })));
    assert!(matches!(table_error(&good[..good.len() - 1]), LoadError::Table(TableError::Length { .. })));
    assert_eq!(
        table_error(&bytes(&scaled(1.25, other_vehicle, rate()))),
        LoadError::Accept(AcceptError::Vehicle { table: other_vehicle })
    );
    assert_eq!(
        table_error(&bytes(&scaled(1.25, VEHICLE, slower))),
        LoadError::Accept(AcceptError::Rate { table_hz: 100, loop_hz: 500 })
    );
}

/// LQI as it is designed in the repository, and gains along the aggressive trajectory.
const LQI: &[u8] = include_bytes!("../../../../../gains/generated/lqi-e.bin");
const ALONG: &[u8] = include_bytes!("../../../../../gains/generated/along-aggressive.bin");

/// The same gains for control steps at 500 Hz: five times as many of them between two knots.
fn along_at_500_hz() -> Vec<u8> {
    let table = GainTable::from_bytes(ALONG).unwrap();
    let schedule = table.schedule().unwrap();
    let gains: Vec<_> = (0..).map_while(|knot| schedule.gain(knot)).collect();
    let rows = ScheduleRows {
        trajectory: schedule.trajectory(),
        steps_per_knot: 5 * schedule.steps_per_knot(),
        gains: &gains,
    };
    let head = TableHead { rate: rate(), ..*table.head() };
    bytes(&GainTable::along(&mut [0; TABLE_BYTES_MAX], &head, &rows).unwrap())
}

#[test]
fn tables_that_remember_or_follow_a_clock_fly_bit_for_bit() {
    if !has_emulator() {
        return;
    }
    for blob in [LQI, &along_at_500_hz()] {
        let table = GainTable::from_bytes(blob).unwrap();
        let (built_in, new) = (controller(choice(Table::LqrE).built_in().unwrap()), loaded(&table));
        let trajectory = Trajectory::new(stored::pieces(PaperTrajectory::Aggressive)).unwrap().checksum();
        let mut flight = Flight::begin();
        flight.fly(20, |state, reference| step(&built_in, state, reference));
        let id = flight.upload(blob, 0);
        flight.request(&ToBoard::UploadCommit { id });
        flight.request(&ToBoard::SelectLaw(choice(Table::Loaded(0))));
        // Over the way to it and on for a second: its integral, and its place on the trajectory, count.
        let mut memory = Memory::at_rest();
        let mut way = Handover::begin(FADE_STEPS, built_in.law(), new.law(), &mut memory);
        let mut tick = 20 * TICKS_PER_STEP;
        flight.fly(550, |state, reference| {
            let target = Target::new(reference).at(Some(Progress { trajectory, tick }));
            tick += TICKS_PER_STEP;
            command(way.step((&built_in, &new), &mut memory, state.into(), target).unwrap())
        });
        assert_eq!(
            memory.integral_m_s() != Vector3::zeros(),
            table.kind() == quatrack::gains::table::TableKind::Integral
        );
        // And back to a law that does not.
        flight.request(&ToBoard::SelectLaw(choice(Table::LqrE)));
        let mut way = Handover::begin(FADE_STEPS, new.law(), built_in.law(), &mut memory);
        flight.fly(100, |state, reference| {
            let target = Target::new(reference).at(Some(Progress { trajectory, tick }));
            tick += TICKS_PER_STEP;
            command(way.step((&new, &built_in), &mut memory, state.into(), target).unwrap())
        });
    }
}

#[test]
fn a_loaded_tables_own_limits_hold() {
    if !has_emulator() {
        return;
    }
    let tight = Limits::new(9.0, 10.5, Vector3::new(1.0, 1.0, 0.5)).unwrap();
    let rows = Rows::Equilibrium(*paper::LQR_E.gain().rows());
    let table = GainTable::new(TableHead { limits: tight, ..head("tight", VEHICLE, rate()) }, &rows).unwrap();
    let new = loaded(&table);
    assert_eq!(*new.limits(), tight, "tighter than the board's");
    let built_in = controller(choice(Table::LqrE).built_in().unwrap());
    let mut flight = Flight::begin();
    let id = flight.upload(&bytes(&table), 0);
    flight.request(&ToBoard::UploadCommit { id });
    flight.request(&ToBoard::SelectLaw(choice(Table::Loaded(0))));
    let mut way = fading(built_in, new);
    flight.fly(FADE_STEPS.into(), &mut way);
    let mut cut = 0;
    flight.fly(500, |state, reference| {
        let step = step(&new, state, reference);
        assert!((9.0..=10.5).contains(&step.command.thrust_m_s2));
        cut += u32::from(step.limited.any());
        step
    });
    assert!(cut > 100, "{cut} of 500 steps are cut on the aggressive trajectory");
}
