//! Positions, velocities and full states that a script sends, and their effect after it stops.

use std::f64::consts::PI;

use nalgebra::{UnitQuaternion, Vector3};
use quatrack_crazyflie::abi::{Mode, Modes, Setpoint};

use super::flight::{CRAFTS, DESCENDING, FLYING, Flight, MapInto, assert_near, mode};
use super::sent::{
    FlightMode, NOTHING, full_state, hover, level_out, manual, position, rpyt, velocity_world, z_distance,
};

#[test]
fn velocities_turn_with_the_craft_or_not() {
    for (is_ahead, wanted) in [(true, [0.0, 0.4]), (false, [0.4, 0.0])] {
        let mut flight = Flight::hovering();
        flight.hold(&position([0.0, 0.0, 1.0], 90.0), 3000);
        let setpoint = if is_ahead { hover([0.4, 0.0], 0.0, 1.1) } else { velocity_world([0.4, 0.0, 0.0], 0.0) };
        flight.hold(&setpoint, 2500);
        let v = flight.state.velocity_m_s;
        assert_near(&[v.x, v.y, v.z], &[wanted[0], wanted[1], 0.0], 0.02);
        let height = if is_ahead { 1.1 } else { 1.0 };
        assert!((flight.state.position_m.z - height).abs() < 0.03, "{}", flight.state.position_m);
    }
    let (mut flight, mut setpoint) = (Flight::hovering(), Setpoint::OFF);
    let flown = FlightMode { pos_hold: true, alt_hold: true, ..FlightMode::default() };
    rpyt(&mut setpoint, flown, [9.0, 12.0, 0.0], 32_767);
    flight.hold(&setpoint, 2000);
    // As the firmware's PID has it: the pitch that arrives is cflib's with the other sign.
    let v = flight.state.velocity_m_s;
    assert_near(&[v.x, v.y, v.z], &[-0.4, 0.3, 0.0], 0.02);
}

#[test]
fn level_out_is_flown_after_any_setpoint() {
    let hover_thrust = Flight::hovering().hover_thrust();
    let tilted = UnitQuaternion::from_euler_angles(0.1_f32, 0.0, 0.0);
    let q = tilted.quaternion();
    let cases = [
        ("angles", manual([15.0, 0.0, 60.0], hover_thrust, false), false),
        ("rates", manual([10.0, 0.0, 60.0], hover_thrust, true), false),
        ("height", z_distance([15.0, 0.0, 60.0], 1.0), true),
        ("hover", hover([0.5, 0.0], 60.0, 1.0), true),
        ("velocity", velocity_world([0.5, 0.0, 0.0], 60.0), true),
        ("position", position([0.3, 0.0, 1.0], 20.0), true),
        ("full state", full_state([[0.3, 0.0, 1.0], [0.0; 3], [0.0; 3]], [q.i, q.j, q.k, q.w], 0.0), true),
    ];
    for (name, setpoint, has_height) in cases {
        let mut flight = Flight::hovering();
        flight.hold(&setpoint, 500);
        // A stick that has just been moved, taken with its stamp.
        flight.hold(&Setpoint { thrust: setpoint.thrust + 1.0, ..setpoint }, 10);
        // No more setpoints: after half a second the supervisor levels the last one out, after two it stops the motors.
        flight.pass(500);
        let height = flight.state.position_m.z;
        (0..1500).for_each(|_| flight.step(|sent, _| level_out(sent)));
        assert_eq!(mode(), FLYING, "{name}");
        let [roll, pitch, _] = flight.euler_deg();
        assert_near(&[roll, pitch], &[0.0, 0.0], 0.5);
        assert!(flight.rates_deg_s().norm() < 5.0, "{name}: {}", flight.rates_deg_s());
        if has_height {
            assert!((flight.state.position_m.z - height).abs() < 0.05, "{name}: {height} m");
        }
        flight.step(|_, _| Setpoint::OFF);
        flight.step(|_, _| Setpoint::OFF);
        assert!(flight.is_off(), "{name}");
    }
}

#[test]
fn positions_that_lie_apart_are_gone_to() {
    for (name, is_older) in [("position", false), ("older packet", true)] {
        let mut flight = Flight::hovering();
        let mut setpoint = position([2.0, -1.0, 1.5], 60.0);
        if is_older {
            setpoint = Setpoint::OFF;
            rpyt(&mut setpoint, FlightMode { pos_set: true, ..FlightMode::default() }, [-1.0, 2.0, 60.0], 1500);
        }
        flight.hold(&setpoint, 6000);
        let p = flight.state.position_m;
        assert_near(&[p.x, p.y, p.z], &[2.0, -1.0, 1.5], 0.02);
        assert!((flight.euler_deg()[2] - 60.0).abs() < 1.0, "{name}: {:?}", flight.euler_deg());
    }
}

