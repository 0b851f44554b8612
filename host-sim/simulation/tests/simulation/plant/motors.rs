//! Motors as they are: momentum of the rotors, lag and delay, force by command and voltage, a weak one, a centre of mass that
//! is off.

use nalgebra::{UnitQuaternion, Vector3, Vector4};
use quatrack_design::vehicle::Vehicle;
use quatrack_simulation::plant::{Battery, Craft, Environment, ForceMap, Plant, Propeller, RigidState, Supply, Truth};
use quatrack_simulation::vehicles;

fn vehicle() -> Vehicle {
    vehicles::by_name("crazyflie-2.1-brushless").expect("built in")
}

/// arXiv 2603.05944's thrust and arXiv 2512.14450's inertia.
fn propeller() -> Propeller {
    Propeller::quadratic(4.052e-8, 6.2e-8)
}

fn plant(truth: &Truth) -> Plant {
    let start = RigidState::at_rest(Vector3::z(), vehicle().hover_thrust_n());
    Plant::new(&vehicle(), &Environment::VACUUM, truth, &start, 1).expect("in range")
}

#[test]
fn body_and_rotors_together_keep_their_angular_momentum() {
    let mut craft = Craft::new(&vehicle());
    craft.motors.propeller = Some(propeller());
    for motor in &mut craft.motors.motors {
        // Nothing but gravity from outside: thrust through the centre of mass, and no torque of the air; the sign says how
        // each turns.
        motor.position_m = Vector3::zeros();
        motor.torque_per_thrust_m *= 1e-300;
    }
    let momentum = |x: &RigidState| {
        let rotors = Vector3::new(0.0, 0.0, craft.motors.momentum_n_m_s(&x.thrusts_n));
        x.attitude * (craft.body.inertia_kg_m2() * x.body_rates_rad_s + rotors)
    };
    let mut x = RigidState::at_rest(Vector3::zeros(), 0.09);
    x.thrusts_n = Vector4::new(0.05, 0.1, 0.03, 0.15);
    x.attitude = UnitQuaternion::from_euler_angles(0.3, -0.7, 1.9);
    x.body_rates_rad_s = Vector3::new(3.0, -2.0, 1.0);
    let start = momentum(&x);
    let (mut handed_over, first) = (0.0_f64, craft.motors.momentum_n_m_s(&x.thrusts_n));
    for k in 0..500_u32 {
        let way = if (k / 50) % 2 == 0 { 1.0 } else { -1.0 };
        let commands = Vector4::new(0.1 + 0.06 * way, 0.1 - 0.06 * way, 0.1 + 0.06 * way, 0.1 - 0.06 * way);
        x = craft.hold(&x, &commands, 0.0, 0.002);
        handed_over = handed_over.max((craft.motors.momentum_n_m_s(&x.thrusts_n) - first).abs());
    }
    assert!(handed_over > 0.5 * start.norm(), "the rotors take part: {handed_over} of {}", start.norm());
    // RK4 at 2 ms with rates of 10 rad/s and lags of 50 ms: (h / 50 ms)^4 / 120 a step.
    assert!((momentum(&x) - start).norm() < 1e-6 * start.norm(), "{} {}", momentum(&x), start);
}

#[test]
fn a_rotor_that_speeds_up_turns_the_body_the_other_way() {
    // Motor 2 turns clockwise, so that the air turns the body anticlockwise; while it speeds up, its inertia does so, too.
    let torque = |propeller: Option<Propeller>| {
        let mut craft = Craft::new(&vehicle());
        craft.motors.propeller = propeller;
        let hover_n = vehicle().hover_thrust_n();
        let state = RigidState::at_rest(Vector3::zeros(), hover_n);
        let commands = Vector4::repeat(hover_n) + Vector4::new(0.0, 0.05, 0.0, 0.0);
        craft.motion(&state, &commands, &Default::default(), 0.0).angular_acceleration_rad_s2.z * 59e-6
    };
    let (hover_n, lag_s) = (vehicle().hover_thrust_n(), vehicle().motors().lag_s);
    // J W' with W' = f' / (2 k W) and f' = 0.05 N / lag.
    let expected = 6.2e-8 * 0.05 / lag_s / (2.0 * (4.052e-8 * hover_n).sqrt());
    assert!((torque(Some(propeller())) - torque(None) - expected).abs() < 1e-12, "{expected}");
    assert!(torque(None).abs() < 1e-12);
}

