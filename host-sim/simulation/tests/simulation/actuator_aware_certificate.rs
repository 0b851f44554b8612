//! Certificates of actuator-aware gains: its own loop, a region of craft, and where it ends.

use quatrack_design::certify::{Controller, Plant, Region, Timing, certify, certify_region, motor_lag_limit};
use quatrack_design::design::actuator_aware::{ActuatorAwareDesign, ActuatorAwareWeights, actuator_aware};
use quatrack_design::vehicle::Vehicle;
use quatrack_simulation::vehicles;

const PERIOD_S: f64 = 0.002;

fn design(vehicle: &Vehicle, lag_s: f64) -> ActuatorAwareDesign {
    actuator_aware(vehicle, lag_s, &ActuatorAwareWeights::STANDARD, PERIOD_S).expect("solved")
}

#[test]
fn a_predicted_actuator_that_is_right_leaves_the_poles_where_the_design_put_them() {
    let vehicle = vehicles::by_name("crazyflie-2.1").expect("built in");
    let lag_s = 0.126;
    let design = design(&vehicle, lag_s);
    let plant = Plant::hover_with_motors(&vehicle, lag_s, 1.0, 1.0);
    let controller = Controller::actuator_aware(&design.gain_in_parts, lag_s, PERIOD_S);
    let timing = Timing { period_s: PERIOD_S, delay_samples: 0 };
    let certificate = certify(&plant, &controller, &timing, None).expect("stable");
    // Separation: the poles of the design and four of the prediction's error, at its decay.
    let mut found: Vec<f64> = certificate.sampled.poles.iter().map(|[re, im]| re.hypot(*im)).collect();
    let mut expected: Vec<f64> = design.poles.iter().map(|pole| pole.norm()).collect();
    expected.extend([(-PERIOD_S / lag_s).exp(); 4]);
    found.sort_by(f64::total_cmp);
    expected.sort_by(f64::total_cmp);
    for (found, expected) in found.iter().zip(&expected) {
        // The gain was rounded to 24 bits; poles that lie close together move by the root of that.
        assert!((found - expected).abs() < 3e-6, "{found} {expected}");
    }
    assert!(certificate.sampled.decrease.holds);
    assert_eq!(certificate.sampled.margins.each.len(), 4);
    // Every channel tolerates a change of gain by a third and 25 degrees, with the motors predicted and not measured.
    for margins in &certificate.sampled.margins.each {
        assert!(margins.balanced.gain_min < 0.75 && margins.balanced.phase_rad > 0.4, "{margins:?}");
    }
}

#[test]
fn the_default_tables_hold_all_over_the_published_lags() {
    for (name, lag_s, radius) in [
        // From numpy 2.4 and scipy 1.17 on the same grid, each chain by itself.
        ("crazyflie-2.1", 0.126, 0.997_915_73),
        ("crazyflie-2.1-upgrade-kit", 0.1, 0.997_910_82),
        ("crazyflie-2.1-brushless", 0.1, 0.997_939_95),
    ] {
        let vehicle = vehicles::by_name(name).expect("built in");
        let design = design(&vehicle, lag_s);
        let region = Region::of_any_crazyflie();
        let found = certify_region(&vehicle, &design.gain_in_parts, lag_s, PERIOD_S, &region).expect("computed");
        assert_eq!(found.points, 7 * 3 * 3 * 3);
        // The gain here is rounded to 24 bits.
        assert!((found.spectral_radius - radius).abs() < 1e-6, "{name}: {} {:?}", found.spectral_radius, found.worst);
    }
}

#[test]
fn tables_for_a_known_lag_hold_from_half_to_one_and_a_half_of_it() {
    for name in vehicles::names() {
        let vehicle = vehicles::by_name(name).expect("built in");
        for lag_s in [0.0635, 0.126] {
            let design = design(&vehicle, lag_s);
            let region = Region::around_lag(lag_s);
            let found = certify_region(&vehicle, &design.gain_in_parts, lag_s, PERIOD_S, &region).expect("computed");
            assert!(found.spectral_radius < 0.9985, "{name} {lag_s}: {}", found.spectral_radius);
        }
    }
}

#[test]
fn the_lag_limit_parts_stable_from_unstable() {
    let vehicle = vehicles::by_name("crazyflie-2.1").expect("built in");
    let design = design(&vehicle, 0.0635);
    let limit = motor_lag_limit(&vehicle, &design.gain_in_parts, 0.0635, PERIOD_S).expect("computed");
    for (share, stable) in [(0.999, true), (1.001, false)] {
        let lag_s = share * limit.stable_to_s;
        let region = Region::of_lags(lag_s, lag_s);
        let found = certify_region(&vehicle, &design.gain_in_parts, 0.0635, PERIOD_S, &region).expect("computed");
        assert_eq!(found.spectral_radius < 1.0, stable, "{lag_s} s: {}", found.spectral_radius);
    }
    // More than twice the lag that it reckons with, and not any: LQR-E tolerates none behind a rate loop.
    assert!(limit.stable_to_s > 2.0 * 0.0635 && limit.stable_to_s < 0.2, "{limit:?}");
}
