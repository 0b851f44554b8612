//! The Crazyflie's controller in air, through its C interface: crafts as they were identified from real flights, with noise.

use std::path::Path;

use quatrack_simulation::scenario::file::ScenarioFile;
use quatrack_simulation::scenario::{Law, Scenario};

/// Drag, airflow moment, rise and fall of the motors and delay as identified (arXiv 2512.14450), mass told, nothing else.
const BRUSHLESS: &str = "vehicle = \"crazyflie-2.1-brushless-45g\"\nCOURSE\n[air]\ndrag_per_s = [0.447, 0.435, 0.45]\n\
    moment_n_m_per_m_s = [7.0e-4, 9.1e-4]\n[errors]\nlag_rise_ms = 30.0\nlag_fall_ms = 47.0\ndelay_ms = 5.0\n";

/// The same of the brushed craft (arXiv 2603.09908), the motors' lag told.
const BRUSHED: &str = "vehicle = \"crazyflie-2.1\"\nCOURSE\n[air]\ndrag_per_s = [0.39, 0.40, 0.39]\n\
    moment_n_m_per_m_s = [3.8e-4, 4.3e-4]\n[errors]\nmass_factor = 0.931\nlag_ms = 67.0\ndelay_ms = 4.0\n\
    [told]\nmass_kg = 0.027\nlag_ms = 63.5\n";

const NOISE: &str = "[noise]\ngyro_rad_s = 0.02\nposition_m = 0.001\nvelocity_m_s = 0.01\n";

/// Position error's integral, m s.
fn strayed(craft: &str, course: &str) -> f64 {
    let text = format!("{}{NOISE}", craft.replace("COURSE", course));
    let file = ScenarioFile::parse(&text, "here").unwrap();
    let scenario = Scenario { law: Law::Crazyflie, ..Scenario::checked(&file, "here", Path::new("")).unwrap() };
    let mut law = scenario.law.start(&scenario.vehicle, &scenario.told).unwrap();
    let flight = scenario.fly(law.as_mut(), &scenario.flown(None)).unwrap();
    assert!(flight.lost.is_none(), "{course}: {:?}", flight.lost);
    flight.iae_m_s().unwrap()
}

#[test]
fn identified_crafts_fly_eights_in_their_air() {
    // Bitcraze's best controller on these flights: 0.51, 1.29, 1.68 on the Brushless, 0.31, 0.68, 1.06 on the brushed one.
    for (name, craft, bounds) in
        [("Brushless", BRUSHLESS, [0.012, 0.045, 0.10]), ("brushed", BRUSHED, [0.009, 0.020, 0.055])]
    {
        for (speed, bound) in [0.85, 2.1, 3.1].into_iter().zip(bounds) {
            let found = strayed(craft, &format!("course = \"eight\"\nspeed_m_s = {speed}"));
            println!("{name} eight {speed}: {found:.4} of {bound}");
            assert!(found <= bound, "{name} at {speed} m/s: {found} of {bound}");
        }
    }
}

#[test]
fn identified_crafts_step_and_stand_in_wind() {
    for (name, craft, [step, wind]) in [("Brushless", BRUSHLESS, [0.65, 0.03]), ("brushed", BRUSHED, [0.64, 0.023])] {
        let found = strayed(craft, "course = \"step\"\nstep_m = 1.0");
        println!("{name} step: {found:.4} of {step}");
        assert!(found <= step, "{name}: {found} of {step}");
        // A wind that blows all the time.
        let windy = craft.replace("[air]\n", "[air]\nwind_m_s = [1.0, 0.0, 0.0]\n");
        let found = strayed(&windy, "course = \"hover\"");
        println!("{name} wind: {found:.4} of {wind}");
        assert!(found <= wind, "{name}: {found} of {wind}");
    }
}

#[test]
fn any_honest_mass_within_a_fifth_flies() {
    // Plants of RotorPy 3.0.0 and crazyflow 0.4.0, and a mocap deck: their mass is told.
    for (vehicle, mass_kg) in [
        ("crazyflie-2.1-brushless", 0.0434),
        ("crazyflie-2.1-brushless", 0.044),
        ("crazyflie-2.1-brushless", 0.045),
        ("crazyflie-2.1-upgrade-kit", 0.0379),
        ("crazyflie-2.1", 0.034),
    ] {
        let craft = format!(
            "vehicle = \"{vehicle}\"\nCOURSE\n[air]\ndrag_per_s = [0.4, 0.4, 0.4]\n[told]\nmass_kg = {mass_kg}\n[errors]\n\
             mass_factor = MASS\n"
        );
        let own = quatrack_simulation::vehicles::by_name(vehicle).unwrap().mass_kg();
        let craft = craft.replace("MASS", &format!("{}", mass_kg / own));
        let found = strayed(&craft, "course = \"eight\"\nspeed_m_s = 2.1");
        println!("{vehicle} {mass_kg}: {found:.4}");
        assert!(found <= 0.03, "{vehicle} of {mass_kg} kg: {found}");
    }
}
