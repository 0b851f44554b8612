//! The robustness flights and the manoeuvres, held to figures: the f32 core at 500 Hz on the rigid plant.

use std::path::Path;

use quatrack_design::vehicle::Vehicle;
use quatrack_simulation::flight::robustness::{CASES, RobustnessReport, report};
use quatrack_simulation::plant::Air;
use quatrack_simulation::scenario::file::ScenarioFile;
use quatrack_simulation::scenario::manoeuvres::{Manoeuvre, Outcome};
use quatrack_simulation::scenario::{Law, Scenario};
use quatrack_simulation::vehicles;

fn vehicle(name: &str) -> Vehicle {
    vehicles::by_name(name).expect("built in")
}

fn iae(report: &RobustnessReport, law: &str, lag_ms: f64, case: &str) -> Option<f64> {
    let found = report.rows.iter().find(|row| (row.law, row.lag_ms, row.case) == (law, lag_ms, case));
    found.unwrap_or_else(|| panic!("no row of {law}, {lag_ms} ms, {case}")).iae_m_s
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
        let air = if Air::of(&vehicle).is_some() { "air = \"vehicle\"\n" } else { "" };
        let file = ScenarioFile::parse(&format!("vehicle = \"{name}\"\n{air}"), name).expect("parsed");
        let scenario = Scenario::checked(&file, name, Path::new("")).expect("sound");
        for manoeuvre in Manoeuvre::ALL {
            let mut law = Law::Quatrack.start(&scenario.vehicle, &scenario.told).expect("flies it");
            let flight = manoeuvre.fly(&scenario, law.as_mut()).expect("flown");
            let found = Outcome::of(&flight);
            let told = format!("{name}, {}: {found:?}", manoeuvre.name());
            assert!(found.whole && found.end_error_m < 0.005, "{told}");
            let settles_in = |s: f64| found.settled_s.is_some_and(|settled| settled < s);
            match manoeuvre {
                // Spinning up takes a time constant, in which the reference has risen by millimetres.
                Manoeuvre::TakeOff => assert!(found.max_error_m < 0.03, "{told}"),
                // The feet give way by 1 mm under the weight.
                Manoeuvre::Landing => assert!(found.max_error_m < 0.02 && found.min_z_m > 0.012, "{told}"),
                // Of 1 m: the tilt is that of a braking from 2 m/s within it, the height lost a twentieth. The jump is at 0.5 s.
                Manoeuvre::Step => assert!(settles_in(2.1) && found.min_z_m > 0.95, "{told}"),
                Manoeuvre::Shove => assert!(settles_in(1.2) && found.max_error_m < 0.501, "{told}"),
                // Its weight for 0.2 s is 2 m/s; thrust at its most goes to attitude before height.
                Manoeuvre::Gust => assert!(settles_in(2.7) && found.min_z_m > 0.75, "{told}"),
                // A turn by half a circle takes about half a second, a fall of 1.2 m, and as much again is needed to stop.
                Manoeuvre::UpsideDown => assert!(settles_in(3.5) && found.min_z_m > 13.0, "{told}"),
            }
        }
    }
}
