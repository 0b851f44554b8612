//! Trials that the Crazyflie's controller has to survive, through its C interface: far goals, turns, any tilt, weak
//! motors, a wall, the ground, odd setpoints. In vacuum, told the craft's usual air: the wrong one.

use std::f64::consts::PI;

use nalgebra::{UnitQuaternion, Vector3};
use quatrack_crazyflie::abi::Setpoint;
use quatrack_simulation::plant::{Craft, Ground, RigidState};

use crate::setpoints::flight::{CRAFTS, DESCENDING, FLYING, Flight, MapInto as _, mode};
use crate::setpoints::orders::figure_eight;
use crate::setpoints::sent::{full_state, position};

/// The extremes on a way to a goal.
#[derive(Debug, Default)]
struct Way {
    beyond_m: f64,
    tilt_deg: f64,
    speed_m_s: f64,
    lowest_m: f64,
    left_m: f64,
}

/// Goes to a setpoint at `goal` for so many seconds.
fn way(flight: &mut Flight, setpoint: &Setpoint, goal: Vector3<f64>, seconds: u32) -> Way {
    let mut found = Way { lowest_m: f64::INFINITY, ..Way::default() };
    let start = flight.state.position_m;
    let ahead = (goal - start).try_normalize(1e-9).unwrap_or_default();
    for _ in 0..100 * seconds {
        flight.hold(setpoint, 10);
        let state = &flight.state;
        found.beyond_m = found.beyond_m.max((state.position_m - goal).dot(&ahead));
        found.tilt_deg = found.tilt_deg.max(state.thrust_axis().z.clamp(-1.0, 1.0).acos().to_degrees());
        found.speed_m_s = found.speed_m_s.max(state.velocity_m_s.norm());
        found.lowest_m = found.lowest_m.min(state.position_m.z);
    }
    found.left_m = (flight.state.position_m - goal).norm();
    found
}

/// Hovering at 1 m.
fn hovering(name: &str, lag_s: f64) -> Flight {
    let mut flight = Flight::of(name, 0, lag_s);
    flight.hold(&position([0.0, 0.0, 1.0], 0.0), 500);
    flight
}

#[test]
fn a_goal_at_any_distance_is_reached_within_limits_at_any_lag() {
    for name in CRAFTS {
        for lag_s in [0.02, 0.0635, if name.ends_with("brushless") { 0.07 } else { 0.126 }] {
            for (distance, seconds) in [(0.1, 5), (1.0, 5), (4.5, 8), (50.0, 34)] {
                let mut flight = hovering(name, lag_s);
                let goal = [distance, 0.0, 1.0];
                let found = way(&mut flight, &position(goal, 0.0), goal.map_into(), seconds);
                println!("{name} {lag_s} {distance}: {found:?}");
                assert!(found.beyond_m <= 0.01 && found.left_m < 0.02, "{name}, {lag_s} s, {distance} m: {found:?}");
                assert!(
                    found.tilt_deg <= 55.0 && found.speed_m_s <= 2.25,
                    "{name}, {lag_s} s, {distance} m: {found:?}"
                );
            }
        }
    }
}

#[test]
fn a_turn_with_a_step_keeps_height() {
    for name in CRAFTS {
        for yaw in [45.0, 90.0, 135.0, 180.0] {
            for distance in [0.1, 0.5, 1.0, 2.0] {
                let mut flight = hovering(name, 0.0);
                let goal = [distance, 0.0, 1.0];
                let found = way(&mut flight, &position(goal, yaw), goal.map_into(), 6);
                println!("{name} {yaw} {distance}: {found:?}");
                assert!(found.lowest_m > 0.95 && found.left_m < 0.02 && found.tilt_deg < 45.0, "{name}: {found:?}");
            }
        }
    }
}

#[test]
fn it_recovers_from_any_tilt() {
    for name in CRAFTS {
        for tilt_deg in [60.0_f64, 120.0, 179.0] {
            let mut flight = Flight::of(name, 0, 0.0);
            flight.state.position_m.z = 50.0;
            flight.hold(&position([0.0, 0.0, 50.0], 0.0), 500);
            let axis = Vector3::new(0.8, 0.6, 0.0) * tilt_deg.to_radians();
            flight.state.attitude = UnitQuaternion::from_scaled_axis(axis);
            flight.hold(&position([0.0, 0.0, 50.0], 0.0), 8000);
            let left_m = (flight.state.position_m - Vector3::z() * 50.0).norm();
            assert!(left_m < 0.05, "{name}, {tilt_deg} degrees: {left_m} m");
        }
    }
}

