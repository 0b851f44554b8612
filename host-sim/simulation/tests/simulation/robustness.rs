//! The robustness flights and the manoeuvres, held to figures: the f32 core at 500 Hz on the rigid plant.

use quatrack_design::certify::Region;
use quatrack_design::design::actuator_aware::ActuatorAwareWeights;
use quatrack_design::vehicle::Vehicle;
use quatrack_simulation::flight::manoeuvres::{Manoeuvre, Outcome};
use quatrack_simulation::flight::motor_laws::{AwareTable, default_lag_s};
use quatrack_simulation::flight::robustness::{CASES, RobustnessReport, report};
use quatrack_simulation::vehicles;

fn vehicle(name: &str) -> Vehicle {
    vehicles::by_name(name).expect("built in")
}

fn iae(report: &RobustnessReport, law: &str, lag_ms: f64, case: &str) -> Option<f64> {
    let found = report.rows.iter().find(|row| (row.law, row.lag_ms, row.case) == (law, lag_ms, case));
    found.unwrap_or_else(|| panic!("no row of {law}, {lag_ms} ms, {case}")).iae
}

#[test]
fn every_case_is_flown_closer_than_by_the_prototype_of_the_law() {
    let report = report(&vehicle("crazyflie-2.1")).expect("flown");
    // Position error of a one-page prototype in f64 (Python) with the same law, m s, cases in the order of the table.
    let prototype = [
        (63.5, [0.0007, 0.0039, 0.134, 0.136, 0.032, 0.026, 0.0047, 0.011, 0.035, 0.006]),
        (126.0, [0.0007, 0.0034, 0.167, 0.170, 0.052, 0.056, 0.0052, 0.0125, 0.055, 0.006]),
    ];
    for (lag_ms, bounds) in prototype {
        for (case, bound) in CASES.iter().zip(bounds) {
            let found = iae(&report, "actuator-aware", lag_ms, case.name).expect("not lost");
            assert!(found < bound, "{} at {lag_ms} ms: {found} m s", case.name);
        }
    }
    for lag_ms in [63.5, 126.0] {
        for case in &CASES {
            // The default table reckons with 126 ms, twice the shorter lag: 0.2 m s, 2 cm on average, is the fast eight.
            let found = iae(&report, "actuator-aware-robust", lag_ms, case.name).expect("not lost");
            assert!(found < 0.2, "{} at {lag_ms} ms: {found} m s", case.name);
        }
    }
    // Where the lag is the one of the default table, the two are one.
    assert_eq!(
        iae(&report, "actuator-aware", 126.0, "nominal"),
        iae(&report, "actuator-aware-robust", 126.0, "nominal")
    );
    let grounded: Vec<(&str, f64)> = report.not_certified.iter().map(|law| (law.law, law.lag_ms)).collect();
    assert_eq!(grounded, [("lqr-e", 63.5), ("lqr-e", 126.0), ("lyap-e", 126.0)]);
    // Behind the rate loop LYAP-E tolerates 78 ms: at 95 ms it is lost and keeps its row.
    assert_eq!(iae(&report, "lyap-e", 63.5, "lag*1.5"), None);
    assert!(iae(&report, "lyap-e", 63.5, "nominal").is_some());
}

#[test]
fn manoeuvres_end_where_they_should_on_every_vehicle() {
    for name in vehicles::names() {
        let vehicle = vehicle(name);
        let weights = &ActuatorAwareWeights::STANDARD;
        let region = Region::of_any_crazyflie();
        let table = AwareTable::new(&vehicle, default_lag_s(&vehicle), weights, &region).expect("designed");
        assert!(table.gain().is_decoupled(), "{name}");
        for manoeuvre in Manoeuvre::ALL {
            let flight = manoeuvre.fly(&vehicle, vehicle.motors().lag_s, &table).expect("flown");
            let found = Outcome::of(&flight);
            let told = format!("{name}, {}: {found:?}", manoeuvre.name());
            assert!(found.whole && found.end_error_m < 0.005, "{told}");
            match manoeuvre {
                // Spinning up takes a time constant, in which the reference has risen by millimetres.
                Manoeuvre::TakeOff => assert!(found.max_error_m < 0.03 && found.saturated_steps > 0, "{told}"),
                // The feet give way by 1 mm under the weight.
                Manoeuvre::Landing => assert!(found.max_error_m < 0.02 && found.min_z_m > 0.012, "{told}"),
                Manoeuvre::Step => {
                    assert!(found.saturated_steps > 0, "{told}");
                    assert!(found.settled_s.is_some_and(|s| s < 5.0) && found.min_z_m > 0.9, "{told}");
                }
                Manoeuvre::Shove => {
                    assert!(found.max_error_m < 0.501 && found.settled_s.is_some_and(|s| s < 4.0), "{told}");
                }
                Manoeuvre::Gust => assert!(found.max_error_m < 0.5 && found.min_z_m > 0.8, "{told}"),
                Manoeuvre::UpsideDown => {
                    assert!(found.max_tilt_deg > 179.0 && found.min_z_m > 5.0, "{told}");
                    assert!(found.settled_s.is_some_and(|s| s < 2.0), "{told}");
                }
            }
        }
    }
}