#[test]
fn a_yaw_that_jumps_costs_no_position() {
    for yaw in [90.0, 170.0, -170.0] {
        for name in CRAFTS {
            let mut flight = Flight::of(name, 0, 0.0);
            flight.hold(&position([0.0, 0.0, 1.0], 0.0), 500);
            let mut largest_m = 0.0_f64;
            for _ in 0..600 {
                flight.hold(&position([0.0, 0.0, 1.0], yaw), 10);
                largest_m = largest_m.max((flight.state.position_m - Vector3::z()).norm());
            }
            assert!(largest_m < 0.1, "{name}, {yaw} degrees: {largest_m} m");
            let heading = UnitQuaternion::from_euler_angles(0.0, 0.0, f64::from(yaw).to_radians());
            assert!(flight.state.attitude.angle_to(&heading) < 0.02, "{name}: {:?}", flight.euler_deg());
        }
    }
}

#[test]
fn a_velocity_that_jumps_does_not_turn_the_craft_over() {
    // A stop at full speed, or a script that starts in the middle of a figure: both differ by where the observer moves.
    for speed in [1.0_f32, 2.1, 3.0] {
        for name in CRAFTS {
            let mut flight = Flight::of(name, 0, 0.0);
            flight.hold(&position([0.0, 0.0, 1.0], 0.0), 500);
            let (mut x, mut largest_deg) = (0.0_f32, 0.0_f64);
            for _ in 0..500 {
                let motion = [[x, 0.0, 1.0], [speed, 0.0, 0.0], [0.0; 3]];
                flight.hold(&full_state(motion, [0.0, 0.0, 0.0, 1.0], 0.0), 10);
                largest_deg = largest_deg.max(flight.state.thrust_axis().z.acos().to_degrees());
                x += 0.01 * speed;
            }
            let left_m = (flight.state.position_m - [x, 0.0, 1.0].map_into()).norm();
            assert!(largest_deg < 70.0 && left_m < 0.05, "{name}, {speed} m/s: {largest_deg} degrees, {left_m} m");
        }
    }
}

#[test]
fn a_yaw_rate_of_a_full_state_is_in_radians() {
    let mut flight = Flight::hovering();
    let (rate, mut heading) = (0.8_f32, 0.0_f32);
    for _ in 0..500 {
        let q = UnitQuaternion::from_euler_angles(0.0, 0.0, heading);
        let q = q.quaternion();
        flight.send(&full_state([[0.0, 0.0, 1.0], [0.0; 3], [0.0; 3]], [q.i, q.j, q.k, q.w], rate));
        flight.pass(10);
        heading += rate * 0.01;
    }
    assert!((flight.rates_deg_s().z - f64::from(rate).to_degrees()).abs() < 3.0, "{}", flight.rates_deg_s());
    let behind = (f64::from(heading) - flight.euler_deg()[2].to_radians() + PI).rem_euclid(2.0 * PI) - PI;
    // A component of nine bits is a heading of 0.16 degrees.
    assert!(behind.abs() < 0.006, "{behind}");
}

#[test]
fn forces_and_torques_lift_the_side_that_hangs() {
    // M1 front right, M2 back right, M3 back left, M4 front left; M1 and M3 turn anticlockwise.
    for (table, motor_lag_s) in [(0, 0.0), (2, 0.02)] {
        for (tilt, stronger) in [
            ([0.1, 0.0, 0.0], [0, 1]),
            ([-0.1, 0.0, 0.0], [2, 3]),
            ([0.0, 0.1, 0.0], [0, 3]),
            ([0.0, -0.1, 0.0], [1, 2]),
            ([0.0, 0.0, -0.3], [1, 3]),
        ] {
            let mut flight = Flight::of("crazyflie-2.1", table, motor_lag_s);
            flight.hold(&position([0.0, 0.0, 1.0], 0.0), 300);
            let [roll, pitch, yaw] = tilt;
            flight.state.attitude = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
            flight.state.body_rates_rad_s = Vector3::zeros();
            let sent = flight.sent;
            flight.firmware.step(&flight.state, Some(&sent));
            let forces = flight.firmware.step(&flight.state, Some(&sent));
            let [least, most] = [false, true].map(|is_strong| {
                let side = (0..4).filter(|motor| stronger.contains(motor) == is_strong).map(|motor| forces[motor]);
                if is_strong { side.fold(f64::MAX, f64::min) } else { side.fold(0.0, f64::max) }
            });
            assert!(most > least + 1e-3, "table {table}, {tilt:?}: {forces}");
        }
    }
}

#[test]
fn modes_that_nobody_sends_are_not_guessed_at() {
    let mut flight = Flight::hovering();
    let on = Mode::ABSOLUTE;
    for modes in [
        Modes { x: on, ..NOTHING },
        Modes { x: on, y: on, z: Mode(7), ..NOTHING },
        Modes { z: on, roll: on, ..NOTHING },
        Modes { z: on, quat: Mode::VELOCITY, ..NOTHING },
    ] {
        flight.hold(&Setpoint { mode: modes, ..position([0.0, 0.0, 1.0], 0.0) }, 20);
        assert_eq!(mode(), DESCENDING, "{modes:?}");
    }
}