/// The motors give a share each.
fn weak(flight: &mut Flight, setpoint: &Setpoint, steps: u32, shares: [f64; 4]) {
    for step in 0..steps {
        if step % 10 == 0 {
            flight.send(setpoint);
        }
        let sent = flight.sent;
        let commands_n =
            flight.firmware.step(&flight.state, Some(&sent)).component_mul(&nalgebra::Vector4::from(shares));
        flight.state = flight.craft.hold(&flight.state, &commands_n, 0.0, 1e-3);
    }
}

#[test]
fn weak_motors_are_made_good() {
    for name in CRAFTS {
        for (shares, most_m) in [([0.75; 4], 0.5), ([1.0, 0.7, 1.0, 1.0], 0.6)] {
            let mut flight = hovering(name, 0.0);
            let mut largest_m = 0.0_f64;
            for _ in 0..100 {
                weak(&mut flight, &position([0.0, 0.0, 1.0], 0.0), 100, shares);
                largest_m = largest_m.max((flight.state.position_m - Vector3::z()).norm());
            }
            let left_m = (flight.state.position_m - Vector3::z()).norm();
            println!("{name} {shares:?}: {largest_m:.3} {left_m:.4}");
            assert!(largest_m < most_m && left_m < 0.02, "{name}, {shares:?}: {largest_m} m, {left_m} m in the end");
        }
    }
}

#[test]
fn a_wall_is_leaned_against_and_left() {
    for name in CRAFTS {
        let (mut flight, mut tilt_deg) = (hovering(name, 0.0), 0.0_f64);
        let goal = position([1.0, 0.0, 1.0], 0.0);
        for _ in 0..1000 {
            for _ in 0..10 {
                flight.send(&goal);
                flight.pass(1);
                if flight.state.position_m.x > 0.6 {
                    flight.state.position_m.x = 0.6;
                    flight.state.velocity_m_s.x = flight.state.velocity_m_s.x.min(0.0);
                }
            }
            tilt_deg = tilt_deg.max(flight.state.thrust_axis().z.acos().to_degrees());
        }
        let height_m = flight.state.position_m.z;
        assert!(tilt_deg < 60.0 && (height_m - 1.0).abs() < 0.1, "{name}: {tilt_deg} degrees, {height_m} m");
        // It opens.
        let found = way(&mut flight, &goal, Vector3::new(1.0, 0.0, 1.0), 5);
        println!("{name} wall: {tilt_deg:.1} degrees, then {found:?}");
        assert!(found.left_m < 0.02 && found.beyond_m < 0.3, "{name}: {found:?}");
    }
}

#[test]
fn a_wait_on_the_ground_winds_nothing_up() {
    for name in CRAFTS {
        for (aside_m, below_m, seconds) in [(0.05_f32, 0.005_f32, 2), (0.2, 0.02, 30)] {
            let mut flight = Flight::of(name, 0, 0.0);
            flight.craft = Craft::new(&flight.vehicle).with_load(Ground::under(&flight.vehicle));
            let standing = Ground::standing_height_m() as f32;
            flight.state = RigidState::at_rest(Vector3::new(0.0, 0.0, f64::from(standing)), 0.0);
            flight.hold(&Setpoint::OFF, 500);
            flight.hold(&position([aside_m, 0.0, standing - below_m], 0.0), 1000 * seconds);
            let goal = [0.0, 0.0, 1.0];
            let mut largest_m = 0.0_f64;
            for _ in 0..600 {
                flight.hold(&position(goal, 0.0), 10);
                largest_m = largest_m.max(flight.state.position_m.xy().norm());
            }
            let left_m = (flight.state.position_m - goal.map_into()).norm();
            println!("{name} {aside_m} {seconds}: {largest_m:.3} {left_m:.4}");
            assert!(largest_m < f64::from(aside_m) + 0.06 && left_m < 0.02, "{name}: {largest_m} m, {left_m} m");
        }
    }
}

