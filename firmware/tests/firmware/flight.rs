//! The flight without its board: every cause that ends it, and that no command is ever held.

use quatrack::link::{CommandOut, LawChoice, NoCommand, StateIn, Table, TrajectoryId};
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::{ArmError, Fault, Mode, Reason};
use quatrack::{Command, FlatSample, State, Tick};
use quatrack_firmware::craft::BodyRates;
use quatrack_firmware::flight::{CONFIG, DECIMATION, Flight, LOCK_STEP, MONITOR};
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
    flight.accept(StateIn { tick: 7, state: low() }, now);
    flight.arm(now).expect("it is where the trajectory begins");
    flight.step(now, false, BodyRates::NoGyroscope);
    assert_eq!(flight.mode(), Mode::Flying);
    assert!(flight.command().thrust_m_s2 > 9.81, "it climbs");
    flight
}

fn stopped(flight: &Flight) -> Reason {
    assert_eq!(flight.command(), &Command::ZERO, "a flight that has ended holds no command");
    match flight.mode() {
        Mode::Stopped(reason) => reason,
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
    assert_eq!(answer.result, Err(NoCommand::Mode(Mode::OnGround)));
    assert_eq!(flight.arm(0), Err(ArmError::LinkSilent), "nobody has been heard");
}

/// Without body rates nothing can be levelled: it stops.
#[test]
fn an_old_state_is_bridged_for_half_a_second_and_then_ends_the_flight() {
    let mut flight = flying(100);
    let mut now = 100;
    while flight.mode() == Mode::Flying {
        now += DECIMATION;
        flight.hear(now);
        flight.step(now, false, BodyRates::NoGyroscope);
        flight.watch(now + 1, false);
    }
    assert_eq!(stopped(&flight), Reason::StateLost);
    let age = now - 100;
    let borne = CONFIG.state_age_max_ticks + MONITOR.bridge_ticks;
    assert!(age > borne && age <= borne + 3 * DECIMATION, "at {age} ticks");
}

#[test]
fn in_lock_step_an_old_state_ends_the_flight_without_a_step() {
    for (heard, expected) in [(true, Reason::StateLost), (false, Reason::LinkLost)] {
        let mut flight = board(None);
        flight.set_decimation(LOCK_STEP);
        flight.playback.start(stored::player(TrajectoryId::Mild).expect("it is in flash"));
        flight.hear(0);
        flight.arm(0).expect("no motor turns");
        flight.accept(StateIn { tick: 0, state: low() }, 0);
        flight.step(0, false, BodyRates::NoGyroscope);
        let mut now = 0;
        while flight.mode() == Mode::Flying {
            now += 1;
            if heard {
                flight.hear(now);
            } else {
                flight.accept(StateIn { tick: now, state: low() }, now);
            }
            flight.watch(now, false);
        }
        assert_eq!(stopped(&flight), expected);
        assert_eq!(now, 1 + if heard { CONFIG.state_age_max_ticks } else { CONFIG.link_silence_max_ticks });
    }
}

#[test]
fn a_silent_link_ends_the_flight() {
    let mut flight = flying(0);
    for now in [CONFIG.link_silence_max_ticks, CONFIG.link_silence_max_ticks + 1] {
        assert_eq!(flight.mode(), Mode::Flying);
        flight.accept(StateIn { tick: now, state: low() }, now);
        flight.step(now, false, BodyRates::NoGyroscope);
    }
    assert_eq!(stopped(&flight), Reason::LinkLost);
}

#[test]
fn overruns_in_a_row_end_the_flight() {
    let mut flight = flying(0);
    for tick in 1..=CONFIG.overruns_tolerated {
        flight.step(tick, true, BodyRates::NoGyroscope);
        assert_eq!(flight.mode(), Mode::Flying, "so many are tolerated");
    }
    flight.step(CONFIG.overruns_tolerated + 1, true, BodyRates::NoGyroscope);
    assert_eq!(stopped(&flight), Reason::Overrun);
}

#[test]
fn a_state_that_is_none_is_bridged_and_a_reference_that_is_none_ends_the_flight() {
    let mut flight = flying(0);
    flight.accept(StateIn { tick: 9, state: State::at_rest(Vector3::new(f32::NAN, 0.0, 0.0)) }, 2);
    flight.step(2, false, BodyRates::NoGyroscope);
    assert_eq!(flight.mode(), Mode::Flying);
    assert!(flight.command().thrust_m_s2 > 9.81, "as the state before it");

    let mut flight = flying(0);
    flight.playback.follow(FlatSample::at_rest(Vector3::new(0.0, 0.0, f32::INFINITY), 0.0));
    flight.step(2, false, BodyRates::NoGyroscope);
    assert_eq!(stopped(&flight), Reason::BadReference);
    assert_eq!(flight.steps(), (2, 1));
}

#[test]
fn nothing_to_follow_ends_the_flight() {
    let mut flight = flying(0);
    flight.playback.stop();
    flight.step(2, false, BodyRates::NoGyroscope);
    assert_eq!(stopped(&flight), Reason::NoReference);
}

#[test]
fn a_disarm_request_stops_at_once() {
    let mut flight = flying(0);
    flight.disarm();
    assert_eq!((flight.mode(), flight.command()), (Mode::OnGround, &Command::ZERO));
}

#[test]
fn a_craft_not_fit_to_fly_is_not_armed() {
    let refused = |change: fn(&mut Flight)| {
        let mut flight = board(None);
        flight.playback.start(stored::player(TrajectoryId::Mild).expect("it is in flash"));
        flight.hear(0);
        flight.accept(StateIn { tick: 0, state: low() }, 0);
        change(&mut flight);
        flight.arm(0)
    };
    assert_eq!(refused(|_| ()), Ok(()));
    let far = |f: &mut Flight| f.accept(StateIn { tick: 0, state: State::at_rest(Vector3::new(3.0, 0.0, 0.0)) }, 0);
    assert!(matches!(refused(far), Err(ArmError::TooFar { .. })));
    assert_eq!(refused(|f| f.config.state_age_max_ticks = 501), Err(ArmError::Tolerance { ticks: 501 }));
    let no_hover = |f: &mut Flight| {
        let mut limits = f.limits();
        limits.thrust_max_m_s2 = 9.0;
        f.set_limits(limits).expect("limits they are");
    };
    assert_eq!(refused(no_hover), Err(ArmError::NoHover { thrust_m_s2: 9.0 }));
}

#[test]
fn a_reference_that_comes_later_and_far_away_is_not_flown_to() {
    let mut flight = board(None);
    flight.hear(0);
    flight.accept(StateIn { tick: 0, state: low() }, 0);
    flight.arm(0).expect("there is nothing to follow yet");
    flight.step(0, false, BodyRates::NoGyroscope);
    assert_eq!(flight.mode(), Mode::Armed);
    flight.playback.follow(FlatSample::at_rest(Vector3::new(0.0, 2.0, 0.0), 0.0));
    flight.step(2, false, BodyRates::NoGyroscope);
    assert_eq!(stopped(&flight), Reason::StartTooFar);
}

#[test]
fn a_fault_stays_until_a_restart() {
    let mut flight = flying(0);
    flight.fail(Fault::StackExhausted, 1);
    assert_eq!(
        (flight.mode(), *flight.command()),
        (Mode::Stopped(Reason::Fault(Fault::StackExhausted)), Command::ZERO)
    );
    flight.step(2, false, BodyRates::NoGyroscope);
    assert_eq!(flight.command(), &Command::ZERO);
    assert!(flight.arm(2).is_err());
    assert_eq!(board(Some(Fault::HardFault)).mode(), Mode::Stopped(Reason::Fault(Fault::HardFault)), "or from one");
}
