//! Smooth flights alone, with noise at every step of the law and a log of every fifth: what is told has to be true, and the rest refused.

use quatrack_identify::identify;
use quatrack_identify::log::ColumnMap;
use quatrack_simulation::scenario::Scenario;
use quatrack_simulation::scenario::file::ScenarioFile;

/// An eight of 20 s, with an estimator, a speed (m/s) and noise.
fn logged(estimator: &str, speed_m_s: f64, noise: &str) -> (Scenario, String) {
    let text = format!(
        "vehicle = \"crazyflie-2.1-brushless\"\nestimator = \"{estimator}\"\nspeed_m_s = {speed_m_s:?}\nduration_s = 20.0\n\
         air = \"vehicle\"\n[noise]\n{noise}\n"
    );
    let scenario = Scenario::checked(&ScenarioFile::parse(&text, "smooth").unwrap(), "smooth", "".as_ref()).unwrap();
    let mut law = scenario.law.start(&scenario.vehicle, &scenario.told).unwrap();
    let recording = scenario.record(law.as_mut(), &scenario.flown(None)).unwrap();
    assert!(recording.flight.lost.is_none());
    let log = recording.to_log(scenario.vehicle.motors().thrust_max_n);
    (scenario, log)
}

#[test]
fn noise_between_the_samples_of_a_log_is_no_figure() {
    let all = "gyro_rad_s = 0.02\naccelerometer_m_s2 = 0.1\nposition_m = 0.001";
    let white = format!("{all}\nvelocity_m_s = 0.01\nattitude_rad = 0.005");
    // White noise of an exact state goes into every command; an estimator's is smooth, and its log tells the inertia.
    for (estimator, speed, noise, inertia_is_told) in [
        ("exact", 1.5, "gyro_rad_s = 0.02", false),
        ("exact", 1.5, "attitude_rad = 0.005", false),
        ("exact", 1.5, "position_m = 0.001\nvelocity_m_s = 0.01", false),
        ("exact", 1.5, &white, false),
        ("kalman", 1.5, all, true),
        ("kalman", 2.1, all, true),
    ] {
        let (scenario, log) = logged(estimator, speed, noise);
        let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("smooth.csv");
        std::fs::write(&path, log).unwrap();
        let (vehicle, map) = (&scenario.vehicle, ColumnMap::built_in("cflib").unwrap());
        let report = identify(&[&path], &map, vehicle, vehicle.mass_kg()).unwrap();
        let _ = std::fs::remove_file(&path);
        let (motors, inertia) = (vehicle.motors(), vehicle.inertia_kg_m2());
        let moment = vehicle.flown().air.as_ref().unwrap().moment_n_m_per_m_s;
        for (name, truth) in [
            ("lag_ms", 1e3 * motors.lag_s),
            ("command_power", 1.0),
            ("thrust_full_n", motors.thrust_max_n),
            ("hover_command", vehicle.hover_thrust_n() / motors.thrust_max_n),
            ("inertia_x_kg_m2", inertia[(0, 0)]),
            ("inertia_y_kg_m2", inertia[(1, 1)]),
            ("moment_x_n_m_per_m_s", moment[0]),
            ("moment_y_n_m_per_m_s", moment[1]),
        ] {
            println!("{estimator} {speed} {noise:?} {name}: {truth:.4e}, {:?}", report.fit.figures[name]);
            match &report.fit.figures[name] {
                Ok(found) => {
                    assert!(found.low <= truth && truth <= found.high, "{noise}: {name}: {truth} of {found:?}");
                }
                Err(_) => assert!(!inertia_is_told, "{noise}: {name}"),
            }
        }
        assert_eq!(report.fit.figures["inertia_x_kg_m2"].is_ok(), inertia_is_told, "{noise}");
    }
}
