//! The rigid plant alone, against analytic mechanics: free fall, hover, conservation, analytic rotations, lag, order.

use nalgebra::{UnitQuaternion, Vector3, Vector4};
use quatrack_design::vehicle::Vehicle;
use quatrack_simulation::plant::{Craft, Ground, RigidState, Shove};
use quatrack_simulation::vehicles;

const G: f64 = 9.81;

fn vehicle() -> Vehicle {
    vehicles::by_name("crazyflie-2.1").expect("built in")
}

/// The 2.1 with the off-diagonal inertia that Foerster identified.
fn skewed() -> Vehicle {
    let text = include_str!("../../../../gains/vehicles/crazyflie-2.1.toml")
        .replace("[16.571710e-6, 0.0, 0.0]", "[16.571710e-6, 0.830806e-6, 0.718277e-6]")
        .replace("[0.0, 16.655602e-6, 0.0]", "[0.830806e-6, 16.655602e-6, 1.800197e-6]")
        .replace("[0.0, 0.0, 29.261652e-6]", "[0.718277e-6, 1.800197e-6, 29.261652e-6]");
    vehicles::from_toml(&text).expect("valid")
}

/// A craft whose motors may be off.
fn without_thrust(vehicle: &Vehicle) -> Craft {
    let mut craft = Craft::new(vehicle);
    craft.motors.motors.iter_mut().for_each(|motor| motor.thrust_min_n = 0.0);
    craft
}

fn tumbling() -> RigidState {
    let mut state = RigidState::at_rest(Vector3::zeros(), 0.0);
    state.body_rates_rad_s = Vector3::new(3.0, -5.0, 8.0);
    state.attitude = UnitQuaternion::from_euler_angles(0.3, -0.7, 1.9);
    state
}

#[test]
fn free_fall_is_a_parabola() {
    let mut start = RigidState::at_rest(Vector3::new(1.0, 2.0, 3.0), 0.0);
    start.velocity_m_s = Vector3::new(0.5, -0.25, 2.0);
    let end = without_thrust(&vehicle()).hold(&start, &Vector4::zeros(), 0.0, 1.5);
    let fallen = start.position_m + start.velocity_m_s * 1.5 - Vector3::new(0.0, 0.0, 0.5 * G * 1.5 * 1.5);
    // The method is exact for it: 750 roundings of numbers up to 20 remain.
    assert!((end.position_m - fallen).norm() < 1e-12);
    assert!((end.velocity_m_s.z - (2.0 - G * 1.5)).abs() < 1e-12);
}

#[test]
fn hover_trim_stays() {
    for name in vehicles::names() {
        let vehicle = vehicles::by_name(name).expect("built in");
        let start = RigidState::at_rest(Vector3::new(0.0, 0.0, 1.0), vehicle.hover_thrust_n());
        let commands = Vector4::repeat(vehicle.hover_thrust_n());
        let end = Craft::new(&vehicle).hold(&start, &commands, 0.0, 10.0);
        // An acceleration of a rounding of g, 2e-15 m/s^2, for 10 s.
        assert!((end.position_m - start.position_m).norm() < 1e-12, "{name}");
        assert!(end.attitude.angle() < 1e-12 && end.thrusts_n == start.thrusts_n, "{name}");
    }
}

#[test]
fn a_tumbling_body_keeps_energy_and_angular_momentum() {
    let vehicle = skewed();
    let craft = without_thrust(&vehicle);
    let inertia = craft.body.inertia_kg_m2();
    let momentum = |x: &RigidState| x.attitude * (inertia * x.body_rates_rad_s);
    let energy = |x: &RigidState| {
        let (v, w) = (x.velocity_m_s, x.body_rates_rad_s);
        let height = craft.body.mass_kg() * G * x.position_m.z;
        0.5 * craft.body.mass_kg() * v.norm_squared() + 0.5 * w.dot(&(inertia * w)) + height
    };
    let start = tumbling();
    let end = craft.hold(&start, &Vector4::zeros(), 0.0, 5.0);
    // Steps of 2 ms at 10 rad/s: (0.02)^4 / 120 a step, of 2,500 steps, is 3e-6; it is less by the order's constant.
    let turned = start.attitude.angle_to(&end.attitude);
    assert!(turned > 0.1, "it did tumble: {turned}");
    assert!((momentum(&end) - momentum(&start)).norm() < 1e-6 * momentum(&start).norm());
    let rotation = 0.5 * start.body_rates_rad_s.dot(&(inertia * start.body_rates_rad_s));
    assert!((energy(&end) - energy(&start)).abs() < 1e-6 * rotation);
}

#[test]
fn halving_the_step_divides_the_error_by_sixteen() {
    // Rotors away from trim, so that thrust, rotation and translation all change.
    let vehicle = skewed();
    let craft = Craft::new(&vehicle);
    let mut start = tumbling();
    start.thrusts_n = Vector4::new(0.05, 0.08, 0.06, 0.07);
    let commands = Vector4::new(0.09, 0.05, 0.08, 0.04);
    let end = |steps: u32| {
        let h = 0.4 / f64::from(steps);
        (0..steps).fold(start, |x, _| craft.step(&x, &commands, 0.0, h))
    };
    let truth = end(3200);
    let error = |steps: u32| {
        let x = end(steps);
        (x.position_m - truth.position_m).norm() + x.attitude.angle_to(&truth.attitude)
    };
    let order = (error(50) / error(100)).log2();
    // The next term is smaller by h w = 8e-3 * 10.
    assert!((order - 4.0).abs() < 0.1, "observed order {order}");
}

