//! The state machine by its verdicts: every reason, its time and the mode after it.

use nalgebra::Vector3;

use super::super::mode::{Fault, Tumble};
use super::*;

const CONFIG: Config = Config {
    geofence: Some(Geofence { least_m: [-2.0, -2.0, -1.0], most_m: [2.0, 2.0, 3.0] }),
    battery_low_ticks: 20,
    saturation_max_ticks: 30,
    ..Config::STANDARD
};

/// Everything as it should be.
const WELL: Conditions = Conditions {
    now: 1000,
    link_silence_ticks: Some(500),
    soundness: Soundness::Sound,
    upright: 1.0,
    position_m: Vector3::new(0.0, 0.0, 1.0),
    velocity_m_s: Vector3::new(1.0, 0.0, 0.0),
    reference: ReferenceReport::Sound,
    limited: false,
    limited_thrust: false,
    levels: true,
    starts_near: true,
    landed: false,
    battery_v: Some(3.7),
    overrun: false,
    fault: None,
};

const DOWN: Mode = Mode::LevelAndDown(Reason::LinkLost);
const HELD: Mode = Mode::Holding(Reason::BadReference);
const FAULTED: Mode = Mode::Stopped(Reason::Fault(Fault::HardFault));
const OFF: [Mode; 4] =
    [Mode::OnGround, Mode::Stopped(Reason::Landed), Mode::Tumbled(Tumble::Tilted), Mode::Stopped(Reason::Overrun)];
const MODES: [Mode; 8] = [
    Mode::OnGround,
    Mode::Armed,
    Mode::Flying,
    HELD,
    DOWN,
    Mode::Stopped(Reason::Landed),
    Mode::Tumbled(Tumble::Tilted),
    FAULTED,
];

fn with(change: impl Fn(&mut Conditions)) -> Conditions {
    let mut conditions = WELL;
    change(&mut conditions);
    conditions
}

/// In a mode since the tick of [`WELL`].
fn in_mode(mode: Mode) -> Supervisor {
    Supervisor { mode, since: WELL.now, ..Supervisor::new() }
}

/// The mode after the same conditions for so many ticks, one step each.
fn after(mode: Mode, conditions: Conditions, ticks: Tick) -> Mode {
    let mut supervisor = in_mode(mode);
    for tick in 0..=ticks {
        let before = supervisor.mode();
        let verdict = supervisor.step(&CONFIG, &Conditions { now: WELL.now + tick, ..conditions });
        assert_eq!(verdict.mode, supervisor.mode());
        assert_eq!(
            verdict.stopped,
            before.motors_allowed() && !verdict.mode.motors_allowed(),
            "{before:?} {verdict:?}"
        );
        assert_eq!(verdict.action == Action::Off, !verdict.mode.is_in_air(), "{verdict:?}");
    }
    supervisor.mode()
}

#[test]
fn at_once_in_the_air() {
    let rows = [
        (with(|_| ()), Mode::Flying),
        (with(|c| c.soundness = Soundness::Bridged), Mode::Flying),
        (with(|c| c.fault = Some(Fault::HardFault)), FAULTED),
        (with(|c| c.soundness = Soundness::AttitudeLost), Mode::Stopped(Reason::AttitudeLost)),
        (with(|c| c.soundness = Soundness::BodyRatesLost), Mode::Stopped(Reason::BodyRatesLost)),
        (with(|c| c.soundness = Soundness::AttitudeOnly), Mode::LevelAndDown(Reason::StateLost)),
        (with(|c| c.link_silence_ticks = Some(501)), Mode::Holding(Reason::LinkLost)),
        (with(|c| c.link_silence_ticks = None), Mode::Holding(Reason::LinkLost)),
        (with(|c| c.reference = ReferenceReport::Bad), HELD),
        (with(|c| c.reference = ReferenceReport::Missing), Mode::Holding(Reason::NoReference)),
        (with(|c| c.position_m.x = 2.1), Mode::Holding(Reason::Geofence)),
        (with(|c| c.position_m.z = f32::NAN), Mode::Holding(Reason::Geofence)),
    ];
    for (conditions, expected) in rows {
        assert_eq!(after(Mode::Flying, conditions, 0), expected, "{conditions:?}");
    }
}

