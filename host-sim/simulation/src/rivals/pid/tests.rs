//! One PID by hand, and the cascade of them against its linear law near a hover and its limits far away.

use super::super::testing::{actuation, attitude, hover};
use super::*;
use crate::vehicles;

const MASS_KG: f64 = 0.029;

fn law() -> CascadedPid {
    let vehicle = vehicles::by_name("crazyflie-2.1").unwrap();
    CascadedPid::new(CascadedPidConfig::firmware(&vehicle, MASS_KG), actuation())
}

#[test]
fn one_pid_by_hand() {
    let config = PidConfig { proportional: 2.0, integral: 10.0, derivative: 0.5, integral_max: 0.3, output_max: 9.0 };
    let mut pid = Pid::new(config);
    // e = 1, integral 0.1, nothing to differ from: 2 + 1. Then e = 0.8, integral 0.18, y' = 2: 1.6 + 1.8 - 1.
    assert!((pid.step(1.0, 0.0, 0.1) - 3.0).abs() < 1e-12);
    assert!((pid.step(1.0, 0.2, 0.1) - 2.4).abs() < 1e-12);
    // e = 1 twice more: the integral ends at 0.3. Then the output ends at 9.
    pid.step(1.2, 0.2, 0.1);
    assert!((pid.step(1.2, 0.2, 0.1) - 5.0).abs() < 1e-12);
    assert!((pid.step(5.2, 0.2, 0.1) - 9.0).abs() < 1e-12);
}

#[test]
fn at_hover_it_gives_its_base_thrust_and_then_finds_the_weight() {
    // 36000 of 65535 of 0.48 N.
    let mut law = law();
    let output = law.force_torque(&hover());
    assert!((output.force_n - 36_000.0 * 0.48 / 65_535.0).abs() < 1e-15 && output.torque_n_m.norm() < 1e-18);
    // 1 mm too low for 1 s, at rest: 2e-3 + 0.5e-3 m/s wanted at its end, 25 of it by proportion and 15 by
    // integral, which is 2e-3 s + 0.25e-3 s; the sums of 100 steps of 10 ms are 1 % above the integral of the integral.
    let mut input = hover();
    input.estimate.position_m.z = -1e-3;
    let mut output = ForceTorque::default();
    for _ in 0..500 {
        output = law.force_torque(&input);
    }
    let numbers = 1000.0 * (25.0 * 2.5e-3 + 15.0 * (2e-3 + 0.5e-3 * 0.505));
    let climb = (output.force_n - 36_000.0 * 0.48 / 65_535.0) * 65_535.0 / 0.48;
    assert!((climb - numbers).abs() < 1e-9, "{climb} {numbers}");
}

#[test]
fn near_a_hover_it_is_its_linear_law() {
    let mut input = hover();
    let (x, v, pitch, rate) = (1e-4, -2e-4, 3e-4, 4e-4);
    input.estimate.position_m.x = x;
    input.estimate.velocity_m_s.x = v;
    input.estimate.attitude = attitude(0.0, pitch);
    input.estimate.body_rates_rad_s.y = rate;
    let output = law().force_torque(&input);
    // Wanted speed -2 x; 25 degrees a m/s and 1 of its integral over 10 ms; 6 1/s and 3 of the integral over 2 ms; 250
    // numbers for a degree a second and 500 of the integral.
    let wanted_pitch = (25.0_f64.to_radians() + 1.0_f64.to_radians() * 0.01) * (-2.0 * x - v);
    let wanted_rate = (6.0 + 3.0 * 0.002) * (wanted_pitch - pitch);
    let numbers = (250.0 + 500.0 * 0.002) * (wanted_rate - rate).to_degrees();
    let torque = numbers * actuation().torque_per_number().y;
    assert!((output.torque_n_m.y - torque).abs() < 1e-12 * torque.abs(), "{} {torque}", output.torque_n_m.y);
}

#[test]
fn far_away_it_tilts_by_20_degrees_and_flies_at_its_speed() {
    // 5 m behind: 1.1 m/s wanted; at 1 m/s already, 25 degrees of 0.1 m/s are left; at rest 20 degrees are the most.
    let mut law = law();
    let mut input = hover();
    input.setpoint.position_m.y = 5.0;
    law.force_torque(&input);
    assert!((law.tilt_rad.x + 20_f64.to_radians()).abs() < 1e-12, "{}", law.tilt_rad);
    let mut fast = self::law();
    input.estimate.velocity_m_s.y = 1.0;
    fast.force_torque(&input);
    let degrees = -(25.0 + 0.01) * 0.1;
    assert!((fast.tilt_rad.x.to_degrees() - degrees).abs() < 1e-9, "{}", fast.tilt_rad.x.to_degrees());
}

#[test]
fn headings_count_by_their_direction() {
    // Heading 179 degrees, wanted -179: 2 degrees to the left, 6 1/s, and forwards is -x.
    let mut input = hover();
    input.estimate.attitude = attitude(179_f64.to_radians(), 0.0);
    input.setpoint.heading_rad = -(179_f64.to_radians());
    let output = law().force_torque(&input);
    let wanted = (6.0 + 1.0 * 0.002) * 2.0;
    let numbers = (120.0 + 16.7 * 0.002) * wanted;
    let torque = numbers * actuation().torque_per_number().z;
    assert!((output.torque_n_m.z - torque).abs() < 1e-9 * torque, "{} {torque}", output.torque_n_m.z);
}

#[test]
fn the_firmwares_base_thrust_is_that_of_its_own_crafts() {
    let built_in = vehicles::by_name("crazyflie-2.1").unwrap();
    let force = Actuation::of(&built_in).force_per_number();
    assert_eq!(CascadedPidConfig::firmware(&built_in, 0.05).thrust_base_n, 36_000.0 * force);
    // One gram heavier, it is another craft of the same name.
    let text = include_str!("../../../../../gains/vehicles/crazyflie-2.1.toml");
    let heavier = text.replace("mass_kg = 0.029", "mass_kg = 0.03");
    assert_ne!(heavier, text);
    let own = vehicles::from_toml(&heavier).unwrap();
    assert_eq!(own.name(), built_in.name());
    assert!((CascadedPidConfig::firmware(&own, 0.03).thrust_base_n - 0.03 * GRAVITY_M_S2).abs() < 1e-15);
}
