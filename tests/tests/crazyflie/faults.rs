//! Faults flown through the Crazyflie object: a recoverable one is not lost, any other ends with the motors off, and the
//! log says why.

use std::sync::atomic::Ordering::Relaxed;

use nalgebra::{UnitQuaternion, Vector3};
use quatrack_crazyflie::abi::{Attitude, Quaternion, SensorData, Setpoint, State, Vector};
use quatrack_crazyflie::ffi;
use quatrack_simulation::faults::{Crafts, Row, fly_object, kinds};
use quatrack_simulation::plant::RigidState;

use crate::setpoints::flight::{CRAFTS, DESCENDING, FLYING, Flight, mode};
use crate::setpoints::sent::{alt_hold, full_state, hover, manual, position, velocity_world, z_distance};

const STOPPED: u8 = 3;
/// Longest time until the log has the values of a step, ms: each call between control steps writes one part of four, or,
/// four times in a row at most, none.
const LOGGED_MS: u32 = 40;

fn reason() -> u16 {
    ffi::quatrack.log.reason.load(Relaxed)
}

/// Flies the kinds of these names on all crafts.
fn flown(names: &[&str], assert: impl Fn(&Row)) {
    let kinds = kinds();
    for craft in CRAFTS {
        let crafts = Crafts::by_name(craft).unwrap();
        for name in names {
            let fault = kinds.iter().find(|fault| fault.name == *name).unwrap();
            let row = fly_object(fault, &crafts).unwrap();
            println!("{row:?}");
            assert!(row.is_as_promised(), "{row:?}");
            assert(&row);
        }
    }
}

#[test]
fn bad_estimates_are_bridged_and_the_flight_goes_on() {
    let names = [
        "state: one NaN position",
        "state: NaN one sample in two",
        "state: NaN one sample in four",
        "state: NaN for 300 ms",
        "state: NaN for 500 ms",
        "state: velocity of 100 m/s for 300 ms",
        "state: zero quaternion for 300 ms",
        "gyro: NaN for 300 ms",
        "gyro: saturated for 100 ms",
    ];
    flown(&names, |row| {
        assert_eq!(row.end_state.to_string(), "flying", "{row:?}");
        assert!(row.detected_ms.is_some_and(|ms| ms <= LOGGED_MS), "{row:?}");
    });
}

#[test]
fn quaternions_of_other_norms_are_scaled_and_flown() {
    let names = [
        "state: quaternion of norm 0.71",
        "state: quaternion of norm 0.98",
        "state: quaternion of norm 1.05",
        "state: quaternion of norm 1.39",
    ];
    flown(&names, |row| {
        assert_eq!(row.end_state.to_string(), "flying", "{row:?}");
        assert!(row.farthest_m < 0.2, "{row:?}");
    });
}

#[test]
fn an_estimate_that_is_lost_for_good_ends_on_the_ground() {
    let names = ["state: NaN position for good", "state: NaN velocity for good", "state: stands still for good"];
    flown(&names, |row| {
        assert_eq!(row.end_state.to_string(), "stopped (landed)", "{row:?}");
        // Half a second of bridging, and frozen ones are seen after 100 ms.
        assert!(row.detected_ms.is_some_and(|ms| ms <= 102 + LOGGED_MS), "{row:?}");
    });
}

#[test]
fn faults_that_cannot_be_flown_end_with_motors_off() {
    for (name, most_ms, end) in [
        ("state: attitude absent for good", 5100, "stopped (no attitude)"),
        ("gyro: NaN for good", 700, "stopped (no body rates)"),
        ("motor: one dead", 8000, "tumbled"),
    ] {
        flown(&[name], |row| {
            assert!(row.motors_off_ms.is_some_and(|ms| ms <= most_ms), "{row:?}");
            assert!(row.end_state.to_string().starts_with(end), "{row:?}");
        });
    }
}

#[test]
fn a_bad_setpoint_brakes_within_a_metre_and_a_half_and_one_for_a_moment_is_flown_through() {
    for name in
        ["setpoint: NaN position at 3 m/s", "setpoint: NaN yaw rate at 1.4 m/s", "setpoint: infinite acceleration"]
    {
        flown(&[name], |row| {
            assert_eq!(row.end_state.to_string(), "stopped (landed)", "{row:?}");
            assert!(row.farthest_m < 1.5, "{row:?}");
        });
    }
    flown(&["setpoint: bad for 50 ms"], |row| assert_eq!(row.end_state.to_string(), "flying", "{row:?}"));
}

/// The figures of a setpoint.
fn figures(setpoint: &mut Setpoint) -> [&mut f32; 23] {
    let Setpoint { attitude: a, attitude_rate: r, attitude_quaternion: q, thrust, position, velocity, .. } = setpoint;
    let Setpoint { acceleration, jerk, .. } = setpoint;
    let [Vector { x: x0, y: y0, z: z0, .. }, Vector { x: x1, y: y1, z: z1, .. }] = [position, velocity];
    let [Vector { x: x2, y: y2, z: z2, .. }, Vector { x: x3, y: y3, z: z3, .. }] = [acceleration, jerk];
    let Attitude { roll: a0, pitch: a1, yaw: a2, .. } = a;
    let Attitude { roll: r0, pitch: r1, yaw: r2, .. } = r;
    let Quaternion { x, y, z, w } = q;
    [thrust, x0, y0, z0, x1, y1, z1, x2, y2, z2, x3, y3, z3, a0, a1, a2, r0, r1, r2, x, y, z, w]
}

