//! The supervisor over random flights: whatever happens, a command passes only where everything is as it should be.

use proptest::option;
use proptest::prelude::*;
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::{Conditions, Config, Fault, Mode, StepReport, Supervisor};
use quatrack::{Command, Tick};

const CONFIG: Config = Config { state_age_max_ticks: 5, link_silence_max_ticks: 8, overruns_tolerated: 1 };

#[derive(Clone, Debug)]
enum Event {
    Arm,
    Disarm,
    Tick(Conditions),
}

fn age(max: Tick) -> impl Strategy<Value = Option<Tick>> {
    prop_oneof![20 => (0..=max).prop_map(Some), 1 => Just(Some(max + 1)), 1 => Just(Some(Tick::MAX)), 1 => Just(None)]
}

fn event() -> impl Strategy<Value = Event> {
    let step = prop_oneof![
        20 => Just(StepReport::Command),
        1 => Just(StepReport::NoReference),
        1 => Just(StepReport::Failed)
    ];
    let fault = option::weighted(0.01, Just(Fault::HardFault));
    let conditions = (age(8), age(5), step, prop::bool::weighted(0.1), fault).prop_map(
        |(link_silence_ticks, state_age_ticks, step, overrun, fault)| Conditions {
            link_silence_ticks,
            state_age_ticks,
            step,
            overrun,
            fault,
        },
    );
    prop_oneof![3 => Just(Event::Arm), 1 => Just(Event::Disarm), 20 => conditions.prop_map(Event::Tick)]
}

proptest! {
    #[test]
    fn a_command_passes_only_where_all_is_sound(events in prop::collection::vec(event(), 1..200)) {
        let command = Command { thrust_m_s2: 9.81, body_rates_rad_s: Vector3::new(1.0, 2.0, 3.0) };
        let mut supervisor = Supervisor::new();
        // What an observer knows without looking into the supervisor.
        let (mut asked, mut overruns, mut faulted) = (false, 0, false);
        for event in events {
            match event {
                Event::Arm => {
                    // Only what overruns after arming counts.
                    overruns = if asked { overruns } else { 0 };
                    asked |= supervisor.arm(&CONFIG, Some(0)).is_ok();
                }
                Event::Disarm => {
                    supervisor.disarm();
                    asked = false;
                }
                Event::Tick(seen) => {
                    overruns = if seen.overrun { overruns + 1 } else { 0 };
                    faulted |= seen.fault.is_some();
                    let verdict = supervisor.tick(&CONFIG, &seen);
                    let passed = verdict.gate(&command);
                    if passed == command {
                        prop_assert!(asked && !faulted, "nobody armed, or there was a fault");
                        prop_assert!(seen.step == StepReport::Command);
                        prop_assert!(seen.state_age_ticks.is_some_and(|age| age <= 5));
                        prop_assert!(seen.link_silence_ticks.is_some_and(|silence| silence <= 8));
                    } else {
                        prop_assert_eq!(passed, Command::ZERO, "never anything in between");
                    }
                    // After a stop a new request is needed.
                    asked &= verdict.mode.motors_allowed();
                    prop_assert!(!faulted || matches!(verdict.mode, Mode::Faulted(_)), "a fault is for good");
                    prop_assert!(overruns <= 2 || !verdict.mode.motors_allowed(), "three overruns in a row");
                }
            }
        }
    }

    #[test]
    fn while_all_is_sound_an_armed_craft_flies(ticks in 1_usize..50) {
        let sound = Conditions {
            link_silence_ticks: Some(8),
            state_age_ticks: Some(5),
            step: StepReport::Command,
            overrun: false,
            fault: None,
        };
        let mut supervisor = Supervisor::new();
        prop_assert_eq!(supervisor.arm(&CONFIG, Some(8)), Ok(()));
        for _ in 0..ticks {
            prop_assert_eq!(supervisor.tick(&CONFIG, &sound).mode, Mode::Flying);
        }
    }
}