#[test]
fn after_a_time_in_the_air() {
    let upright = |cosine: f32| with(|c| c.upright = cosine);
    let still = |c: &mut Conditions| (c.velocity_m_s, c.limited, c.limited_thrust) = (Vector3::zeros(), true, true);
    // Ticks that it is borne, and the mode on the next.
    let rows = [
        (upright(0.49), 1000, Mode::Tumbled(Tumble::Tilted)),
        (upright(-0.1), 600, Mode::Tumbled(Tumble::UpsideDown)),
        (with(|c| c.battery_v = Some(2.9)), 20, Mode::Holding(Reason::Battery)),
        (with(|c| c.limited = true), 30, Mode::Holding(Reason::Saturated)),
        (with(|c| c.overrun = true), 1, Mode::Stopped(Reason::Overrun)),
    ];
    for (conditions, ticks, expected) in rows {
        assert_eq!(after(Mode::Flying, conditions, ticks), Mode::Flying, "{conditions:?}");
        assert_eq!(after(Mode::Flying, conditions, ticks + 1), expected, "{conditions:?}");
    }
    assert_eq!(after(HELD, with(still), 1501), Mode::Tumbled(Tumble::NoClimb));
    assert_eq!(after(Mode::Flying, upright(f32::NAN), 1400), Mode::Flying, "an unknown tilt is none");
}

#[test]
fn trouble_that_is_over_before_its_time_is_forgotten() {
    let mut supervisor = in_mode(Mode::Flying);
    for tick in 0..5000 {
        let upright = if tick % 900 == 0 { 1.0 } else { 0.3 };
        let seen = Conditions { now: WELL.now + tick, upright, limited: tick % 25 > 0, overrun: tick % 3 > 0, ..WELL };
        assert_eq!(supervisor.step(&CONFIG, &seen).mode, Mode::Flying, "{tick}");
    }
}

#[test]
fn holding_becomes_a_descent_which_ends_on_the_ground_or_after_half_a_minute() {
    let bad = with(|c| c.reference = ReferenceReport::Bad);
    assert_eq!(after(HELD, bad, 1500), HELD);
    assert_eq!(after(HELD, bad, 1501), Mode::LevelAndDown(Reason::BadReference));
    assert_eq!(after(HELD, with(|c| c.soundness = Soundness::AttitudeOnly), 0), Mode::LevelAndDown(Reason::StateLost));
    let lost = with(|c| c.link_silence_ticks = None);
    assert_eq!(after(DOWN, lost, 30_000), DOWN);
    assert_eq!(after(DOWN, lost, 30_001), Mode::Stopped(Reason::NoGround));
    assert_eq!(after(DOWN, with(|c| c.landed = true), 0), Mode::Stopped(Reason::Landed));
    assert_eq!(after(HELD, with(|c| c.landed = true), 0), HELD);
}

#[test]
fn a_flight_goes_on_once_all_has_been_well_for_a_while() {
    for mode in [HELD, DOWN] {
        assert_eq!(after(mode, WELL, 100), mode);
        assert_eq!(after(mode, WELL, 101), Mode::Flying);
        assert_ne!(after(mode, with(|c| c.soundness = Soundness::Bridged), 1400), Mode::Flying);
    }
    for reason in [Reason::Geofence, Reason::Battery, Reason::Saturated] {
        assert_eq!(after(Mode::LevelAndDown(reason), WELL, 2000), Mode::LevelAndDown(reason), "that is for good");
    }
    // One bad setpoint in two is never well for as long.
    let mut supervisor = in_mode(HELD);
    for tick in 0..1400 {
        let reference = if tick % 20 < 10 { ReferenceReport::Bad } else { ReferenceReport::Sound };
        assert_eq!(supervisor.step(&CONFIG, &Conditions { now: WELL.now + tick, reference, ..WELL }).mode, HELD);
    }
}

#[test]
fn a_craft_that_cannot_be_levelled_stops() {
    for mode in [Mode::Flying, HELD, DOWN] {
        let lost = with(|c| (c.levels, c.link_silence_ticks) = (false, None));
        assert_eq!(after(mode, lost, 0), Mode::Stopped(Reason::LinkLost));
    }
}

#[test]
fn without_a_place_only_the_attitude_is_flown() {
    for (soundness, action) in [
        (Soundness::Sound, Action::Brake),
        (Soundness::Bridged, Action::Brake),
        (Soundness::AttitudeOnly, Action::Level),
    ] {
        assert_eq!(in_mode(DOWN).step(&CONFIG, &Conditions { soundness, ..WELL }).action, action);
    }
}