#[test]
fn a_nan_in_any_field_of_any_setpoint_is_bad() {
    let thrust = Flight::hovering().hover_thrust();
    let setpoints = [
        position([0.0, 0.0, 1.0], 10.0),
        full_state([[0.0, 0.0, 1.0], [0.0; 3], [0.0; 3]], [0.0, 0.0, 0.0, 1.0], 0.3),
        velocity_world([0.2, 0.0, 0.0], 10.0),
        hover([0.2, 0.0], 10.0, 1.0),
        z_distance([2.0, 0.0, 10.0], 1.0),
        alt_hold([2.0, 0.0, 10.0], 0.0),
        manual([2.0, 0.0, 10.0], thrust, false),
        manual([2.0, 0.0, 10.0], thrust, true),
    ];
    let mut flight = Flight::hovering();
    for setpoint in setpoints {
        for field in 0..23 {
            flight.hold(&setpoint, 150);
            assert_eq!(mode(), FLYING, "{field} of {setpoint:?}");
            let mut bad = setpoint;
            *figures(&mut bad)[field] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY][field % 3];
            flight.hold(&bad, 50);
            assert_eq!((mode(), reason()), (DESCENDING, 1), "{field} of {setpoint:?}");
        }
    }
}

#[test]
fn from_any_course_it_comes_to_rest_and_goes_down() {
    for name in CRAFTS {
        for velocity in [[3.0, 0.0, 0.0], [0.0, -2.0, 1.0], [1.5, 1.5, -0.5], [0.0; 3]] {
            let mut flight = Flight::of(name, 0, 0.0);
            flight.state.position_m.z = 5.0;
            let mut at = [0.0, 0.0, 5.0_f32];
            for _ in 0..200 {
                flight.hold(&full_state([at, velocity, [0.0; 3]], [0.0, 0.0, 0.0, 1.0], 0.0), 10);
                at = [0, 1, 2].map(|axis| at[axis] + 0.01 * velocity[axis]);
            }
            let (begun, bad) = (flight.state.position_m, Setpoint { thrust: f32::NAN, ..flight.sent });
            let mut farthest_m = 0.0_f64;
            for _ in 0..400 {
                flight.hold(&bad, 10);
                farthest_m = farthest_m.max((flight.state.position_m - begun).xy().norm());
            }
            let v = flight.state.velocity_m_s;
            println!("{name} {velocity:?}: {farthest_m:.3} m, then {v}");
            assert!(
                farthest_m < 1.5 && v.xy().norm() < 0.05 && (v.z + 0.3).abs() < 0.03,
                "{name}: {farthest_m} m, {v}"
            );
        }
    }
}

#[test]
fn tumbled_it_stays_off_until_a_new_flight() {
    let mut flight = Flight::hovering();
    let here = position([0.0, 0.0, 1.0], 0.0);
    let upside_down = UnitQuaternion::from_euler_angles(3.0, 0.0, 0.0);
    for step in 0..1000 {
        flight.hold(&here, 10);
        (flight.state.attitude, flight.state.position_m) = (upside_down, Vector3::z());
        (flight.state.velocity_m_s, flight.state.body_rates_rad_s) =
            (Vector3::zeros(), Vector3::x() * 1e-2 * f64::from(step % 3));
        if mode() == STOPPED {
            // 0.6 s upside down, and the log's delay.
            assert!((60..=65).contains(&step), "{step}");
            break;
        }
    }
    assert_eq!((mode(), reason()), (STOPPED, 10));
    flight.state.attitude = UnitQuaternion::identity();
    flight.hold(&here, 500);
    assert!(flight.is_off() && mode() == STOPPED);
    // It has been turning freely, which no gyroscope shows without noise.
    flight.state = RigidState::at_rest(Vector3::z(), 0.0);
    flight.hold(&Setpoint::OFF, 20);
    flight.hold(&here, 50);
    assert_eq!((mode(), reason()), (FLYING, 0));
    assert!(!flight.is_off());
}

#[test]
fn without_an_attitude_it_does_not_take_off_and_says_so() {
    let mut flight = Flight::hovering();
    flight.hold(&Setpoint::OFF, 20);
    let setpoint = position([0.0, 0.0, 1.0], 0.0);
    let mut fly = |state: &State, steps: u32| {
        let mut turned = false;
        for _ in 0..steps {
            let step = flight.firmware.next_step();
            // A gyroscope that works is never quite still.
            let gyro = [if step % 4 < 2 { 0.1 } else { -0.1 }, 0.0, 0.0];
            let sensors = SensorData { gyro, ..SensorData::default() };
            let setpoint = Setpoint { timestamp: step, ..setpoint };
            turned |= flight.firmware.step_given(state, &sensors, &setpoint).sum() > 0.0;
        }
        turned
    };
    // The firmware's state before its estimator has said anything: a quaternion of zeros.
    assert!(!fly(&State::default(), 100));
    assert_eq!((mode(), reason()), (STOPPED, 0));
    let level = State { attitude_quaternion: Quaternion { w: 1.0, ..Default::default() }, ..Default::default() };
    assert!(fly(&level, 50));
    assert_eq!(mode(), FLYING);
}