#[test]
fn thrust_rises_and_falls_with_its_own_lag_after_the_delay() {
    let vehicle = vehicle();
    let truth = Truth { rise_lag_s: 0.030, fall_lag_s: 0.047, delay_s: 0.005, ..Truth::as_designed(&vehicle) };
    let mut plant = plant(&truth);
    let hover_n = vehicle.hover_thrust_n();
    let commands = Vector4::new(hover_n + 0.02, hover_n - 0.02, hover_n, 1.0);
    plant.advance(&commands, 0.004);
    assert_eq!(plant.state().thrusts_n, Vector4::repeat(hover_n), "nothing has arrived");
    plant.advance(&commands, 0.041);
    let found = plant.state().thrusts_n;
    let after = |goal: f64, lag: f64| goal + (hover_n - goal) * f64::exp(-0.040 / lag);
    let most_n = vehicle.motors().thrust_max_n;
    let expected = [after(hover_n + 0.02, 0.030), after(hover_n - 0.02, 0.047), hover_n, after(most_n, 0.030)];
    for (found, expected) in found.iter().zip(expected) {
        // RK4 on an exponential: (2 ms / 30 ms)^5 / 120 of 0.1 N a step.
        assert!((found - expected).abs() < 1e-8, "{found} {expected}");
    }
}

#[test]
fn force_follows_the_map_and_the_battery_takes_the_top_away() {
    let vehicle = vehicle();
    // arXiv 2512.14450: F = 0.235 u^1.53 (V/3.7)^1.5 N.
    let map = ForceMap { full_n: 0.235, command_power: 1.53, voltage_power: 1.5, reference_v: 3.7 };
    let truth = |supply| Truth { force_map: Some(map), supply, ..Truth::as_designed(&vehicle) };
    let mut constant = plant(&truth(Supply::Constant(3.5)));
    constant.advance(&Vector4::repeat(0.1), 2.0);
    // Half of the 0.2 N that the firmware believes in.
    let expected = 0.235 * 0.5_f64.powf(1.53) * (3.5_f64 / 3.7).powf(1.5);
    assert!((constant.state().thrusts_n[0] - expected).abs() < 1e-12, "{expected}");
    let [least, most] = constant.thrust_limits_n();
    assert!((most[0] - 0.235 * (3.5_f64 / 3.7).powf(1.5)).abs() < 1e-12 && least[0] > 0.0);
    let battery = Battery {
        capacity_a_s: 0.35 * 3600.0,
        open_circuit_v: [3.0, 3.78, 3.83, 3.87, 3.89, 3.92, 3.96, 4.0, 4.04, 4.1, 4.2],
        resistance_ohm: 0.1,
        current_a_per_n15: 25.0,
    };
    let mut emptying = plant(&truth(Supply::Battery { battery, charge: 0.8 }));
    let before = emptying.thrust_limits_n()[1][0];
    for _ in 0..50 {
        emptying.advance(&Vector4::repeat(0.2), 0.1);
    }
    let full = emptying.thrust_limits_n()[1][0];
    assert!(full < 0.98 * before, "{full} {before}");
    // The steady state of voltage and force, found by its own fixed point.
    let charge = emptying.charge().expect("a battery");
    let (mut force, mut voltage) = (0.2_f64, 0.0);
    for _ in 0..200 {
        voltage = battery.open_circuit_v(charge) - 0.1 * 25.0 * 4.0 * force.powf(1.5);
        force = 0.235 * (voltage / 3.7_f64).powf(1.5);
    }
    // The charge falls by 2e-5 of itself in a lag.
    assert!((emptying.state().thrusts_n[0] / force - 1.0).abs() < 1e-4, "{force} at {voltage} V");
}