#[test]
fn on_the_ground_nothing_but_arming_turns_the_motors() {
    for mode in OFF {
        for conditions in [WELL, with(|c| c.landed = true), with(|c| c.reference = ReferenceReport::Bad)] {
            assert_eq!(after(mode, conditions, 200), mode);
        }
        assert_eq!(after(mode, with(|c| c.fault = Some(Fault::HardFault)), 0), FAULTED);
    }
    let rows = [
        (WELL, Mode::Flying),
        (with(|c| c.soundness = Soundness::AttitudeLost), Mode::Armed),
        (with(|c| c.soundness = Soundness::Bridged), Mode::Armed),
        (with(|c| c.reference = ReferenceReport::Missing), Mode::Armed),
        (with(|c| c.reference = ReferenceReport::Bad), Mode::Stopped(Reason::BadReference)),
        (with(|c| c.link_silence_ticks = None), Mode::Stopped(Reason::LinkLost)),
        (with(|c| c.upright = 0.4), Mode::Tumbled(Tumble::Tilted)),
        (with(|c| c.starts_near = false), Mode::Stopped(Reason::StartTooFar)),
        (with(|c| c.fault = Some(Fault::HardFault)), FAULTED),
    ];
    for (conditions, expected) in rows {
        assert_eq!(after(Mode::Armed, conditions, 0), expected, "{conditions:?}");
    }
    assert_eq!(after(Mode::Armed, with(|c| c.overrun = true), 2), Mode::Stopped(Reason::Overrun));
}

#[test]
fn requests() {
    for mode in MODES {
        let mut armed = in_mode(mode);
        armed.arm(2000);
        let expected = if mode.motors_allowed() || mode == FAULTED { mode } else { Mode::Armed };
        assert_eq!(armed.mode(), expected, "arm in {mode:?}");
        let mut disarmed = in_mode(mode);
        disarmed.disarm(2000);
        let expected = if mode == FAULTED { FAULTED } else { Mode::OnGround };
        assert_eq!(disarmed.mode(), expected, "disarm in {mode:?}");
    }
}

#[test]
fn a_step_without_a_command_is_levelled_or_stops() {
    for mode in MODES {
        for levels in [true, false] {
            let verdict = in_mode(mode).step_failed(2000, levels);
            let expected = match mode {
                Mode::Flying | HELD if levels => Mode::LevelAndDown(Reason::StepFailed),
                DOWN if levels => DOWN,
                Mode::Flying | HELD | DOWN | Mode::Armed => Mode::Stopped(Reason::StepFailed),
                off => off,
            };
            assert_eq!(verdict.mode, expected, "{mode:?}");
            assert_eq!(verdict.action, if expected.is_in_air() { Action::Level } else { Action::Off });
        }
    }
}

#[test]
fn a_reference_that_fails_in_a_step_is_held_against_or_stops() {
    for mode in MODES {
        for levels in [true, false] {
            let verdict = in_mode(mode).reference_failed(2000, levels);
            let expected = match mode {
                Mode::Flying if levels => HELD,
                Mode::Flying | Mode::Armed => Mode::Stopped(Reason::BadReference),
                other => other,
            };
            assert_eq!(verdict.mode, expected, "{mode:?}");
            let stopped = in_mode(mode).stop(Reason::LinkLost, 2000).mode;
            assert_eq!(stopped, if mode.motors_allowed() { Mode::Stopped(Reason::LinkLost) } else { mode });
        }
    }
}

#[test]
fn the_first_of_several_reasons_is_named() {
    let mut seen = with(|c| {
        (c.fault, c.soundness) = (Some(Fault::HardFault), Soundness::AttitudeLost);
        (c.link_silence_ticks, c.reference, c.position_m.x) = (None, ReferenceReport::Bad, 9.0);
    });
    assert_eq!(after(Mode::Flying, seen, 0), FAULTED);
    seen.fault = None;
    assert_eq!(after(Mode::Flying, seen, 0), Mode::Stopped(Reason::AttitudeLost));
    seen.soundness = Soundness::AttitudeOnly;
    assert_eq!(after(Mode::Flying, seen, 0), Mode::LevelAndDown(Reason::StateLost));
    seen.soundness = Soundness::Sound;
    assert_eq!(after(Mode::Flying, seen, 0), Mode::Holding(Reason::LinkLost));
    seen.link_silence_ticks = Some(0);
    assert_eq!(after(Mode::Flying, seen, 0), HELD);
    seen.reference = ReferenceReport::Sound;
    assert_eq!(after(Mode::Flying, seen, 0), Mode::Holding(Reason::Geofence));
}
