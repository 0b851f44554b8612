//! A log of 100 Hz and the same with every second row alone: what is told has to be true, and what hangs on time is refused.

use quatrack_identify::identify;
use quatrack_identify::log::ColumnMap;
use quatrack_simulation::scenario::Scenario;
use quatrack_simulation::scenario::file::ScenarioFile;

/// A flight of 20 s in the vehicle's air with the noise of its sensors, as cflib logs it.
fn logged(vehicle: &str, seed: u64) -> (Scenario, String) {
    let text = format!(
        "vehicle = \"{vehicle}\"\nseed = {seed}\nspeed_m_s = 1.6\nduration_s = 20.0\nair = \"vehicle\"\n[noise]\ngyro_rad_s = 0.02\n\
         position_m = 0.001\nvelocity_m_s = 0.01\nattitude_rad = 0.003\naccelerometer_m_s2 = 0.5\n"
    );
    let scenario = Scenario::checked(&ScenarioFile::parse(&text, "slow").unwrap(), "slow", "".as_ref()).unwrap();
    let mut law = scenario.law.start(&scenario.vehicle, &scenario.told).unwrap();
    let recording = scenario.record(law.as_mut(), &scenario.flown(None)).unwrap();
    assert!(recording.flight.lost.is_none());
    let log = recording.to_log(scenario.vehicle.motors().thrust_max_n);
    (scenario, log)
}

#[test]
fn a_log_slower_than_100_hz_tells_no_lag() {
    for (craft, seed) in [("crazyflie-2.1", 5), ("crazyflie-2.1-brushless", 6)] {
        let (scenario, log) = logged(craft, seed);
        let (vehicle, map) = (&scenario.vehicle, ColumnMap::built_in("cflib").unwrap());
        let (motors, inertia) = (vehicle.motors(), vehicle.inertia_kg_m2());
        let truths = [
            ("lag_ms", 1e3 * motors.lag_s),
            ("inertia_x_kg_m2", inertia[(0, 0)]),
            ("inertia_y_kg_m2", inertia[(1, 1)]),
            ("thrust_full_n", motors.thrust_max_n),
            ("hover_command", vehicle.hover_thrust_n() / motors.thrust_max_n),
        ];
        for every in [1, 2] {
            let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("slow-{every}.csv"));
            let rows = log.lines().skip(1).step_by(every);
            std::fs::write(&path, log.lines().take(1).chain(rows).collect::<Vec<_>>().join("\n")).unwrap();
            let report = identify(&[&path], &map, vehicle, vehicle.mass_kg()).unwrap();
            let _ = std::fs::remove_file(&path);
            for (name, truth) in truths {
                println!("{craft}, every {every}: {name}: {truth:.4e}, {:?}", report.fit.figures[name]);
                let hangs_on_time = name.starts_with("lag") || name.starts_with("inertia");
                match &report.fit.figures[name] {
                    Ok(found) => {
                        assert!(every == 1 || !hangs_on_time, "{craft}, every {every}: {name}: {found:?}");
                        assert!(
                            found.low <= truth && truth <= found.high,
                            "{craft}, every {every}: {name}: {truth} of {found:?}"
                        );
                    }
                    Err(reason) if hangs_on_time && every == 2 => {
                        assert!(reason.contains("every 20.0 ms") && reason.contains("at 100 Hz or more"), "{reason}");
                    }
                    Err(_) => {}
                }
            }
            assert!(report.fit.figures["hover_command"].is_ok());
        }
    }
}
