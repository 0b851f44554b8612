//! The mixer: exact where the motors can, roll and pitch before thrust before yaw where they cannot; and the rate loop.

use proptest::prelude::*;
use quatrack::body_rate::BandwidthError;
use quatrack::nalgebra::Vector3;
use quatrack::{Airframe, BodyRateLoop, Command, MotorLimited, Wrench};

const CRAFT: Airframe = Airframe::CRAZYFLIE_2_1;

fn wrench(thrust_n: f32, x: f32, y: f32, z: f32) -> Wrench {
    Wrench { thrust_n, torque_n_m: Vector3::new(x, y, z) }
}

/// A wrench from parts of the forces, N each.
fn of_parts(thrust: f32, roll: f32, pitch: f32, yaw: f32) -> Wrench {
    let figures = CRAFT.figures();
    let (a, c) = (4.0 * figures.lever_arm_m, 4.0 * figures.torque_per_thrust_m);
    wrench(4.0 * thrust, a * roll, a * pitch, c * yaw)
}

fn close(a: f32, b: f32) -> bool {
    // A dozen roundings of forces up to 0.3 N.
    (a - b).abs() <= 12.0 * f32::EPSILON * 0.3
}

proptest! {
    #[test]
    fn forces_stay_in_range_and_priorities_hold(
        thrust in -0.1_f32..0.3, roll in -0.1_f32..0.1, pitch in -0.1_f32..0.1, yaw in -0.1_f32..0.1,
    ) {
        let (min, max) = (CRAFT.figures().force_min_n, CRAFT.figures().force_max_n);
        let (forces, limited) = CRAFT.mix(&of_parts(thrust, roll, pitch, yaw)).unwrap();
        prop_assert!(forces.iter().all(|force| (min..=max).contains(force)), "{forces:?}");
        let got = {
            let found = CRAFT.wrench(&forces);
            let (a, c) = (4.0 * CRAFT.figures().lever_arm_m, 4.0 * CRAFT.figures().torque_per_thrust_m);
            [found.thrust_n / 4.0, found.torque_n_m.x / a, found.torque_n_m.y / a, found.torque_n_m.z / c]
        };
        // Each part that is not reported as given up is there.
        prop_assert!(limited.thrust() || close(got[0], thrust), "{got:?}");
        prop_assert!(limited.attitude() || (close(got[1], roll) && close(got[2], pitch)), "{got:?}");
        prop_assert!(limited.yaw() || close(got[3], yaw), "{got:?}");
        // Roll and pitch give way only when they alone exceed the range, and then both by one factor.
        let half = 0.5 * (max - min);
        prop_assert_eq!(limited.attitude(), roll.abs() + pitch.abs() > half);
        prop_assert!(close(got[1] * pitch, got[2] * roll));
        if limited.attitude() {
            prop_assert!(close(got[1].abs() + got[2].abs(), half));
        }
        // Thrust gives way no further than roll and pitch need.
        let swing = got[1].abs() + got[2].abs();
        if limited.thrust() {
            prop_assert!(close(got[0], thrust.max(min + swing).min(max - swing)), "{got:?}");
        }
        // Yaw keeps its sign and is used up to where a motor is at its end.
        if limited.yaw() {
            prop_assert!(got[3] * yaw >= -f32::EPSILON && got[3].abs() <= yaw.abs() + f32::EPSILON);
            let margin = forces.iter().map(|force| (force - min).min(max - force)).fold(f32::INFINITY, f32::min);
            prop_assert!(margin <= 12.0 * f32::EPSILON * 0.3, "{margin}");
        }
    }
}

#[test]
fn wrenches_that_fit_are_mixed_exactly_and_inverted() {
    let asked = of_parts(0.07, 0.01, -0.005, 0.02);
    let (forces, limited) = CRAFT.mix(&asked).unwrap();
    assert_eq!(limited, MotorLimited::NOTHING);
    // t - r - p - y, t - r + p + y, t + r + p - y, t + r - p + y.
    for (found, expected) in forces.into_iter().zip([0.045, 0.075, 0.055, 0.105]) {
        assert!(close(found, expected), "{forces:?}");
    }
    let back = CRAFT.wrench(&forces);
    assert!((back.torque_n_m - asked.torque_n_m).amax() < 1e-9 && close(back.thrust_n, asked.thrust_n));
}

#[test]
fn full_thrust_keeps_roll_and_gives_up_yaw() {
    let (forces, limited) = CRAFT.mix(&of_parts(0.12, 0.02, 0.0, 0.03)).unwrap();
    // Thrust moves down by the swing of roll; both left motors are then at the top and yaw has nothing left.
    for (found, expected) in forces.into_iter().zip([0.08, 0.08, 0.12, 0.12]) {
        assert!(close(found, expected), "{forces:?}");
    }
    assert_eq!((limited.thrust(), limited.attitude(), limited.yaw()), (true, false, true));
    assert_eq!(MotorLimited::from_bits(limited.bits()), limited);
}

#[test]
fn numbers_that_are_not_finite_are_never_mixed() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for i in 0..4 {
            let mut parts = [0.07, 0.0, 0.0, 0.0];
            parts[i] = bad;
            let [t, r, p, y] = parts;
            assert_eq!(CRAFT.mix(&of_parts(t, r, p, y)), None);
        }
    }
}

#[test]
fn the_rate_loop_asks_for_its_bandwidth_and_cancels_the_gyroscopic_torque() {
    let bandwidth = [20.0, 15.0, 5.0];
    let rates = Vector3::new(3.0, -5.0, 2.0);
    let command = Command { thrust_m_s2: 9.81, body_rates_rad_s: Vector3::new(3.5, -5.25, 1.0) };
    let asked = BodyRateLoop::new(&CRAFT, bandwidth).unwrap().wrench(&command, &rates);
    let inertia = Vector3::from(CRAFT.figures().inertia_kg_m2);
    // Euler: I w' = torque - w x I w; w' shall be k (w_cmd - w).
    let acceleration = (asked.torque_n_m - rates.cross(&inertia.component_mul(&rates))).component_div(&inertia);
    assert!((acceleration - Vector3::new(10.0, -3.75, -5.0)).amax() < 1e-5, "{acceleration}");
    assert_eq!(asked.thrust_n, 0.029 * 9.81);
    assert_eq!(BodyRateLoop::new(&CRAFT, [20.0, -1.0, 5.0]), Err(BandwidthError { bandwidth_rad_s: -1.0 }));
}

#[test]
fn large_numbers_are_mixed_as_long_as_they_add_up_to_a_number() {
    let figures = CRAFT.figures();
    let (a, c) = (4.0 * figures.lever_arm_m, 4.0 * figures.torque_per_thrust_m);
    // Four times the thrust's part is a number, too.
    let largest = [0.2 * f32::MAX, 0.9 * f32::MAX, 0.9 * f32::MAX, 0.9 * f32::MAX];
    for (i, j) in [(0, 1), (1, 2), (2, 3), (0, 3)] {
        // The product of two of 1e30 is beyond f32, their sum is not.
        for (parts, mixed) in [([1e30; 4], true), (largest, false)] {
            let [t, r, p, y] = std::array::from_fn(|k| if k == i || k == j { parts[k] } else { 0.0 });
            let asked = wrench(4.0 * t, a * r, a * p, c * y);
            assert_eq!(CRAFT.mix(&asked).is_some(), mixed, "parts {i} and {j} of {parts:?}");
        }
    }
}
