//! Walls and the ground.

use nalgebra::{Unit, UnitQuaternion, Vector3, Vector4};
use quatrack_simulation::plant::{Environment, Plant, RigidState, Truth, Wall};
use quatrack_simulation::vehicles;

#[test]
fn a_craft_that_leans_on_a_wall_is_held_by_it() {
    let vehicle = vehicles::by_name("crazyflie-2.1").expect("built in");
    let wall = Wall { point_m: Vector3::new(0.1, 0.0, 0.0), normal: Unit::new_normalize(-Vector3::x()), friction: 0.5 };
    let environment = Environment { walls: vec![wall], guard_reach_m: 0.03, ..Environment::VACUUM };
    let mut start = RigidState::at_rest(Vector3::z(), vehicle.hover_thrust_n());
    start.velocity_m_s.x = 0.3;
    let mut plant = Plant::new(&vehicle, &environment, &Truth::as_designed(&vehicle), &start, 1).expect("in range");
    let (mut furthest, hover) = (0.0_f64, Vector4::repeat(vehicle.hover_thrust_n()));
    for _ in 0..200 {
        plant.advance(&hover, 0.002);
        furthest = furthest.max(plant.state().position_m.x);
    }
    // The tips are (0.046 + 0.03) / sqrt 2 = 53.7 mm ahead: the centre stops 46.3 mm from where it was, plus the wall's
    // yielding: v sqrt(m/k) of two tips is 0.3 sqrt(1e-3 / 9.81 / 2) = 2.1 mm, and less with damping.
    let stop_m = 0.1 - 0.076 / 2.0_f64.sqrt();
    assert!(furthest > stop_m && furthest < stop_m + 2.2e-3, "{furthest}");
    assert!(plant.state().velocity_m_s.x < 0.0, "it bounces off");
}

#[test]
fn friction_holds_a_craft_that_is_pressed_against_a_wall() {
    let vehicle = vehicles::by_name("crazyflie-2.1").expect("built in");
    let wall = Wall { point_m: Vector3::new(0.0, 0.0, 2.0), normal: Unit::new_normalize(-Vector3::z()), friction: 0.5 };
    // A ceiling; 1.4 weights of thrust press with 0.4 weights, which hold up to 0.2 g across.
    let environment = Environment { walls: vec![wall], ..Environment::VACUUM };
    let mut start = RigidState::at_rest(Vector3::new(0.0, 0.0, 2.0), 1.4 * vehicle.hover_thrust_n());
    start.attitude = UnitQuaternion::identity();
    start.velocity_m_s.x = 0.5;
    let mut plant = Plant::new(&vehicle, &environment, &Truth::as_designed(&vehicle), &start, 1).expect("in range");
    plant.advance(&Vector4::repeat(1.4 * vehicle.hover_thrust_n()), 1.0);
    assert!(plant.state().velocity_m_s.norm() < 1e-3, "{}", plant.state().velocity_m_s);
    // It slid v^2 / (2 mu 0.4 g) = 64 mm, and a little farther as friction creeps at the end.
    let slid = plant.state().position_m.x;
    assert!((0.06..0.08).contains(&slid), "{slid}");
}

#[test]
fn near_the_floor_the_same_thrust_lifts_more() {
    let vehicle = vehicles::by_name("crazyflie-2.1").expect("built in");
    let environment = Environment { ground_effect_radius_m: Some(0.0225), ..Environment::VACUUM };
    let climb = |height_m: f64| {
        let start = RigidState::at_rest(Vector3::new(0.0, 0.0, height_m), vehicle.hover_thrust_n());
        let truth = Truth::as_designed(&vehicle);
        let mut plant = Plant::new(&vehicle, &environment, &truth, &start, 1).expect("in range");
        plant.advance(&Vector4::repeat(vehicle.hover_thrust_n()), 0.001);
        plant.motion().acceleration_m_s2.z
    };
    // 1 / (1 - (22.5/180)^2) - 1 = 1.587 % of g at 45 mm.
    assert!((climb(0.045) - 9.81 * (1.0 / (1.0 - 0.015_625) - 1.0)).abs() < 1e-5, "{}", climb(0.045));
    assert!(climb(1.0) < 4e-4);
}
