//! Setpoints at every rate that a sender may have: headings that turn and courses that curve.

use super::flight::{CRAFTS, Flight};
use super::sent::position;
use quatrack_crazyflie::abi::{Mode, Modes, Setpoint};

/// The turn that is left at the end of six seconds at a rate, degrees.
fn left_of_a_turn(name: &str, period_ms: u32, rate_deg_s: f32) -> f64 {
    let mut flight = Flight::of(name, 0, 0.0);
    flight.hold(&position([0.0, 0.0, 1.0], 0.0), 500);
    for step in 0..6000 {
        if step % period_ms == 0 {
            let turned = rate_deg_s * step as f32 * 1e-3;
            flight.send(&position([0.0, 0.0, 1.0], (turned + 180.0).rem_euclid(360.0) - 180.0));
        }
        flight.pass(1);
    }
    let left = f64::from(rate_deg_s) * 6.0 - flight.euler_deg()[2];
    (left + 180.0).rem_euclid(360.0) - 180.0
}

#[test]
fn a_heading_turns_at_every_rate_of_setpoints() {
    for name in CRAFTS {
        for (period_ms, rate_deg_s) in
            [(1, 45.0), (2, 45.0), (3, 90.0), (4, 45.0), (10, 90.0), (33, 90.0), (60, 60.0), (100, 45.0)]
        {
            let left_deg = left_of_a_turn(name, period_ms, rate_deg_s);
            // A rate that is not sent is known from the headings: at most the last period of the turn is missing.
            let most = 2.0 + f64::from(rate_deg_s) * 1e-3 * f64::from(period_ms);
            assert!(left_deg.abs() < most, "{name}, every {period_ms} ms at {rate_deg_s} deg/s: {left_deg} left");
        }
    }
}

#[test]
fn a_goal_of_another_heading_is_not_overshot_at_ten_a_second() {
    let mut flight = Flight::hovering();
    let mut largest_deg = 0.0_f64;
    for step in 0..4000 {
        if step % 100 == 0 {
            flight.send(&position([0.0, 0.0, 1.0], 45.0));
        }
        flight.pass(1);
        largest_deg = largest_deg.max(flight.euler_deg()[2]);
    }
    assert!((flight.euler_deg()[2] - 45.0).abs() < 0.5 && largest_deg < 48.0, "{largest_deg}");
}

/// A point of a circle of 1 m at 2.5 m/s, to the jerk.
fn on_circle(t_s: f64) -> Setpoint {
    let w = 2.5_f64;
    let (sin, cos) = (w * t_s).sin_cos();
    let vector = |scale: f64, x: f64, y: f64, z: f64| super::sent::vector([scale * x, scale * y, z].map(|v| v as f32));
    let on = Mode::ABSOLUTE;
    Setpoint {
        mode: Modes { x: on, y: on, z: on, yaw: on, ..Setpoint::OFF.mode },
        position: vector(1.0, cos, sin, 1.0),
        velocity: vector(w, -sin, cos, 0.0),
        acceleration: vector(w * w, -cos, -sin, 0.0),
        jerk: vector(w * w * w, sin, -cos, 0.0),
        ..Setpoint::OFF
    }
}

#[test]
fn a_circle_is_flown_as_well_at_five_hundred_setpoints_a_second_as_at_a_hundred() {
    let rms_m = |period_ms: u32| {
        let mut flight = Flight::of("crazyflie-2.1-brushless", 0, 0.0);
        // In place of a start: what is far from the course at first is there after some seconds.
        let (mut sum, mut count) = (0.0, 0);
        for step in 0..14_000 {
            let t_s = f64::from(step) * 1e-3;
            if step % period_ms == 0 {
                flight.send(&on_circle(t_s));
            }
            if step > 10_000 {
                let (sin, cos) = (2.5 * t_s).sin_cos();
                let p = flight.state.position_m;
                sum += (p.x - cos).powi(2) + (p.y - sin).powi(2) + (p.z - 1.0).powi(2);
                count += 1;
            }
            flight.pass(1);
        }
        (sum / f64::from(count)).sqrt()
    };
    let usual = rms_m(10);
    for period_ms in [1, 2, 4] {
        let fast = rms_m(period_ms);
        assert!(fast < 1.3 * usual + 5e-4, "every {period_ms} ms {fast} m, every 10 ms {usual} m");
    }
}
