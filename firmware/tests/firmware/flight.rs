//! The flight without its board: what ends it, and that nothing is ever held.

use quatrack::link::{CommandOut, LawChoice, NoCommand, StateIn, Table, TrajectoryId};
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::{Fault, Mode, StopReason};
use quatrack::{Command, FlatSample, State, Tick};
use quatrack_firmware::craft::BodyRates;
use quatrack_firmware::flight::{CONFIG, DECIMATION, Flight};
use quatrack_firmware::stored;

/// Below the start of both trajectories: every law asks for thrust.
fn low() -> State {
    State::at_rest(Vector3::new(0.0, 0.0, -0.1))
}

fn board(fault: Option<Fault>) -> Flight {
    Flight::new(Box::leak(Box::default()), fault)
}

/// A flight in the air at a tick.
fn flying(now: Tick) -> Flight {
    let mut flight = board(None);
    flight.select(LawChoice::new(Table::LqrE)).expect("it is in flash");
    flight.playback.start(stored::player(TrajectoryId::Mild).expect("it is in flash"));
    flight.hear(now);
    flight.arm(now).expect("the link has just been heard");
    flight.accept(StateIn { tick: 7, state: low() }, now);
    flight.step(now, false, BodyRates::NoGyroscope);
    assert_eq!(flight.mode(), Mode::Flying);
    assert!(flight.command().thrust_m_s2 > 9.81, "it climbs");
    flight
}

fn stopped(flight: &Flight) -> Option<StopReason> {
    assert_eq!(flight.command(), &Command::ZERO, "a flight that has ended holds no command");
    match flight.mode() {
        Mode::Disarmed(reason) => reason,
        mode => panic!("still {mode}"),
    }
}

#[test]
fn a_state_is_answered_once_with_the_tick_that_it_came_with() {
    let mut flight = flying(100);
    let Some(CommandOut { tick: 100, state_tick: 7, result: Ok(step) }) = flight.take_answer() else {
        panic!("the state has no answer");
    };
    assert_eq!(&step.command, flight.command());
    flight.step(102, false, BodyRates::NoGyroscope);
    assert_eq!(flight.take_answer(), None, "the same state again is no new one");
    assert_eq!(flight.mode(), Mode::Flying);
}

#[test]
fn before_it_is_armed_it_commands_nothing() {
    let mut flight = board(None);
    flight.playback.start(stored::player(TrajectoryId::Mild).expect("it is in flash"));
    flight.accept(StateIn { tick: 0, state: low() }, 0);
    flight.step(0, false, BodyRates::NoGyroscope);
    assert_eq!(flight.command(), &Command::ZERO);
    let answer = flight.take_answer().expect("even so the state is answered");
    assert_eq!(answer.result, Err(NoCommand::Mode(Mode::Disarmed(None))));
    assert!(flight.arm(0).is_err(), "nobody has been heard");
}

#[test]
fn an_old_state_ends_the_flight_between_steps_too() {
    for stepping in [true, false] {
        let mut flight = flying(100);
        let mut now = 100;
        while flight.mode() == Mode::Flying {
            now += DECIMATION;
            flight.hear(now);
            if stepping {
                flight.step(now, false, BodyRates::NoGyroscope);
            } else {
                flight.watch(now, false);
            }
        }
        assert_eq!(stopped(&flight), Some(StopReason::StaleState));
        let age = now - 100;
        assert!(age > CONFIG.state_age_max_ticks && age <= CONFIG.state_age_max_ticks + DECIMATION, "at {age} ticks");
    }
}

#[test]
fn a_silent_link_ends_the_flight() {
    let mut flight = flying(0);
    flight.config.state_age_max_ticks = 10_000;
    flight.watch(CONFIG.link_silence_max_ticks, false);
    assert_eq!(flight.mode(), Mode::Flying);
    flight.watch(CONFIG.link_silence_max_ticks + 1, false);
    assert_eq!(stopped(&flight), Some(StopReason::LinkLost));
}

#[test]
fn overruns_in_a_row_end_the_flight() {
    let mut flight = flying(0);
    for tick in 1..=CONFIG.overruns_tolerated {
        flight.step(tick, true, BodyRates::NoGyroscope);
        assert_eq!(flight.mode(), Mode::Flying, "so many are tolerated");
    }
    flight.step(CONFIG.overruns_tolerated + 1, true, BodyRates::NoGyroscope);
    assert_eq!(stopped(&flight), Some(StopReason::Overrun));
}

#[test]
fn a_step_without_a_command_ends_the_flight() {
    let mut flight = flying(0);
    flight.accept(StateIn { tick: 9, state: State::at_rest(Vector3::new(f32::NAN, 0.0, 0.0)) }, 2);
    flight.step(2, false, BodyRates::NoGyroscope);
    assert_eq!(stopped(&flight), Some(StopReason::StepFailed));
    assert_eq!(flight.steps(), (2, 1));

    let mut flight = flying(0);
    flight.playback.follow(FlatSample::at_rest(Vector3::new(0.0, 0.0, f32::INFINITY), 0.0));
    flight.step(2, false, BodyRates::NoGyroscope);
    assert_eq!(stopped(&flight), Some(StopReason::StepFailed));
}

#[test]
fn nothing_to_follow_ends_the_flight() {
    let mut flight = flying(0);
    flight.playback.stop();
    flight.step(2, false, BodyRates::NoGyroscope);
    assert_eq!(stopped(&flight), Some(StopReason::NoReference));
}

#[test]
fn a_disarm_request_stops_at_once() {
    let mut flight = flying(0);
    flight.disarm();
    assert_eq!(stopped(&flight), Some(StopReason::Requested));
}

#[test]
fn a_fault_stays_until_a_restart() {
    let mut flight = flying(0);
    flight.fail(Fault::StackExhausted, 1);
    assert_eq!((flight.mode(), *flight.command()), (Mode::Faulted(Fault::StackExhausted), Command::ZERO));
    flight.step(2, false, BodyRates::NoGyroscope);
    assert_eq!(flight.command(), &Command::ZERO);
    assert!(flight.arm(2).is_err());
    assert_eq!(board(Some(Fault::HardFault)).mode(), Mode::Faulted(Fault::HardFault), "or from one");
}
