//! The emulated board down to its motors: forces in answer to states with body rates, and the causes that end them.

use quatrack::cascade::CascadeLimits;
use quatrack::gains::table::{GainTable, Name, Vehicle};
use quatrack::link::{
    BlobKind, FromBoard, LawChoice, NoCommand, Parameter, ParameterId, RigidStateIn, StateIn, Table, ToBoard,
    TrajectoryCommand, TrajectoryId, UploadBegin,
};
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::{Mode, Reason};
use quatrack::{
    Airframe, Heading, Limits, Measured, Memory, Player, Rate, Reference, RigidState, Settings, State, Target,
    Trajectory,
};
use quatrack_cli::pil::client::Client;
use quatrack_plan::plan::paper::PaperTrajectory;
use quatrack_plan::plan::stored;

use super::emulated::connected;
use super::support::has_emulator;

fn at_rest() -> RigidState {
    RigidState { state: State::at_rest(Vector3::new(0.0, 0.0, 0.0)), body_rates_rad_s: Vector3::new(0.0, 0.0, 0.0) }
}

/// A board in flight under a law: armed, one state answered with forces.
fn flying(table: Table) -> Client {
    let mut client = connected();
    client.set(Parameter::Decimation(0)).unwrap();
    client.set(Parameter::StateAgeMaxTicks(10_000)).unwrap();
    client.set(Parameter::LinkSilenceMaxTicks(10_000)).unwrap();
    client.request(&ToBoard::SelectLaw(LawChoice::new(table))).unwrap();
    client.request(&ToBoard::Trajectory(TrajectoryCommand::Start(TrajectoryId::Mild))).unwrap();
    client.request(&ToBoard::Arm).unwrap();
    let forces_n = client.step_rigid(0, &at_rest()).unwrap().result.unwrap().forces_n;
    let figures = *Airframe::CRAZYFLIE_2_1.figures();
    assert!(forces_n.iter().all(|force| (figures.force_min_n..=figures.force_max_n).contains(force)), "{forces_n:?}");
    client
}

#[test]
fn a_disarmed_board_gives_no_forces() {
    if !has_emulator() {
        return;
    }
    for table in [Table::LqrE, Table::Cascade] {
        let mut client = flying(table);
        client.request(&ToBoard::Disarm).unwrap();
        assert_eq!(client.step_rigid(2, &at_rest()).unwrap().result, Err(NoCommand::Mode(Mode::OnGround)));
    }
}

#[test]
fn a_law_to_the_motors_is_not_flown_without_body_rates() {
    if !has_emulator() {
        return;
    }
    let mut client = flying(Table::Cascade);
    let without = ToBoard::State(StateIn { tick: 2, state: at_rest().state });
    let FromBoard::Command(answer) = client.ask(&without).unwrap() else { panic!("no command") };
    assert_eq!(answer.result, Err(NoCommand::NoBodyRates));
    assert_eq!(client.telemetry().unwrap().mode, Mode::Stopped(Reason::StepFailed));
    let mut client = flying(Table::Cascade);
    let mut bad = at_rest();
    bad.body_rates_rad_s.z = f32::NAN;
    let message = ToBoard::RigidState(RigidStateIn { tick: 2, state: bad });
    let FromBoard::Forces(answer) = client.ask(&message).unwrap() else { panic!("no forces") };
    assert!(answer.result.is_ok(), "bridged by the attitude, which does not turn: {answer:?}");
    assert_eq!(client.telemetry().unwrap().mode, Mode::Flying);
}

#[test]
fn the_battery_is_told_in_flight_and_the_rate_loop_is_not() {
    if !has_emulator() {
        return;
    }
    let mut client = flying(Table::LqrE);
    client.set(Parameter::BatteryVoltage(3.5)).unwrap();
    let told = client.ask(&ToBoard::GetParameter(ParameterId::BatteryVoltage)).unwrap();
    assert_eq!(told, FromBoard::Parameter(Parameter::BatteryVoltage(3.5)));
    assert!(client.set(Parameter::BatteryVoltage(7.4)).is_err(), "two cells in series");
    assert!(client.set(Parameter::BodyRateBandwidth([20.0; 3])).is_err(), "not while the motors may turn");
    client.request(&ToBoard::Disarm).unwrap();
    assert!(client.set(Parameter::BodyRateBandwidth([20.0, 0.0, 20.0])).is_err(), "an axis without a loop");
    client.set(Parameter::BodyRateBandwidth([20.0, 20.0, 10.0])).unwrap();
}

#[test]
fn a_table_of_the_cascade_flies_bit_for_bit_from_the_first_laws_forces_on() {
    if !has_emulator() {
        return;
    }
    let blob: &[u8] = include_bytes!("../../../../../gains/generated/cascade-63ms.bin");
    let (rate, ticks) = (Rate::from_hz(500).unwrap(), Rate::from_hz(1000).unwrap());
    let vehicle = Vehicle { name: Name::literal("crazyflie-2.1"), id: 0x8983_3c06 };
    let table = GainTable::from_bytes(blob).unwrap();
    let accepted = table.accept_for(&vehicle, rate).unwrap();
    let told = accepted.cascade().unwrap();
    let cascade = told.flown(&Airframe::CRAZYFLIE_2_1, rate, &CascadeLimits::STANDARD, &told.air).unwrap();
    let settings = Settings { cascade: Some(&cascade), ..Settings::new(Limits::NONE, ticks) };
    let controller = accepted.controller(&settings).unwrap();

    let mut client = connected();
    client.set(Parameter::Decimation(0)).unwrap();
    client.set(Parameter::StateAgeMaxTicks(10_000)).unwrap();
    client.set(Parameter::LinkSilenceMaxTicks(10_000)).unwrap();
    let begin = UploadBegin::of(BlobKind::GainTable, 1, blob).unwrap();
    let mut answer = client.ask(&ToBoard::UploadBegin(begin)).unwrap();
    while let FromBoard::Upload(wanted) = answer {
        let Some(chunk) = wanted.next_chunk(blob) else { break };
        answer = client.ask(&ToBoard::UploadChunk(chunk)).unwrap();
    }
    client.request(&ToBoard::UploadCommit { id: 1 }).unwrap();
    client.request(&ToBoard::SelectLaw(LawChoice::new(Table::Loaded(0)))).unwrap();
    client.request(&ToBoard::Trajectory(TrajectoryCommand::Start(TrajectoryId::Mild))).unwrap();
    client.request(&ToBoard::Arm).unwrap();

    let mut player = Player::new(Trajectory::new(stored::pieces(PaperTrajectory::Mild)).unwrap(), ticks);
    let mut memory = Memory::at_rest();
    for step in 0..500_u16 {
        let tick = 2 * u32::from(step);
        let sample = player.at_fifth_order(tick);
        let reference = Reference::from_flat(&sample.flat).unwrap();
        let body_rates_rad_s = reference.input().body_rates_rad_s;
        let mut measured = RigidState { state: *reference.state(), body_rates_rad_s };
        measured.state.position_m.z -= 0.01 + 1e-5 * f32::from(step);
        measured.body_rates_rad_s.x += 0.1;
        let target = Target::with_sample(&sample, Heading::from_angle(sample.flat.heading_rad));
        let expected = controller.step_to_motors(&mut memory, Measured::from(&measured), target).unwrap();
        let found = client.step_rigid(tick, &measured).unwrap().result;
        assert_eq!(found, Ok(expected), "step {step}");
    }
}
