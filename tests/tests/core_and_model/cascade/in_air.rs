//! Flights of identified crafts in air, of which the controller is told 80 %: position error integrated over 12 s.
//!
//! The bounds lie 10 to 30 % above the figures measured with this seed; Bitcraze's best stock controllers leave 10 to
//! 70 times as much on the same figures and plants.

use nalgebra::Vector3;
use quatrack::cascade::{Air, Cascade, CascadeMemory};

use crate::cascade::course::Course;
use crate::cascade::crafts::{BRUSHED, BRUSHLESS, brushed, brushless};
use crate::cascade::flight::{EXACT, Estimates, Figures, Flight, NOISE};
use crate::cascade::plant::Craft;

const SLOW: Course = Course::Eight { w: 0.601, turn: 0.0 };
const EIGHT: Course = Course::Eight { w: 1.485, turn: 0.0 };
const FAST: Course = Course::Eight { w: 2.19, turn: 0.0 };
const STEP: Course = Course::Step { to: Vector3::new(1.0, 0.0, 0.0), yaw: 0.0, at_s: 2.0 };

/// Both crafts, with the figures that they are told.
fn crafts() -> [(Craft, Cascade); 2] {
    [(BRUSHLESS, brushless(&Air::BRUSHLESS)), (BRUSHED, brushed(&Air::BRUSHED))]
}

fn flown(craft: Craft, cascade: Cascade, course: Course, estimates: Estimates) -> Figures {
    let figures = Flight { estimates, ..Flight::of(cascade, craft, course) }.fly();
    assert!(!figures.lost, "{course:?}");
    figures
}

#[test]
fn eights_and_the_w() {
    let bounds = [[0.0095, 0.028, 0.070, 0.028], [0.0085, 0.024, 0.055, 0.018]];
    for ((craft, cascade), bounds) in crafts().into_iter().zip(bounds) {
        for (course, bound) in [SLOW, EIGHT, FAST, Course::W].into_iter().zip(bounds) {
            let Figures { iae, .. } = flown(craft, cascade, course, NOISE);
            assert!(iae < bound, "{course:?}: {iae:.4} m s");
        }
    }
}

#[test]
fn a_step_of_a_metre() {
    for (craft, cascade) in crafts() {
        let Figures { iae, beyond, .. } = flown(craft, cascade, STEP, NOISE);
        assert!(iae < 0.61 && beyond < 0.025, "{iae:.3} m s, {beyond:.3} m beyond");
    }
}

#[test]
fn wind_at_hover() {
    for ((craft, cascade), [bound, gust_bound]) in crafts().into_iter().zip([[0.030, 0.060], [0.0235, 0.046]]) {
        let wind = |t: f64| Vector3::new(if t > 2.0 { 1.0 } else { 0.0 }, 0.0, 0.0);
        let steady = Flight { wind: &wind, ..Flight::of(cascade, craft, Course::Hover) }.fly();
        let wind = |t: f64| Vector3::new(if t > 2.0 && t < 2.5 { 2.0 } else { 0.0 }, 0.0, 0.0);
        let gust = Flight { wind: &wind, ..Flight::of(cascade, craft, Course::Hover) }.fly();
        assert!(steady.iae < bound && gust.iae < gust_bound, "{:.4}, {:.4} m s", steady.iae, gust.iae);
        // A wind is no drag: the reference does not move.
        let (told, _) = cascade.air(&CascadeMemory::IN_FLIGHT);
        assert!((steady.drag - f64::from(told)).abs() < 1e-6);
    }
}

#[test]
fn noise_does_not_wear_the_motors() {
    for (craft, cascade) in crafts() {
        let Figures { iae, activity, .. } = flown(craft, cascade, Course::Hover, NOISE);
        assert!(iae < 0.007 && activity < 0.036, "{iae:.4} m s, {activity:.4} of the range");
    }
}

#[test]
fn the_air_is_learned_from_nothing() {
    let untold = Air { learn: true, gust: 0.55, ..Air::NONE };
    for (craft, cascade) in [(BRUSHLESS, brushless(&untold)), (BRUSHED, brushed(&untold))] {
        for (estimates, share) in [(NOISE, 0.05), (Estimates::Filtered(craft.drag[0]), 0.05)] {
            let flight = Flight { estimates, for_s: 27.0, ..Flight::of(cascade, craft, SLOW) };
            let found = flight.fly();
            let truths =
                [(found.drag, craft.drag[0]), (found.moment[0], craft.moment[0]), (found.moment[1], craft.moment[1])];
            for (found, truth) in truths {
                assert!((found / truth - 1.0).abs() < share, "{found} {truth}");
            }
        }
        // And where 80 % of some air is told and there is none.
        assert!(flown(craft, cascade, EIGHT, NOISE).iae < 0.032);
    }
    for (craft, cascade) in crafts() {
        let still = Craft { drag: [0.0; 3], moment: [0.0; 2], ..craft };
        assert!(flown(still, cascade, EIGHT, NOISE).iae < 0.017);
    }
}

#[test]
fn through_the_firmwares_filter() {
    for (craft, cascade) in crafts() {
        let ignorant = flown(craft, cascade, EIGHT, Estimates::Filtered(0.0)).iae;
        let told = flown(craft, cascade, EIGHT, Estimates::Filtered(craft.drag[0])).iae;
        assert!(ignorant < 0.40 && told < 0.060, "{ignorant:.3}, {told:.4} m s");
        let off = Craft {
            mass_kg: 1.05 * craft.mass_kg,
            inertia: craft.inertia.map(|i| 1.05 * i),
            motors: [0.93, 0.95, 0.92, 0.94],
            torque_bias: [-0.6e-4, 0.4e-4, 0.0],
            ..craft
        };
        let iae = flown(off, cascade, EIGHT, Estimates::Filtered(craft.drag[0])).iae;
        assert!(iae < 0.065, "{iae:.4} m s");
    }
}

#[test]
fn without_noise_and_delay_the_reference_is_flown_exactly() {
    let air = Air { drag_per_s: 0.4, drag_along_share: 1.0, moment_n_s: [3.8e-4, 4.3e-4], gust: 0.0, learn: false };
    let craft = Craft {
        inertia: [16.571_71e-6, 16.655_602e-6, 29.261_652e-6],
        lag_s: [0.0635; 2],
        delay_s: 0.0,
        drag: [0.4; 3],
        moment: air.moment_n_s.map(f64::from),
        ..BRUSHED
    };
    let turning = Course::Eight { w: 1.485, turn: 0.8 };
    for (course, bound) in [(SLOW, 1e-4), (EIGHT, 3e-4), (turning, 3e-4), (Course::W, 3e-4), (FAST, 1e-3)] {
        let iae = Flight { estimates: EXACT, to_fifth: true, ..Flight::of(brushed(&air), craft, course) }.fly().iae;
        assert!(iae < bound, "{course:?}: {iae:.5} m s");
    }
}

#[test]
fn air_beyond_the_certified_is_flown_in() {
    // The drag of RotorPy's Brushless, without a moment; half of it is told.
    let thick = Craft { drag: [0.75; 3], moment: [0.0; 2], ..BRUSHLESS };
    let found = flown(thick, brushless(&Air::BRUSHLESS), EIGHT, NOISE);
    assert!(found.iae < 0.06 && (found.drag / 0.75 - 1.0).abs() < 0.05, "{found:?}");
}
