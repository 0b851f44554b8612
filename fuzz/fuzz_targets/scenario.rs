//! Any text as a scenario file: a scenario that can be started, or an error of one line that shows no more than a little of it.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use quatrack_simulation::scenario::Scenario;
use quatrack_simulation::scenario::file::ScenarioFile;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let checked = ScenarioFile::parse(text, "scenario").and_then(|mut file| {
        // No file of this machine is looked at: neither a vehicle's nor a trajectory's.
        file.vehicle.truncate(if file.vehicle.contains(['/', '.']) && !file.vehicle.starts_with("crazyflie-") { 0 } else { usize::MAX });
        Scenario::checked(&file, "scenario", Path::new("/nowhere"))
    });
    match checked {
        Ok(scenario) => {
            // Told figures without sense are a law's to refuse.
            let _ = scenario.law.start(&scenario.vehicle, &scenario.told);
        }
        Err(error) => {
            let line = error.to_string();
            assert!(line.chars().count() < 1000 && !line.chars().any(char::is_control), "{line:?}");
        }
    }
});
