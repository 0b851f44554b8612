//! Orders to the high-level commander: take-off, go-to, spiral, landing and trajectories.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::atomic::Ordering::Relaxed;

use nalgebra::Vector3;
use quatrack_crazyflie::abi::Setpoint;
use quatrack_crazyflie::ffi;
use quatrack_simulation::plant::{Craft, Ground, RigidState};

use super::flight::{CRAFTS, Flight, MapInto};
use super::planner::{Piece, Planned};
use super::sent::hover;

#[test]
fn orders_to_the_high_level_commander_are_flown_from_the_ground_to_the_ground() {
    for name in CRAFTS {
        let mut flight = Flight::of(name, 0, 0.0);
        flight.craft = Craft::new(&flight.vehicle).with_load(Ground::under(&flight.vehicle));
        let standing = Ground::standing_height_m();
        flight.state = RigidState::at_rest(Vector3::new(0.0, 0.0, standing), 0.0);
        flight.hold(&Setpoint::OFF, 100);
        let from = Planned::at([0.0, 0.0, standing as f32], 0.0);
        let orders = [
            ("take-off", Piece::go_to(&from, [0.0, 0.0, 1.0], 0.0, 2.0, false), 0.06),
            (
                "go to, turning",
                Piece::go_to(&Planned::at([0.0, 0.0, 1.0], 0.0), [1.0, 0.0, 1.0], 3.0, 2.0, false),
                0.06,
            ),
            (
                "back past 180",
                Piece::go_to(&Planned::at([1.0, 0.0, 1.0], 3.0), [0.0, 0.0, 1.0], -3.0, 2.0, false),
                0.06,
            ),
            // Begins and ends at 0.5 m/s, from rest to rest.
            ("linear", Piece::go_to(&Planned::at([0.0, 0.0, 1.0], -3.0), [1.0, 0.0, 1.0], -3.0, 2.0, true), 0.15),
            ("spiral", Piece::spiral(&Planned::at([1.0, 0.0, 1.0], -3.0), 2.0 * 3.0, [0.5, 0.8], 0.2, 6.0), 0.15),
        ];
        let mut end = from;
        for (order, piece, most_m) in &orders {
            let largest_m = flight.follow(piece.duration_s, |t| piece.eval(t));
            assert!(largest_m < *most_m, "{name}, {order}: {largest_m} m");
            end = piece.eval(piece.duration_s + 0.01);
            flight.follow(1.5, |_| end);
        }
        let [x, y, _] = end.position;
        let landing = Piece::go_to(&end, [x, y, standing as f32], end.yaw, 2.0, false);
        let largest_m = flight.follow(2.0, |t| landing.eval(t));
        assert!(largest_m < 0.1, "{name}: {largest_m} m");
        // The planner is done and sends nothing but null setpoints.
        flight.hold(&Setpoint::OFF, 500);
        assert!(flight.is_off() && flight.state.velocity_m_s.norm() < 0.01, "{}", flight.state.velocity_m_s);
    }
}

/// Products of values with their first three derivatives.
fn times([a0, a1, a2, a3]: [f32; 4], [b0, b1, b2, b3]: [f32; 4]) -> [f32; 4] {
    let third = a3 * b0 + 3.0 * (a2 * b1 + a1 * b2) + a0 * b3;
    [a0 * b0, a1 * b0 + a0 * b1, a2 * b0 + 2.0 * a1 * b1 + a0 * b2, third]
}

/// A figure 8 of 2.1 m/s at 1 m that grows out of its middle in 4 s, as the high-level commander evaluates it.
pub(crate) fn figure_eight(t_s: f32) -> Planned {
    const W: f32 = 1.485;
    let growth = Piece::go_to(&Planned::at([0.0; 3], 0.0), [1.0, 0.0, 0.0], 0.0, 4.0, false).eval(t_s);
    let size = [growth.position, growth.velocity, growth.acceleration, growth.jerk].map(|v| v[0]);
    let wave = |w: f32, half: f32| {
        let (sin, cos) = (w * t_s).sin_cos();
        times(size, [sin, w * cos, -w * w * sin, -w * w * w * cos].map(|v| half * v))
    };
    let (x, y) = (wave(W, 1.0), wave(2.0 * W, 0.5));
    let [position, velocity, acceleration, jerk] = [0, 1, 2, 3].map(|i| [x[i], y[i], if i == 0 { 1.0 } else { 0.0 }]);
    Planned { position, velocity, acceleration, jerk, ..Planned::at([0.0; 3], 0.0) }
}

