//! A craft identified from real flights, where they are; and faulty inputs, each named.

use std::path::PathBuf;

use quatrack_design::vehicle::VehicleFile;

use super::*;
use crate::predict::HORIZON;

/// Where real flights are looked for, from the root of the checkout and upwards.
const FOLDER: &str = "shared/flights/nanobench";

fn crazyflie() -> Vehicle {
    let file: VehicleFile = toml::from_str(include_str!("../../../../gains/vehicles/crazyflie-2.1.toml")).unwrap();
    Vehicle::try_from(file).unwrap()
}

fn real_flights() -> Vec<PathBuf> {
    let above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    let Some(folder) = above.map(|above| above.join(FOLDER)).find(|path| path.is_dir()) else {
        println!("SKIPPED: no flights in a folder {FOLDER} beside or above the checkout");
        return Vec::new();
    };
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "gz"));
    paths.sort();
    paths
}

/// NanoBench (arXiv 2603.09908): the figures are those of an independent identification of 33 flights of the same craft.
#[test]
fn the_figures_of_a_real_craft_are_found_in_its_flights() {
    let paths = real_flights();
    if paths.is_empty() {
        return;
    }
    let map = ColumnMap::built_in("nanobench").unwrap();
    let report = identify(&paths, &map, &crazyflie(), 0.027).unwrap();
    for (name, value, share) in [
        ("lag_ms", 67.0, 8.0 / 67.0),
        ("drag_x_per_s", 0.39, 0.08),
        ("drag_y_per_s", 0.40, 0.08),
        ("moment_x_n_m_per_m_s", 3.8e-4, 0.10),
        ("moment_y_n_m_per_m_s", 4.3e-4, 0.10),
        ("inertia_x_kg_m2", 1.6e-5, 0.15),
        ("inertia_y_kg_m2", 1.75e-5, 0.15),
        ("thrust_full_n", 0.124, 0.05),
    ] {
        match &report.fit.figures[name] {
            Ok(found) => assert!((found.value / value - 1.0).abs() < share, "{name}: {found:?}"),
            // Smooth flights may not tell an inertia.
            Err(why) => assert!(name.starts_with("inertia"), "{name}: {why}"),
        }
    }
    let prediction = report.prediction.unwrap();
    let (ours, still) = (prediction.ours[HORIZON - 1], prediction.no_angular_acceleration[HORIZON - 1]);
    assert!(ours.position_m < still.position_m && ours.body_rate_rad_s < still.body_rate_rad_s, "{ours:?} {still:?}");
    assert!(ours.velocity_m_s < 1.1 * still.velocity_m_s && ours.rotation_rad < 1.1 * still.rotation_rad);
}

#[test]
fn a_mass_in_grams_is_refused() {
    let map = ColumnMap::built_in("nanobench").unwrap();
    let error = identify(&["none.csv"], &map, &crazyflie(), 270.0).unwrap_err();
    assert_eq!(error.to_string(), "mass = 270: must be kilograms, from 0.001 to 100: 27 g are 0.027");
}