#[test]
fn a_dead_motor_tips_the_craft_towards_it_and_a_falling_factor_sinks_it() {
    let vehicle = vehicle();
    let hover = Vector4::repeat(vehicle.hover_thrust_n());
    let mut dead = plant(&Truth { motor_strength: [0.0, 1.0, 1.0, 1.0], ..Truth::as_designed(&vehicle) });
    dead.advance(&hover, 0.1);
    // Motor 1 is in front on the right: the nose and the right side go down.
    let rates = dead.state().body_rates_rad_s;
    assert!(rates.x > 1.0 && rates.y > 1.0, "{rates}");
    let mut weak = plant(&Truth { thrust_factor: 0.97, thrust_factor_per_s: -0.01, ..Truth::as_designed(&vehicle) });
    weak.advance(&hover, 7.0);
    let share = weak.state().thrusts_n[0] / vehicle.hover_thrust_n();
    // It lags behind 0.97 - 0.07 by 0.01/s times the lag.
    assert!((share - 0.90 - 0.01 * vehicle.motors().lag_s).abs() < 2e-5, "{share}");
}

#[test]
fn a_centre_of_mass_that_is_off_is_a_torque_of_the_thrust() {
    let vehicle = vehicle();
    let hover_n = vehicle.hover_thrust_n();
    let rates = |truth: Truth| {
        let mut plant = plant(&truth);
        plant.advance(&Vector4::repeat(hover_n), 0.01);
        plant.state().body_rates_rad_s
    };
    let off = Vector3::new(0.0005, -0.0003, 0.0);
    let moved = rates(Truth { centre_of_mass_m: off, ..Truth::as_designed(&vehicle) });
    // The thrust acts at -c: -c x (0, 0, 4 f) = (-c_y, c_x, 0) 4 f.
    let torque = Vector3::new(-off.y, off.x, 0.0) * 4.0 * hover_n;
    let biased = rates(Truth { torque_bias_n_m: torque, ..Truth::as_designed(&vehicle) });
    assert!((moved - biased).norm() < 1e-12 && moved.norm() > 1e-2, "{moved} {biased}");
}

#[test]
fn an_accelerometer_feels_the_thrust_and_not_gravity() {
    let vehicle = vehicle();
    let mut plant = plant(&Truth::as_designed(&vehicle));
    plant.advance(&Vector4::repeat(vehicle.hover_thrust_n()), 0.002);
    let motion = plant.motion();
    assert!((motion.specific_force_m_s2 - Vector3::new(0.0, 0.0, 9.81)).norm() < 1e-12);
    assert!(motion.acceleration_m_s2.norm() < 1e-12);
}

#[test]
fn the_built_in_figures_are_those_of_the_flights() {
    // 45 g at 0.447 1/s, as a force on 39.3 g.
    let air = quatrack_simulation::plant::Air::of(&vehicle()).expect("known");
    assert!((air.drag_per_s[0] * 0.0393 - 0.447 * 0.045).abs() < 1e-12 && air.moment_n_m_per_m_s == [7.0e-4, 9.1e-4]);
    let truth = Truth::as_flown(&vehicle());
    assert_eq!((truth.rise_lag_s, truth.fall_lag_s, truth.supply), (0.030, 0.047, Supply::Constant(3.7)));
    // J_r over J_z of arXiv 2512.14450.
    let decks = vehicles::by_name("crazyflie-2.1-brushless-45g").expect("built in");
    let inertia = Truth::as_flown(&decks).propeller.expect("known").inertia_kg_m2;
    assert!((inertia / decks.inertia_kg_m2().m33 - 1.0e-3).abs() < 1e-12);
    // The brushed one hovers at 80 to 90 % of its command and 3.3 to 3.5 V (arXiv 2603.09908).
    let brushed = vehicles::by_name("crazyflie-2.1").expect("built in");
    let truth = Truth::as_flown(&brushed);
    let Supply::Battery { battery, .. } = truth.supply else { panic!("a battery") };
    let half = Supply::Battery { battery, charge: 0.5 };
    let hover = Vector4::repeat(0.027 * 9.81 / 4.0);
    let voltage_v = half.voltage_v(&hover);
    let command = (hover[0] / truth.force_map.expect("known").most_n(voltage_v)).sqrt();
    assert!((3.3..3.5).contains(&voltage_v) && (0.8..0.9).contains(&command), "{voltage_v} V, {command}");
}