/// Largest distance from the figure once it has been caught up with; jumps that were counted on the way.
fn figure_strayed_m(turned_by: f32, change: impl Fn(&Setpoint, &RigidState) -> Setpoint) -> (f64, u16) {
    let mut flight = Flight::hovering();
    let before = ffi::quatrack.log.jumps.load(Relaxed);
    let mut largest_m = 0.0_f64;
    for step in 0..8000_u32 {
        let planned = figure_eight(step as f32 * 1e-3).turned(turned_by);
        if step % 10 == 0 {
            flight.send(&planned.setpoint());
        }
        flight.step(&change);
        if step > 0 {
            largest_m = largest_m.max((flight.state.position_m - planned.position.map_into()).norm());
        }
    }
    (largest_m, ffi::quatrack.log.jumps.load(Relaxed).wrapping_sub(before))
}

#[test]
fn a_trajectory_turned_on_its_start_is_flown_though_its_jerk_is_not_turned() {
    let (straight_m, _) = figure_strayed_m(0.0, |sent, _| *sent);
    for turned_by in [FRAC_PI_2, PI] {
        let (largest_m, jumps) = figure_strayed_m(turned_by as f32, |sent, _| *sent);
        // Until it is seen that the jerk is not the slope of the accelerations it leads astray.
        assert!(largest_m < 0.1, "turned by {turned_by}: {largest_m} m, not {straight_m} m, {jumps} jumps");
    }
}

#[test]
fn collision_avoidance_may_change_a_setpoint_at_every_step() {
    // The change that collisionAvoidanceUpdateSetpoint makes to a trajectory whose horizon leaves the cell: the velocity
    // is scaled, by a factor that depends on where the craft is.
    let (strayed_m, jumps) = figure_strayed_m(0.0, |sent, state| {
        let mut changed = *sent;
        let away = (sent.position.x - state.position_m.x as f32).abs();
        let scale = 0.95 - away.min(0.5);
        (changed.velocity.x, changed.velocity.y) = (scale * sent.velocity.x, scale * sent.velocity.y);
        changed
    });
    // A velocity that is a twentieth short and more counts like a position error that grows by as much.
    assert!(strayed_m < 0.5 && jumps == 0, "{strayed_m} m, {jumps} jumps");
}

#[test]
fn the_high_level_commander_takes_over_after_a_few_null_setpoints() {
    // send_notify_setpoint_stop, then an order: until it comes the planner, stopped by the setpoints before, sends nulls.
    for name in CRAFTS {
        let mut flight = Flight::of(name, 0, 0.0);
        flight.hold(&hover([0.0, 0.0], 0.0, 1.0), 1000);
        flight.hold(&Setpoint::OFF, 20);
        assert!(flight.is_off(), "{name}");
        let here = Planned::at(flight.state.position_m.map(|c| c as f32).into(), 0.0);
        // Off for 20 ms the craft falls 2 mm and has 0.2 m/s to be caught; the motors are known to run down meanwhile.
        let largest_m = flight.follow(2.0, |_| here);
        assert!(largest_m < 0.01, "{name}: {largest_m} m");
    }
}

#[test]
fn a_turn_in_place_is_followed() {
    for (duration_s, bound_deg) in [(1.0_f32, 4.0), (2.0, 1.6)] {
        let mut flight = Flight::of("crazyflie-2.1", 0, 0.0);
        flight.hold(&hover([0.0, 0.0], 0.0, 1.0), 500);
        let from = Planned::at([0.0, 0.0, 1.0], 0.0);
        let turn = Piece::go_to(&from, from.position, 1.5, duration_s, false);
        let mut largest_deg = 0.0_f64;
        for step in 0..4000_u32 {
            let planned = turn.eval((step as f32 * 1e-3).min(duration_s));
            if step % 10 == 0 {
                flight.send(&planned.setpoint());
            }
            largest_deg = largest_deg.max((flight.euler_deg()[2] - f64::from(planned.yaw.to_degrees())).abs());
            flight.pass(1);
        }
        // Yaw torque is scarce and its gain low: without acceleration and jerk of the heading it strays 36 and 17 degrees.
        assert!(largest_deg < bound_deg, "86 degrees in {duration_s} s: {largest_deg} degrees");
    }
}

#[test]
fn the_default_table_takes_over_from_one_of_the_papers_in_flight() {
    for (table, lag_s) in [(1, 0.0635), (2, 0.02)] {
        let mut flight = Flight::of("crazyflie-2.1", table, lag_s);
        // Switched on standing: the motors are known to be at rest.
        flight.hold(&Setpoint::OFF, 500);
        let here = Planned::at([0.0, 0.0, 1.0], 0.0);
        flight.state = RigidState::at_rest(Vector3::z(), flight.vehicle.hover_thrust_n());
        flight.follow(3.0, |_| here);
        flight.firmware.ask_for(0);
        let largest_m = flight.follow(3.0, |_| here);
        // Taken for standing still, as they were when a law last looked, the motors would cost 3.7 mm.
        assert!(largest_m < 1e-4, "table {table}: {largest_m} m");
        assert_eq!(ffi::quatrack.log.table.load(Relaxed), 0);
    }
}
