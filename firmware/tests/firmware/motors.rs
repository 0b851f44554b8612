//! The motors' driver on channels that play a timer: which duties are set, and that every fault ends with all off.

use std::io::ErrorKind;

use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::pwm::{Mock, Transaction};
use quatrack_firmware::drivers::battery::CellVoltage;
use quatrack_firmware::drivers::motors::{Driven, Forces, MotorError, Motors};
use quatrack_firmware::drivers::thrust_curve::ThrustCurve;

/// Full duty of the Crazyflie's timers.
const FULL: u16 = 256;
const CURVE: ThrustCurve = ThrustCurve::CRAZYFLIE_2_1;
/// Force of each motor at hover, N: 2.3992 V by an independent solver.
const HOVER_N: f32 = 0.029 * 9.81 / 4.0;
const BROKEN: MockError = MockError::Io(ErrorKind::BrokenPipe);

type Steps = Vec<Transaction>;

fn set(counts: u16) -> Steps {
    vec![Transaction::max_duty_cycle(FULL), Transaction::set_duty_cycle(counts)]
}

fn off() -> Steps {
    vec![Transaction::set_duty_cycle(0)]
}

/// Four channels that expect to be turned off at the start, and then the given steps of each.
fn motors(after: [Steps; 4]) -> (Motors<Mock>, Vec<Mock>) {
    let channels = after.map(|after| Mock::new(&[off(), after].concat()));
    (Motors::new(channels.clone(), CURVE).expect("every channel answers"), channels.to_vec())
}

fn done(channels: Vec<Mock>) {
    channels.into_iter().for_each(|mut channel| channel.done());
}

#[test]
fn each_force_sets_its_own_channel() {
    // Volts of an independent solver over 3.7 V, times 256: 0.7739, 2.3992, 3.0799 V.
    let (mut motors, channels) = motors([set(0), set(54), set(166), set(213)]);
    let forces = [0.0, 0.012_817_578, HOVER_N, 0.12];
    assert_eq!(motors.drive(&forces, CellVoltage::NOMINAL), Ok(Driven::Whole));
    done(channels);
}

#[test]
fn a_drained_battery_takes_more_duty_and_never_more_than_all() {
    // 2.3992 V of 3.2 V; 3.0799 V of 2.9 V.
    let (mut steady, channels) = motors([set(192), set(192), set(192), set(192)]);
    assert_eq!(steady.drive(&[HOVER_N; 4], CellVoltage::new(3.2).unwrap()), Ok(Driven::Whole));
    done(channels);
    let (mut short, channels) = motors([set(FULL), set(212), set(FULL), set(212)]);
    let driven = short.drive(&[0.12, HOVER_N, 0.12, HOVER_N], CellVoltage::new(2.9).unwrap());
    assert_eq!(driven, Ok(Driven::BatteryShort));
    done(channels);
}

#[test]
fn a_force_that_is_no_number_turns_all_off_before_any_is_set() {
    for (place, force) in [(0, f32::NAN), (1, f32::INFINITY), (2, f32::NEG_INFINITY), (3, f32::NAN)] {
        let (mut motors, channels) = motors([off(), off(), off(), off()]);
        let mut forces: Forces = [0.05; 4];
        forces[place] = force;
        match motors.drive(&forces, CellVoltage::NOMINAL) {
            Err(MotorError::NotFinite { motor, .. }) => assert_eq!(usize::from(motor), place + 1),
            other => panic!("{other:?}"),
        }
        done(channels);
    }
}

#[test]
fn a_channel_that_refuses_turns_the_others_off() {
    let refuses = |counts| Transaction::set_duty_cycle(counts).with_error(BROKEN);
    let stuck = vec![Transaction::max_duty_cycle(FULL), refuses(166), refuses(0)];
    let (mut motors, channels) = motors([[set(166), off()].concat(), stuck, off(), off()]);
    let refused = motors.drive(&[HOVER_N; 4], CellVoltage::NOMINAL);
    assert_eq!(refused, Err(MotorError::Channel { motor: 2, error: BROKEN }));
    done(channels);
}

#[test]
fn a_stop_reaches_the_channels_behind_one_that_refuses() {
    let refuses = vec![Transaction::set_duty_cycle(0).with_error(BROKEN)];
    let (mut motors, channels) = motors([refuses, off(), off(), off()]);
    assert_eq!(motors.stop(), Err(BROKEN));
    done(channels);
}