/// Largest distance from an eight at 2.1 m/s and its mean over the last 4 of 10 s, with setpoints at the times that `next` gives,
/// ms; each evaluated so many ms off.
fn eight_m(next: impl Fn(u32) -> u32, off_ms: impl Fn(u32) -> f32) -> f64 {
    let mut flight = Flight::hovering();
    let (mut due, mut number, mut sum_m) = (0, 0, 0.0);
    for step in 0..10_000_u32 {
        let t_s = step as f32 * 1e-3;
        if step >= due {
            flight.send(&figure_eight(t_s + 1e-3 * off_ms(number)).setpoint());
            due += next(number);
            number += 1;
        }
        flight.pass(1);
        if step >= 6000 {
            sum_m += (flight.state.position_m - figure_eight(t_s + 1e-3).position.map_into()).norm();
        }
    }
    sum_m / 4000.0
}

#[test]
fn odd_late_missing_and_jittered_setpoints_cost_little() {
    let even = eight_m(|_| 10, |_| 0.0);
    println!("even: {even:.6}");
    for period in [5, 7, 13, 15, 17, 21] {
        let odd = eight_m(|_| period, |_| 0.0);
        println!("{period} ms: {odd:.6}");
        assert!(odd < 1.1 * even, "{period} ms: {odd} m, even {even} m");
    }
    let late = eight_m(
        |k| {
            if k % 10 == 8 {
                11
            } else if k % 10 == 9 {
                9
            } else {
                10
            }
        },
        |_| 0.0,
    );
    let missing = eight_m(|k| if k % 10 == 9 { 20 } else { 10 }, |_| 0.0);
    // Half a millisecond either way, by a rule that repeats after 31 setpoints.
    let jittered = eight_m(|_| 10, |k| (k * 13 % 31) as f32 / 31.0 - 0.5);
    println!("late {late:.6}, missing {missing:.6}, jittered {jittered:.6}");
    assert!(late < 1.1 * even && missing < 1.1 * even, "{late} {missing} {even}");
    assert!(jittered < 1.5 * even, "{jittered} {even}");
}

#[test]
fn a_turning_attitude_with_a_rate_of_zero_is_followed() {
    let mut flight = Flight::hovering();
    let mut largest_deg = 0.0_f64;
    for step in 0..600_u32 {
        let heading = PI / 2.0 * 0.01 * f64::from(step);
        let q = UnitQuaternion::from_euler_angles(0.0, 0.0, heading as f32);
        let q = q.quaternion();
        flight.send(&full_state([[0.0, 0.0, 1.0], [0.0; 3], [0.0; 3]], [q.i, q.j, q.k, q.w], 0.0));
        flight.pass(10);
        let behind = heading + PI / 2.0 * 0.01 - flight.euler_deg()[2].to_radians();
        if step > 200 {
            largest_deg = largest_deg.max(((behind + PI).rem_euclid(2.0 * PI) - PI).abs().to_degrees());
        }
    }
    println!("behind by {largest_deg:.2} degrees");
    assert!(largest_deg < 5.0, "{largest_deg} degrees");
}

#[test]
fn a_yaw_goes_on_for_300_turns_and_one_that_is_no_number_brakes() {
    let mut flight = hovering("crazyflie-2.1", 0.0);
    flight.hold(&position([0.0, 0.0, 1.0], 300.0 * 360.0 + 60.0), 3000);
    assert_eq!(mode(), FLYING);
    assert!((flight.euler_deg()[2] - 60.0).abs() < 2.0, "{:?}", flight.euler_deg());
    let mut bad = position([0.0, 0.0, 1.0], 60.0);
    bad.attitude_rate.yaw = f32::NAN;
    flight.hold(&bad, 50);
    assert_eq!(mode(), DESCENDING);
    drop(flight);
    // In flight at speed: it comes to rest, and goes down.
    let mut flight = hovering("crazyflie-2.1", 0.0);
    flight.state.velocity_m_s.x = 1.4;
    flight.hold(&position([3.0, 0.0, 1.0], 0.0), 300);
    let begun = flight.state.position_m.x;
    flight.hold(
        &Setpoint { position: quatrack_crazyflie::abi::Vector { z: f32::NAN, ..Default::default() }, ..bad },
        3000,
    );
    let v = flight.state.velocity_m_s;
    assert!(v.xy().norm() < 0.05 && (v.z + 0.3).abs() < 0.05, "{v}");
    assert!(flight.state.position_m.x - begun < 1.2, "{}", flight.state.position_m.x - begun);
}
