//! Flights that the cascade has to survive: far goals, turns, starts at any tilt, weak motors, walls, hands, the ground, odd setpoints.

use nalgebra::Vector3;
use quatrack::cascade::Air;

use crate::cascade::course::Course;
use crate::cascade::crafts::{BRUSHED, BRUSHLESS, brushed, brushless};
use crate::cascade::flight::{Estimates, Flight, NOISE, Start};
use crate::cascade::plant::{Craft, Plant};

fn goal(x: f64, z: f64, yaw_deg: f64) -> Course {
    Course::Step { to: Vector3::new(x, 0.0, z), yaw: yaw_deg.to_radians(), at_s: 2.0 }
}

#[test]
fn a_goal_is_reached_within_its_limits_however_far() {
    // A centimetre beyond it at most, with a moment of the air of which 80 % are told, and told of one that is not there.
    let still = |craft: Craft| Craft { moment: [0.0; 2], ..craft };
    for (craft, cascade) in [
        (BRUSHLESS, brushless(&Air::BRUSHLESS)),
        (BRUSHED, brushed(&Air::BRUSHED)),
        (still(BRUSHLESS), brushless(&Air::BRUSHLESS)),
        (still(BRUSHED), brushed(&Air::BRUSHED)),
    ] {
        for (distance, for_s) in [(0.1, 5.0), (1.0, 5.0), (4.5, 8.0), (50.0, 32.0)] {
            let across = Flight { for_s, ..Flight::of(cascade, craft, goal(distance, 0.0, 0.0)) }.fly();
            assert!(!across.lost && across.beyond < 0.01, "{distance}: {across:?}");
            assert!(across.tilt_deg < 55.0 && across.speed < 2.25 && across.lowest > 0.95, "{distance}: {across:?}");
            assert!(across.final_error < 0.02, "{distance}: {across:?}");
        }
        let up = Flight { for_s: 40.0, ..Flight::of(cascade, craft, goal(0.0, 40.0, 0.0)) }.fly();
        assert!(up.beyond < 0.01 && up.speed < 1.7 && up.final_error < 0.02, "{up:?}");
    }
}

#[test]
fn a_turn_with_a_step_keeps_height() {
    for (craft, cascade) in [(BRUSHLESS, brushless(&Air::BRUSHLESS)), (BRUSHED, brushed(&Air::BRUSHED))] {
        for yaw_deg in [45.0, 135.0, 180.0] {
            for distance in [0.1, 1.0, 2.0] {
                let found = Flight::of(cascade, craft, goal(distance, 0.0, yaw_deg)).fly();
                assert!(!found.lost && found.final_error < 0.02, "{yaw_deg} {distance}: {found:?}");
                assert!(found.tilt_deg < 45.0 && found.lowest > 0.95, "{yaw_deg} {distance}: {found:?}");
            }
        }
    }
}

#[test]
fn it_recovers_from_any_tilt() {
    for (craft, cascade) in [(BRUSHLESS, brushless(&Air::BRUSHLESS)), (BRUSHED, brushed(&Air::BRUSHED))] {
        for tilt_deg in [60.0_f64, 120.0, 180.0] {
            let start = Start::Tilted(Vector3::new(0.8, 0.6, 0.0) * tilt_deg.to_radians());
            let found = Flight { start, from_s: 0.0, ..Flight::of(cascade, craft, Course::Hover) }.fly();
            assert!(!found.lost && found.largest < 2.1 && found.final_error < 0.02, "{tilt_deg}: {found:?}");
        }
    }
}

#[test]
fn weak_motors_are_made_good() {
    for (craft, cascade) in [(BRUSHLESS, brushless(&Air::BRUSHLESS)), (BRUSHED, brushed(&Air::BRUSHED))] {
        let one = Craft { motors: [1.0, 0.7, 1.0, 1.0], ..craft };
        let found = Flight { from_s: 0.0, ..Flight::of(cascade, one, Course::Hover) }.fly();
        assert!(found.largest < 0.2 && found.final_error < 0.01, "{found:?}");
        let all = Craft { motors: [0.75; 4], ..craft };
        let found = Flight::of(cascade, all, Course::Eight { w: 1.485, turn: 0.0 }).fly();
        assert!(found.iae < 0.055, "{found:?}");
        // The motors' range ends: attitude stays, some place is lost.
        let found = Flight::of(cascade, all, Course::Eight { w: 2.19, turn: 0.0 }).fly();
        assert!(!found.lost && found.largest < 0.3 && found.limited > 1000, "{found:?}");
    }
}

#[test]
fn a_mass_that_is_off_is_learned() {
    for (craft, cascade) in [(BRUSHLESS, brushless(&Air::BRUSHLESS)), (BRUSHED, brushed(&Air::BRUSHED))] {
        for factor in [0.8, 1.2] {
            let off = Craft { mass_kg: factor * craft.mass_kg, ..craft };
            let flight = Flight { from_s: 0.0, ..Flight::of(cascade, off, Course::Eight { w: 1.485, turn: 0.0 }) };
            let found = flight.fly();
            assert!(!found.lost && found.largest < 0.06 && found.iae < 0.09, "{factor}: {found:?}");
        }
    }
}