#[test]
fn a_symmetric_top_precesses_as_euler_says() {
    let text = include_str!("../../../../gains/vehicles/crazyflie-2.1.toml").replace("16.655602e-6", "16.571710e-6");
    let vehicle = vehicles::from_toml(&text).expect("valid");
    let mut start = RigidState::at_rest(Vector3::zeros(), 0.0);
    start.body_rates_rad_s = Vector3::new(4.0, 0.0, 6.0);
    let end = without_thrust(&vehicle).hold(&start, &Vector4::zeros(), 0.0, 2.0);
    let rate: f64 = (29.261_652 / 16.571_71 - 1.0) * 6.0;
    let expected = Vector3::new(4.0 * (rate * 2.0).cos(), 4.0 * (rate * 2.0).sin(), 6.0);
    // RK4 on a rotation at 4.6 rad/s: (rate h)^4 / 120 of a turn at that rate over 2 s.
    assert!((end.body_rates_rad_s - expected).norm() < 4.0 * (rate * 0.002_f64).powi(4) / 120.0 * rate * 2.0 * 2.0);
}

#[test]
fn each_pattern_of_thrust_turns_its_own_axis() {
    let vehicle = vehicle();
    let (craft, hover) = (Craft::new(&vehicle), vehicle.hover_thrust_n());
    let (a, c) = (0.046 / 2.0_f64.sqrt(), 0.006_992_894_899_247_056_5);
    let patterns = [([-1.0, -1.0, 1.0, 1.0], a), ([-1.0, 1.0, 1.0, -1.0], a), ([-1.0, 1.0, -1.0, 1.0], c)];
    for (axis, (signs, lever)) in patterns.into_iter().enumerate() {
        let mut start = RigidState::at_rest(Vector3::zeros(), hover);
        start.thrusts_n += Vector4::from(signs) * 1e-3;
        let end = craft.hold(&start, &start.thrusts_n, 0.0, 0.1);
        let acceleration = 4.0 * lever * 1e-3 / craft.body.inertia_kg_m2()[(axis, axis)];
        let mut expected = Vector3::zeros();
        expected[axis] = acceleration * 0.1;
        // About a principal axis nothing else happens: roundings only.
        assert!((end.body_rates_rad_s - expected).norm() < 1e-12, "axis {axis}: {}", end.body_rates_rad_s);
        let angle = 0.5 * acceleration * 0.01;
        // RK4 on a growing rate: (h/2)^4 of its fifth derivative.
        assert!((end.attitude.scaled_axis()[axis] - angle).abs() < 1e-9, "axis {axis}");
    }
}

#[test]
fn thrust_follows_its_command_with_its_own_lag_each_way_within_its_limits() {
    let vehicle = vehicle();
    let mut craft = Craft::new(&vehicle);
    craft.motors = craft.motors.with_lag(0.08, 0.12);
    let start = RigidState::at_rest(Vector3::zeros(), 0.07);
    let end = craft.hold(&start, &Vector4::new(0.1, 0.04, 1.0, -1.0), 0.0, 0.1);
    let least = vehicle.motors().thrust_min_n;
    let expected = [(0.1, 0.08), (0.04, 0.12), (0.12, 0.08), (least, 0.12)]
        .map(|(goal, lag)| goal + (0.07 - goal) * f64::exp(-0.1 / lag));
    for (thrust, expected) in end.thrusts_n.iter().zip(expected) {
        // RK4 on an exponential: (h/tau)^5/120 a step, of 50 steps: 4e-9 of 0.07.
        assert!((thrust - expected).abs() < 1e-9, "{thrust} {expected}");
    }
}

#[test]
fn a_shove_gives_its_impulse() {
    let vehicle = vehicle();
    let force_n = Vector3::new(0.03, -0.01, 0.0);
    let craft = Craft::new(&vehicle).with_load(Shove { from_s: 0.1, to_s: 0.3, force_n });
    let start = RigidState::at_rest(Vector3::zeros(), vehicle.hover_thrust_n());
    let end = craft.hold(&start, &start.thrusts_n, 0.0, 0.5);
    // To the step of 2 ms in which it begins or ends.
    assert!((end.velocity_m_s - force_n * 0.2 / 0.029).norm() < 2.0 * 0.002 * force_n.norm() / 0.029);
}

#[test]
fn a_dropped_craft_comes_to_stand_on_its_feet() {
    for name in vehicles::names() {
        let vehicle = vehicles::by_name(name).expect("built in");
        let craft = without_thrust(&vehicle).with_load(Ground::under(&vehicle));
        let mut x = RigidState::at_rest(Vector3::new(0.0, 0.0, 0.06), 0.0);
        x.attitude = UnitQuaternion::from_euler_angles(0.1, -0.05, 0.3);
        x.velocity_m_s.x = 0.3;
        let mut lowest = f64::INFINITY;
        for _ in 0..200 {
            x = craft.hold(&x, &Vector4::zeros(), 0.0, 0.01);
            lowest = lowest.min(x.position_m.z);
        }
        assert!((x.position_m.z - Ground::standing_height_m()).abs() < 1e-6, "{name}: {}", x.position_m.z);
        // Friction that creeps holds no position, but everything has come to rest.
        assert!(x.velocity_m_s.norm() < 1e-6 && x.body_rates_rad_s.norm() < 1e-4, "{name}: {x:?}");
        assert!(x.thrust_axis().z > 1.0 - 1e-9, "{name}");
        assert!(lowest > 0.0, "{name}: {lowest}");
    }
}
