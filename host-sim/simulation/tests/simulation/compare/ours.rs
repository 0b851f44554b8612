//! Ours on the craft of RotorPy 3.0.0 and crazyflow 0.4.0, told the mass and at most the lag: held against the firmware's
//! best controllers there.

use quatrack_plan::plan::paper;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use quatrack_simulation::control_law::ControlLaw;
use quatrack_simulation::flight::rigid_loop::RigidFlight;
use quatrack_simulation::scenario::course::Flown;
use quatrack_simulation::scenario::{Law, ToldFigures};

use super::plants::{CRAFT, Craft};

/// The core's cascade, and the Crazyflie's object with its default table through its C interface.
const OURS: [Law; 2] = [Law::Quatrack, Law::Crazyflie];

/// Position errors summed over samples of 10 ms, m s, of a flight by each.
fn errors(craft: &Craft, told: &ToldFigures, fly: impl Fn(&mut dyn ControlLaw) -> RigidFlight) -> [f64; 2] {
    OURS.map(|law| fly(law.start(&craft.built_for, told).unwrap().as_mut()).iae_m_s().expect("not lost"))
}

fn told_the_mass(craft: &Craft) -> ToldFigures {
    ToldFigures { mass_kg: craft.mass_kg(), lag_s: None, drag_per_s: None, moment_n_m_per_m_s: None }
}

fn hold(name: &str, found: [f64; 2], bound: f64) {
    println!("{name:<40} {:.4} {:.4} of {bound}", found[0], found[1]);
    assert!(found.iter().all(|error| *error <= bound), "{name}: {found:?} of {bound}");
}

/// Their air is not the one that ours is told by default, which has a moment where there is none here. The firmware's best is PID,
/// Mellinger, Lee, Brescianini or INDI in C (crazyflie-firmware 2a18fc29) on the same craft and course; ours is held to a fifth above
/// its measured error, which is a third of that and less on the eight.
#[test]
fn told_the_mass_alone_ours_is_closer_than_the_firmware_s_best() {
    let w = PiecewisePolynomial::from_bspline(&paper::aggressive().unwrap().solve().unwrap()).unwrap();
    let firmware = [
        [0.338, 0.166, 0.681],
        [1.234, 0.710, 0.712],
        [0.574, 0.286, 0.678],
        [0.678, 0.334, 0.687],
        [0.861, 0.435, 0.678],
    ];
    let courses = [
        ("eight", Flown::eight(2.1, 12.0), [0.036, 0.155, 0.017, 0.051, 0.035]),
        ("W", Flown::trajectory(w, None), [0.063, 0.19, 0.041, 0.086, 0.047]),
        ("step", Flown::step(1.0, 5.0), [0.60, 0.62, 0.60, 0.60, 0.60]),
    ];
    for (column, (course, flown, bounds)) in courses.iter().enumerate() {
        for ((of, bound), best) in CRAFT.into_iter().zip(*bounds).zip(firmware) {
            let craft = Craft::new(of);
            assert!(bound < best[column]);
            hold(
                &format!("{course} {}", of.1),
                errors(&craft, &told_the_mass(&craft), |law| craft.fly(law, flown, true)),
                bound,
            );
        }
    }
}

/// The lag at hover and the drag of the packages' figures, and that there is no moment.
#[test]
fn told_lag_and_drag_it_is_closer_still() {
    let eight = Flown::eight(2.1, 12.0);
    let stated =
        [(0.072, 0.24, 0.015), (0.050, 0.75, 0.15), (0.107, 0.43, 0.016), (0.078, 0.40, 0.027), (0.059, 0.50, 0.030)];
    for (of, (lag_s, drag_per_s, bound)) in CRAFT.into_iter().zip(stated) {
        let craft = Craft::new(of);
        let told = ToldFigures {
            lag_s: Some(lag_s),
            drag_per_s: Some(drag_per_s),
            moment_n_m_per_m_s: Some([0.0; 2]),
            ..told_the_mass(&craft)
        };
        hold(of.1, errors(&craft, &told, |law| craft.fly(law, &eight, true)), bound);
    }
}

/// Through a filter that reckons with the drag, the firmware's are between 0.33 and 1.28 m s off. Ours, whose velocity is carried on
/// by the known forces between two predictions, is held close above its measured errors: 0.051 to 0.078 m s, and 0.101 on RotorPy's
/// Brushless.
#[test]
fn through_a_filter_with_drag_ours_stays_close() {
    let eight = Flown::eight(2.1, 12.0);
    let stated = [(0.24, 0.08), (0.75, 0.12), (0.43, 0.08), (0.40, 0.08), (0.50, 0.08)];
    for (of, (drag_per_s, bound)) in CRAFT.into_iter().zip(stated) {
        let craft = Craft::new(of);
        let found = errors(&craft, &told_the_mass(&craft), |law| craft.fly_filtered(law, &eight, drag_per_s));
        hold(of.1, found, bound);
    }
}
