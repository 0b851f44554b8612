use std::path::Path;

use super::*;
use crate::crazyflie::knows;
use crate::flight::rigid_loop::RigidFlight;
use crate::scenario::file::ScenarioFile;
use crate::scenario::{Law, LawError, Scenario};

/// A quadrotor of 1.2 kg, by its name and its motors' lag, s.
fn own(name: &str, lag_s: f64) -> Vehicle {
    vehicles::from_toml(&format!(
        "name = \"{name}\"\n[body]\nmass_kg = 1.2\n\
         inertia_kg_m2 = [[8.0e-3, 0.0, 0.0], [0.0, 8.0e-3, 0.0], [0.0, 0.0, 1.4e-2]]\n[motors]\narm_m = 0.16\n\
         thrust_min_n = 0.1\nthrust_max_n = 8.0\ntorque_per_thrust_m = 0.014\nlag_s = {lag_s}\npublished_lag_s = [0.02, 0.04]\n\
         [air]\nmass_kg = 1.2\ndrag_per_s = [0.3, 0.3]\nmoment_n_m_per_m_s = [1e-3, 1e-3]\n\
         [limits]\nbody_rates_rad_s = [10.0, 10.0, 5.0]\n"
    ))
    .unwrap()
}

fn scenario(vehicle: Vehicle, text: &str) -> Scenario {
    let file = ScenarioFile::parse(&format!("vehicle = \"\"\nair = \"vehicle\"\n{text}"), "test").unwrap();
    Scenario::on(vehicle, &file, "test", Path::new("")).unwrap()
}

fn flown(scenario: &Scenario, law: Law) -> RigidFlight {
    let mut law = law.start(&scenario.vehicle, &scenario.told).unwrap();
    scenario.fly(law.as_mut(), &scenario.flown(None)).unwrap()
}

fn refused(vehicle: &Vehicle, told: &ToldFigures, law: Law) -> LawError {
    law.start(vehicle, told).err().expect("refused")
}

fn untold(vehicle: &Vehicle) -> ToldFigures {
    ToldFigures { mass_kg: vehicle.mass_kg(), lag_s: None, drag_per_s: None, moment_n_m_per_m_s: None }
}

#[test]
fn a_craft_of_ones_own_is_flown_by_the_table_that_is_certified_for_it() {
    let vehicle = own("five-inch", 0.03);
    let table = standard_cascade(&vehicle).unwrap().table;
    let law = CascadeLaw::new(&vehicle, &untold(&vehicle)).unwrap();
    let same = CascadeLaw::of_table(&vehicle, &untold(&vehicle), &table).unwrap();
    assert_eq!(format!("{:?}", law.cascade), format!("{:?}", same.cascade));
    // 80 % of the file's air.
    assert!(
        (table.air.drag_per_s - 0.24).abs() < 1e-6 && (table.air.moment_n_s[0] - 8e-4).abs() < 1e-9,
        "{:?}",
        table.air
    );

    for text in ["", "[errors]\nmass_factor = 1.1", "[errors]\ninertia_factor = 1.2"] {
        let scenario = scenario(vehicle.clone(), text);
        assert!(!knows(&scenario.vehicle));
        let [quatrack, object] = [Law::Quatrack, Law::Crazyflie].map(|law| flown(&scenario, law).iae_m_s().unwrap());
        // One table, in the object with commands of 16 bits and its own steps between setpoints: both within 5 mm m s, as on the
        // built-in craft.
        assert!((quatrack - object).abs() < 0.005, "{text}: {quatrack} {object}");
    }
}

#[test]
fn a_craft_is_known_by_its_figures_and_not_by_its_name() {
    let flight = |name: &str| {
        let samples = flown(&scenario(own(name, 0.03), "duration_s = 1.0"), Law::Quatrack).samples;
        samples.into_iter().map(|sample| sample.state).collect::<Vec<_>>()
    };
    let [as_brushless, as_own] = ["crazyflie-2.1-brushless-own", "mine"].map(flight);
    assert_eq!(as_brushless, as_own);
    // A built-in name on other figures.
    assert!(!vehicles::is_built_in(&own("crazyflie-2.1", 0.03)));
    assert!(vehicles::names().iter().all(|name| vehicles::is_built_in(&vehicles::by_name(name).unwrap())));
}

#[test]
fn a_craft_without_a_certificate_is_refused_by_both_laws_in_the_same_words() {
    let slow = own("slow", 0.5);
    let said = [Law::Quatrack, Law::Crazyflie].map(|law| refused(&slow, &untold(&slow), law).to_string());
    assert!(
        said[0].starts_with("quatrack on slow: the standard cascade has no certificate for it: refused: "),
        "{}",
        said[0]
    );
    assert!(said[0].contains("--gains") && !said[0].contains('\n'), "{}", said[0]);
    assert_eq!(said[0].replacen("quatrack", "crazyflie", 1), said[1]);
}

#[test]
fn what_the_table_is_not_certified_for_is_refused_with_its_range() {
    let vehicle = own("five-inch", 0.03);
    for law in [Law::Quatrack, Law::Crazyflie] {
        let late = ToldFigures { lag_s: Some(0.3), ..untold(&vehicle) };
        let said = refused(&vehicle, &late, law).to_string();
        assert!(said.contains("told.lag_ms = 300: must be from 11.85 to 30 ms"), "{said}");
        let heavy = ToldFigures { mass_kg: 1.5, ..untold(&vehicle) };
        let said = refused(&vehicle, &heavy, law).to_string();
        assert!(said.contains("told.mass_kg = 1.5: must be") && said.contains("1.2"), "{said}");
    }
}

#[test]
fn the_object_says_which_lag_it_does_not_take() {
    // The shortest and the longest that a scenario takes are flown, also after one that was refused.
    let vehicle = vehicles::by_name("crazyflie-2.1").unwrap();
    for (told_s, is_flown) in [(0.3, false), (0.126, true), (0.3, false), (0.004, true), (0.003, false), (0.067, true)]
    {
        let told = ToldFigures { lag_s: Some(told_s), ..untold(&vehicle) };
        assert_eq!(Law::Crazyflie.start(&vehicle, &told).is_ok(), is_flown, "{told_s}");
    }
}
