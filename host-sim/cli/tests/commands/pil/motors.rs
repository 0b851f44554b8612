//! The emulated board down to its motors: forces in answer to states with body rates, and what ends them.

use quatrack::link::{
    FromBoard, LawChoice, NoCommand, Parameter, ParameterId, RigidStateIn, StateIn, Table, ToBoard, TrajectoryCommand,
    TrajectoryId,
};
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::{Mode, StopReason};
use quatrack::{Airframe, RigidState, State};
use quatrack_cli::pil::client::Client;

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
    for table in [Table::LqrE, Table::ActuatorAware] {
        let mut client = flying(table);
        client.request(&ToBoard::Disarm).unwrap();
        let disarmed = Mode::Disarmed(Some(StopReason::Requested));
        assert_eq!(client.step_rigid(2, &at_rest()).unwrap().result, Err(NoCommand::Mode(disarmed)));
    }
}

#[test]
fn a_law_to_the_motors_is_not_flown_without_body_rates() {
    if !has_emulator() {
        return;
    }
    let mut client = flying(Table::ActuatorAware);
    let without = ToBoard::State(StateIn { tick: 2, state: at_rest().state });
    let FromBoard::Command(answer) = client.ask(&without).unwrap() else { panic!("no command") };
    assert_eq!(answer.result, Err(NoCommand::NoBodyRates));
    assert_eq!(client.telemetry().unwrap().mode, Mode::Disarmed(Some(StopReason::StepFailed)));
    let mut client = flying(Table::ActuatorAware);
    let mut bad = at_rest();
    bad.body_rates_rad_s.z = f32::NAN;
    let message = ToBoard::RigidState(RigidStateIn { tick: 2, state: bad });
    let FromBoard::Forces(answer) = client.ask(&message).unwrap() else { panic!("no forces") };
    assert!(matches!(answer.result, Err(NoCommand::Step(_))), "{answer:?}");
    assert_eq!(client.telemetry().unwrap().mode, Mode::Disarmed(Some(StopReason::StepFailed)));
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
