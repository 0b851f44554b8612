//! The air's action on a craft: energy, terminal velocity, the direction of the moment, wind.

use nalgebra::{UnitQuaternion, Vector3, Vector4};
use quatrack_design::vehicle::Vehicle;
use quatrack_simulation::plant::{Airflow, Craft, Dryden, Environment, Gust, Plant, RigidState, Truth, Wind};
use quatrack_simulation::vehicles;

const G: f64 = 9.81;

fn vehicle() -> Vehicle {
    vehicles::by_name("crazyflie-2.1").expect("built in")
}

/// arXiv 2512.14450's, of 45 g.
fn airflow() -> Airflow {
    Airflow {
        drag_n_s_m: Vector3::new(0.0201, 0.0196, 0.0203),
        moment_n_s: [7.0e-4, 9.1e-4],
        lift_n_s2_m2: 0.0034,
        rotors: None,
    }
}

/// A craft whose motors may be off.
fn gliding(air: Airflow) -> Craft {
    let mut craft = Craft { air: Some(air), ..Craft::new(&vehicle()) };
    craft.motors.motors.iter_mut().for_each(|motor| motor.thrust_min_n = 0.0);
    craft
}

#[test]
fn the_airs_work_is_missing_from_the_energy() {
    let craft = gliding(airflow());
    let (mass_kg, inertia) = (craft.body.mass_kg(), *craft.body.inertia_kg_m2());
    let energy = |x: &RigidState| {
        let (v, w) = (x.velocity_m_s, x.body_rates_rad_s);
        0.5 * mass_kg * v.norm_squared() + 0.5 * w.dot(&(inertia * w)) + mass_kg * G * x.position_m.z
    };
    // By the definition of the parts, not by their code.
    let power = |x: &RigidState| {
        let v = x.attitude.inverse_transform_vector(&x.velocity_m_s);
        let drag = -v.component_mul(&Vector3::new(0.0201, 0.0196, 0.0203)).dot(&v);
        let lift = 0.0034 * (v.x * v.x + v.y * v.y) * v.z;
        drag + lift + 7.0e-4 * v.y * x.body_rates_rad_s.x - 9.1e-4 * v.x * x.body_rates_rad_s.y
    };
    let mut x = RigidState::at_rest(Vector3::zeros(), 0.0);
    x.velocity_m_s = Vector3::new(2.0, -1.0, 1.5);
    x.attitude = UnitQuaternion::from_euler_angles(0.3, -0.7, 1.9);
    x.body_rates_rad_s = Vector3::new(1.0, -2.0, 3.0);
    let (start, h, steps) = (energy(&x), 1e-3, 1000);
    let mut work = 0.0;
    for k in 0..steps {
        let middle = craft.step(&x, &Vector4::zeros(), f64::from(k) * h, 0.5 * h);
        let next = craft.step(&middle, &Vector4::zeros(), (f64::from(k) + 0.5) * h, 0.5 * h);
        // Simpson.
        work += h / 6.0 * (power(&x) + 4.0 * power(&middle) + power(&next));
        x = next;
    }
    let missing = energy(&x) - start;
    assert!(work < -0.01, "{work} J");
    // Both methods are of order 4: (h w)^4 with w of 40 rad/s, which the moment makes it tumble with, is 2.6e-6.
    assert!((missing - work).abs() < 1e-6 * work.abs(), "{missing} {work}");
}

#[test]
fn a_falling_craft_reaches_its_terminal_velocity() {
    let craft = gliding(Airflow { drag_n_s_m: Vector3::new(0.0, 0.0, 0.029 * 0.45), ..Airflow::default() });
    let fallen =
        |seconds: f64| craft.hold(&RigidState::at_rest(Vector3::zeros(), 0.0), &Vector4::zeros(), 0.0, seconds);
    let at = |t: f64| -G / 0.45 * (1.0 - (-0.45 * t).exp());
    for seconds in [0.5, 2.0, 60.0] {
        // RK4 on an exponential: (0.45 h)^4 / 120.
        assert!((fallen(seconds).velocity_m_s.z - at(seconds)).abs() < 1e-11, "{seconds} s");
    }
    assert!((fallen(60.0).velocity_m_s.z + 21.8).abs() < 1e-9);
}

#[test]
fn the_moment_turns_the_craft_away_from_the_wind() {
    // Flying forwards pitches the nose up, and to the left rolls left up: both brake.
    let craft = Craft { air: Some(airflow()), ..Craft::new(&vehicle()) };
    let hover_n = vehicle().hover_thrust_n();
    let turned = |velocity: Vector3<f64>| {
        let start = RigidState { velocity_m_s: velocity, ..RigidState::at_rest(Vector3::zeros(), hover_n) };
        let end = craft.hold(&start, &Vector4::repeat(hover_n), 0.0, 1e-4);
        (end.body_rates_rad_s / 1e-4, end.thrust_axis())
    };
    let inertia = craft.body.inertia_kg_m2();
    // 1e-4 s, in which the velocity changes by 1e-4 of itself.
    let (forwards, axis) = turned(Vector3::x());
    assert!((forwards.y / (-9.1e-4 / inertia.m22) - 1.0).abs() < 1e-3 && axis.x < 0.0, "{forwards}");
    assert!(forwards.x.abs() < 1e-3 * forwards.y.abs());
    let (left, axis) = turned(Vector3::y());
    assert!((left.x / (7.0e-4 / inertia.m11) - 1.0).abs() < 1e-3 && axis.y < 0.0, "{left}");
}

