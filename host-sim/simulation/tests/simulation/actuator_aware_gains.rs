//! The actuator-aware method of the gain tool: the committed designs, their gains, and the refusals.

use std::path::{Path, PathBuf};

use quatrack_design::certify::Region;
use quatrack_design::design::actuator_aware::ActuatorAwareWeights;
use quatrack_simulation::flight::motor_laws::{AwareTable, default_lag_s};
use quatrack_simulation::gains::{Design, Export, GainsError, Problem, artifacts};
use quatrack_simulation::vehicles;

const TEXT: &str = include_str!("../../../../gains/actuator-aware.toml");

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../gains")
}

#[test]
fn committed_gains_are_those_that_the_flights_are_flown_with() {
    for (design, vehicle) in [
        ("actuator-aware", "crazyflie-2.1"),
        ("actuator-aware-kit", "crazyflie-2.1-upgrade-kit"),
        ("actuator-aware-brushless", "crazyflie-2.1-brushless"),
    ] {
        let vehicle = vehicles::by_name(vehicle).expect("built in");
        let text = std::fs::read_to_string(folder().join(format!("generated/{design}.json"))).expect("committed");
        let document: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let entries: Vec<f32> = (document["gain"]["k"].as_array().expect("rows").iter())
            .flat_map(|row| {
                row.as_array().expect("entries").iter().map(|entry| entry.as_f64().expect("a number") as f32)
            })
            .collect();
        let weights = &ActuatorAwareWeights::STANDARD;
        let flown = AwareTable::new(&vehicle, default_lag_s(&vehicle), weights, &Region::of_any_crazyflie());
        assert_eq!(entries, flown.expect("designed").gain().gain().rows().as_flattened(), "{design}");
    }
}

#[test]
fn the_exported_problem_and_gain_solve_the_riccati_equation() {
    let design = Design::from_toml("aware", TEXT, Path::new("")).expect("valid");
    let export = Export::of(&design).expect("designed");
    let matrix = |name: &str| {
        &export.matrices.iter().find(|matrix| matrix.name == name).unwrap_or_else(|| panic!("no {name}")).entries
    };
    let (a, b, q, r, k, p) = (matrix("A_d"), matrix("B_d"), matrix("Q_d"), matrix("R_d"), matrix("K"), matrix("P"));
    let s = r + b.transpose() * p * b;
    let expected = s.clone().lu().solve(&(b.transpose() * p * a)).expect("regular");
    // The condition of the 4 x 4 system, below 1e3, times rounding of sums of P, up to 1e5 times its smallest entries.
    assert!((k - &expected).norm() < 1e-9 * k.norm(), "{}", (k - &expected).norm() / k.norm());
    let residual = a.transpose() * p * a - p + q - a.transpose() * p * b * &expected;
    assert!(residual.norm() < 1e-11 * p.norm(), "{}", residual.norm() / p.norm());
    // Commands reach the motors, the sums the position.
    let (continuous, input) = (matrix("A"), matrix("B"));
    assert_eq!((input[(12, 0)], input[(13, 0)], continuous[(16, 0)]), (1.0 / 0.126, 0.0, 1.0));
}

#[test]
fn refusals_name_the_key() {
    let refused = |from: &str, to: &str| {
        assert!(TEXT.contains(from), "{from}");
        let read = Design::from_toml("aware", &TEXT.replace(from, to), Path::new(""));
        read.and_then(|design| design.certify().map(|_| ())).expect_err("refused")
    };
    let told = |from: &str, to: &str| refused(from, to).to_string();
    assert!(told("\nmotor_lag_ms = 126.0\n\n", "\n\n").starts_with("motor_lag_ms is missing"));
    assert!(
        told("motor_lag_ms = [50.0, 126.0]", "motor_lag_ms = [126.0, 50.0]").starts_with("region.motor_lag_ms = 50")
    );
    assert!(told("force_input = 1e4", "force_input = 0.0").starts_with("weights.force_input = 0"));
    assert!(told("rotation =", "attitude =").starts_with("weights.attitude"));
    assert!(told("mass_percent = 20.0", "mass_percent = 120.0").starts_with("region.mass_percent = 120"));
    // A region that no gain of these weights holds in is an answer, not a wrong file.
    let wide = refused("motor_lag_ms = [50.0, 126.0]", "motor_lag_ms = [50.0, 400.0]");
    assert!(matches!(wide, GainsError::Region { spectral_radius, .. } if spectral_radius > 1.0), "{wide}");
    assert!(wide.is_verdict());
    let lqr = include_str!("../../../../gains/lqr-e.toml")
        .replace("control_rate_hz", "motor_lag_ms = 126.0\ncontrol_rate_hz");
    let misplaced = Design::from_toml("lqr", &lqr, Path::new("")).expect_err("refused").to_string();
    assert!(misplaced.starts_with("motor_lag_ms"), "{misplaced}");
}

#[test]
fn no_table_is_made_and_it_is_said_why() {
    let certified =
        Design::from_toml("aware", TEXT, Path::new("")).and_then(|design| design.certify()).expect("certified");
    assert_eq!((certified.to_bytes(), artifacts(&certified, Path::new("")).len()), (None, 1));
    assert!(certified.why_no_table().contains("method = \"cascade\""));
}

#[test]
fn a_design_carries_its_lag_weights_and_region() {
    let design = Design::from_toml("aware", TEXT, Path::new("")).expect("valid");
    let Problem::ActuatorAware { motor_lag_s, weights, .. } = &design.problem else { panic!("{:?}", design.problem) };
    assert_eq!((*motor_lag_s, *weights), (0.126, ActuatorAwareWeights::STANDARD));
}
