//! Figures without sense: key, value, range and remedy in one line.

use nalgebra::Vector3;
use quatrack_simulation::plant::{Dryden, Environment, Plant, RigidState, Truth, Wind};
use quatrack_simulation::vehicles;

fn refused(environment: &Environment, change: impl FnOnce(&mut Truth)) -> String {
    let vehicle = vehicles::by_name("crazyflie-2.1").expect("built in");
    let mut truth = Truth::as_designed(&vehicle);
    change(&mut truth);
    let start = RigidState::at_rest(Vector3::zeros(), 0.0);
    match Plant::new(&vehicle, environment, &truth, &start, 1) {
        Ok(_) => "flown".to_owned(),
        Err(error) => error.to_string(),
    }
}

#[test]
fn a_figure_without_sense_is_named_with_its_range_and_a_remedy() {
    let vacuum = Environment::VACUUM;
    let cases = [
        (refused(&vacuum, |truth| truth.mass_kg = 29e3), "errors.mass_kg = 29000: must be from 0.001 to 1000"),
        (refused(&vacuum, |truth| truth.rise_lag_s = 67.0), "errors.lag_rise_ms = 67000: must be from 1 to 1000"),
        (refused(&vacuum, |truth| truth.fall_lag_s = f64::NAN), "errors.lag_fall_ms = NaN: must be from 1 to 1000"),
        (refused(&vacuum, |truth| truth.delay_s = 5.0), "errors.delay_ms = 5000: must be from 0 to 250"),
        (refused(&vacuum, |truth| truth.centre_of_mass_m.x = 0.5), "errors.centre_of_mass_m = 0.5"),
        (refused(&vacuum, |truth| truth.motor_strength[2] = -1.0), "errors.motor_strength = -1"),
        (refused(&vacuum, |truth| truth.inertia_kg_m2.m33 = -1e-5), "errors.inertia_kg_m2"),
    ];
    for (found, expected) in cases {
        assert!(found.starts_with(expected), "{found}");
        assert!(found.contains('(') && found.lines().count() == 1, "{found}");
    }
}

#[test]
fn a_wind_faster_than_linear_drag_is_good_for_is_refused() {
    let mut environment = Environment { wind: Wind::constant(Vector3::new(4.0, 3.5, 0.0)), ..Environment::VACUUM };
    let found = refused(&environment, |_| ());
    assert!(found.starts_with("air.wind_m_s = 5.3") && found.contains("from 0 to 5"), "{found}");
    environment.wind = Wind {
        mean_m_s: Vector3::new(3.0, 0.0, 0.0),
        turbulence: Some(Dryden::at_low_altitude(Vector3::repeat(1.5), 1.0, 3.0)),
        gust: None,
    };
    let found = refused(&environment, |_| ());
    assert!(found.starts_with("air.gust_rms_m_s = 1.5: must be from 0 to 1 "), "{found}");
    environment.air.drag_per_s[1] = -0.4;
    assert!(refused(&environment, |_| ()).starts_with("air.drag_per_s = -0.4"));
}