#[test]
fn a_wall_and_a_hand_are_leaned_against_and_left() {
    for (craft, cascade) in [(BRUSHLESS, brushless(&Air::BRUSHLESS)), (BRUSHED, brushed(&Air::BRUSHED))] {
        let wall = |t: f64, plant: &Plant| {
            let (depth, v) = (plant.p.x - 0.6, &plant.v);
            if t < 12.0 && depth > 0.0 {
                Vector3::new(-3000.0 * depth - 20.0 * v.x, -2.0 * v.y, -2.0 * v.z)
            } else {
                Vector3::zeros()
            }
        };
        let found = Flight { push: &wall, for_s: 18.0, ..Flight::of(cascade, craft, goal(1.0, 0.0, 0.0)) }.fly();
        assert!(!found.lost && found.tilt_deg < 60.0 && found.beyond < 0.02, "{found:?}");
        assert!(found.lowest > 0.9 && found.final_error < 0.02, "{found:?}");
        let hand = |t: f64, plant: &Plant| {
            let to = Vector3::new(0.5 * (t - 3.0).clamp(0.0, 1.0), 0.0, 1.0);
            if t > 3.0 && t < 8.0 { (to - plant.p) * 400.0 - plant.v * 40.0 } else { Vector3::zeros() }
        };
        let found = Flight { push: &hand, for_s: 12.0, ..Flight::of(cascade, craft, Course::Hover) }.fly();
        assert!(!found.lost && found.largest < 0.52 && found.final_error < 0.02, "{found:?}");
    }
}

#[test]
fn a_wait_on_the_ground_winds_nothing_up() {
    for (craft, cascade) in [(BRUSHLESS, brushless(&Air::BRUSHLESS)), (BRUSHED, brushed(&Air::BRUSHED))] {
        for (from, at_s) in [
            (Vector3::zeros(), 2.0),
            (Vector3::new(0.1, 0.0, -0.005), 60.0),
            (Vector3::new(0.2, 0.0, -0.02), 30.0),
            (Vector3::new(0.1, 0.0, 0.01), 30.0),
        ] {
            for estimates in [NOISE, Estimates::Filtered(0.0)] {
                let course = Course::TakeOff { from, at_s, in_s: 2.0 };
                let bias = Vector3::new(0.5, 0.0, 0.0);
                let flight = Flight {
                    estimates,
                    start: Start::Ground,
                    accelerometer_bias: bias,
                    ..Flight::of(cascade, craft, course)
                };
                let found = flight.fly();
                // From its start to its goal, and no more than 6 cm.
                assert!(!found.lost && found.largest < from.norm() + 0.06, "{from:?}: {found:?}");
                assert!(found.final_error < 0.01, "{from:?}: {found:?}");
            }
        }
    }
}

#[test]
fn odd_late_and_missing_setpoints_cost_little() {
    let course = Course::Eight { w: 1.485, turn: 0.0 };
    for (craft, cascade) in [(BRUSHLESS, brushless(&Air::BRUSHLESS)), (BRUSHED, brushed(&Air::BRUSHED))] {
        let even = Flight::of(cascade, craft, course).fly().iae;
        let periods: [&dyn Fn(u32) -> f64; 4] = [
            &|_| 0.006,
            &|_| 0.02,
            &|i| [0.008, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01, 0.012][i as usize % 10],
            &|i| if i % 10 == 9 { 0.02 } else { 0.01 },
        ];
        for (kind, setpoint_s) in periods.into_iter().enumerate() {
            let iae = Flight { setpoint_s, ..Flight::of(cascade, craft, course) }.fly().iae;
            assert!(iae < 1.1 * even, "{kind}: {iae:.4} {even:.4} m s");
        }
    }
}

#[test]
fn no_wind_takes_it_with_everything_off_by_a_bit() {
    for (craft, cascade) in [(BRUSHLESS, brushless(&Air::BRUSHLESS)), (BRUSHED, brushed(&Air::BRUSHED))] {
        let arm = 0.5e-3 * craft.mass_kg * 9.81;
        let off = Craft {
            mass_kg: 1.05 * craft.mass_kg,
            motors: [0.93, 0.95, 0.92, 0.94],
            torque_bias: [-arm, arm, 0.0],
            delay_s: 0.003,
            ..craft
        };
        for seed in 0..3_u32 {
            for speed in [0.0, 3.0] {
                for course in [Course::Eight { w: 2.19, turn: 0.0 }, Course::W] {
                    let phase = f64::from(seed);
                    let wind = move |t: f64| {
                        Vector3::new(speed * (1.0 + 0.3 * (1.3 * t + phase).sin()), 0.5 * speed * (0.7 * t).cos(), 0.0)
                    };
                    let estimates = Estimates::Filtered(craft.drag[0]);
                    let seed = u64::from(seed);
                    let found = Flight { estimates, seed, wind: &wind, ..Flight::of(cascade, off, course) }.fly();
                    assert!(!found.lost && found.largest < 0.5, "{seed} {speed} {course:?}: {found:?}");
                }
            }
        }
    }
}