#[test]
fn only_the_velocity_through_the_air_counts() {
    let vehicle = vehicle();
    let mut environment = Environment::VACUUM;
    environment.air.drag_per_s = [0.4, 0.5, 0.6];
    environment.air.moment_n_m_per_m_s = [4e-4, 4e-4];
    environment.air.lift_per_m = 0.07;
    let truth = Truth::as_designed(&vehicle);
    let commands = Vector4::new(0.071, 0.0712, 0.0713, 0.0711);
    let wind = Vector3::new(1.0, -2.0, 0.5);
    let fly = |wind_m_s: Vector3<f64>, velocity_m_s: Vector3<f64>| {
        let environment = Environment { wind: Wind::constant(wind_m_s), ..environment.clone() };
        let start = RigidState { velocity_m_s, ..RigidState::at_rest(Vector3::zeros(), 0.07) };
        let mut plant = Plant::new(&vehicle, &environment, &truth, &start, 1).expect("in range");
        plant.advance(&commands, 0.5);
        *plant.state()
    };
    let still = fly(Vector3::zeros(), Vector3::new(0.3, 0.2, 0.0));
    let carried = fly(wind, wind + Vector3::new(0.3, 0.2, 0.0));
    // Galilei; roundings over 250 steps.
    assert!((carried.velocity_m_s - wind - still.velocity_m_s).norm() < 1e-11);
    assert!((carried.position_m - wind * 0.5 - still.position_m).norm() < 1e-11);
    assert!(carried.attitude.angle_to(&still.attitude) < 1e-7);
}

#[test]
fn a_gust_gives_the_velocity_that_its_integral_says() {
    let vehicle = vehicle();
    let gust = Gust { peak_m_s: Vector3::new(2.0, 0.0, 0.0), from_s: 0.1, rise_s: 0.2, stay_s: 0.1 };
    let mut environment = Environment { wind: Wind { gust: Some(gust), ..Wind::default() }, ..Environment::VACUUM };
    environment.air.drag_per_s = [0.4; 3];
    let hover = RigidState::at_rest(Vector3::z(), vehicle.hover_thrust_n());
    let mut plant = Plant::new(&vehicle, &environment, &Truth::as_designed(&vehicle), &hover, 1).expect("in range");
    plant.advance(&Vector4::repeat(vehicle.hover_thrust_n()), 1.0);
    // v' = d (w - v): v(1) = d * integral of w(t) exp(-d (1 - t)), by the midpoint rule with 1e-5 s.
    let expected: f64 = (0..100_000)
        .map(|k| (f64::from(k) + 0.5) * 1e-5)
        .map(|t| 0.4 * gust.at(t).x * (-0.4 * (1.0 - t)).exp() * 1e-5)
        .sum();
    // The wind is a straight line over each step of 2 ms: (pi/0.2)^2 h^2 / 12 of it.
    assert!((plant.state().velocity_m_s.x / expected - 1.0).abs() < 1e-4, "{expected}");
}

#[test]
fn a_flight_is_the_same_to_the_bit_for_the_same_seed() {
    let vehicle = vehicle();
    let turbulence = Dryden::at_low_altitude(Vector3::repeat(0.5), 1.0, 1.0);
    let wind = Wind { mean_m_s: Vector3::new(1.0, 0.5, 0.0), turbulence: Some(turbulence), ..Wind::default() };
    let mut environment = Environment { wind, ..Environment::VACUUM };
    environment.air.drag_per_s = [0.4; 3];
    let fly = |seed: u64, step_s: f64| {
        let hover = RigidState::at_rest(Vector3::z(), vehicle.hover_thrust_n());
        let truth = Truth { delay_s: 0.003, ..Truth::as_designed(&vehicle) };
        let mut plant = Plant::new(&vehicle, &environment, &truth, &hover, seed).expect("in range");
        for _ in 0..(1.0 / step_s + 0.5) as u32 {
            plant.advance(&Vector4::repeat(vehicle.hover_thrust_n()), step_s);
        }
        (*plant.state(), *plant.wind_m_s(), plant.realised_gust_rms_m_s().expect("turbulent"))
    };
    assert_eq!(fly(1, 0.002), fly(1, 0.002));
    assert_ne!(fly(1, 0.002), fly(2, 0.002));
    // Nor does the wind ask how often commands come.
    assert_eq!(fly(1, 0.002).1, fly(1, 0.001).1);
}
