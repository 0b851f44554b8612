//! The committed tables: Rust and binary hold the same gains, the board accepts them, and their stated figures are those
//! of the certificate, rounded to the safe side.

use quatrack::gains::paper;
use quatrack::gains::table::{GainTable, Name, Rows, TableKind, Vehicle};
use quatrack::law::{EquilibriumGain, FlatOutputGain};
use quatrack::{Limits, Rate};
use quatrack_simulation::vehicles;
use serde_json::Value;

macro_rules! generated {
    ($($module:ident $name:literal)*) => {
        $(#[allow(unreachable_pub)] mod $module { include!(concat!("../../../../gains/generated/", $name, ".rs")); })*

        /// Name, binary table and document.
        const FILES: &[(&str, &[u8], &str)] = &[$((
            $name,
            include_bytes!(concat!("../../../../gains/generated/", $name, ".bin")),
            include_str!(concat!("../../../../gains/generated/", $name, ".json")),
        )),*];
    };
}

generated! {
    lyap_e "lyap-e"
    lyap_f "lyap-f"
    lqr_e "lqr-e"
    lqr_f "lqr-f"
    lqi_e "lqi-e"
    sampled_lqr_e "sampled-lqr-e"
    sampled_lqr_e_100hz "sampled-lqr-e-100hz"
    sampled_lqr_f "sampled-lqr-f"
}

fn file(name: &str) -> (GainTable<'static>, Value) {
    let (_, bytes, document) = FILES.iter().find(|(known, ..)| *known == name).unwrap();
    (GainTable::from_bytes(bytes).unwrap(), serde_json::from_str(document).unwrap())
}

fn is_equilibrium(name: &str, gain: &EquilibriumGain) {
    assert_eq!(file(name).0.rows(), Some(Rows::Equilibrium(*gain.gain().rows())), "{name}");
}

fn is_flat_output(name: &str, gain: &FlatOutputGain) {
    assert_eq!(file(name).0.rows(), Some(Rows::FlatOutput(*gain.gain().rows())), "{name}");
}

#[test]
fn rust_and_binary_tables_hold_the_same_gains_and_the_papers_are_those_of_the_image() {
    is_equilibrium("lyap-e", &lyap_e::LYAP_E);
    is_equilibrium("lqr-e", &lqr_e::LQR_E);
    is_equilibrium("sampled-lqr-e", &sampled_lqr_e::SAMPLED_LQR_E);
    is_equilibrium("sampled-lqr-e-100hz", &sampled_lqr_e_100hz::SAMPLED_LQR_E_100HZ);
    assert_eq!(file("lqi-e").0.rows(), Some(Rows::Integral(lqi_e::LQI_E.rows())));
    is_flat_output("lyap-f", &lyap_f::LYAP_F);
    is_flat_output("lqr-f", &lqr_f::LQR_F);
    is_flat_output("sampled-lqr-f", &sampled_lqr_f::SAMPLED_LQR_F);
    is_equilibrium("lyap-e", &paper::LYAP_E);
    is_equilibrium("lqr-e", &paper::LQR_E);
    is_flat_output("lyap-f", &paper::LYAP_F);
    is_flat_output("lqr-f", &paper::LQR_F);
}

#[test]
fn the_board_accepts_every_table_for_its_vehicle_and_rate_alone() {
    let described = vehicles::by_name("crazyflie-2.1").unwrap();
    let vehicle = Vehicle { name: Name::new(described.name()).unwrap(), id: vehicles::id(&described) };
    for (name, bytes, _) in FILES {
        let rate = Rate::from_hz(if name.ends_with("100hz") { 100 } else { 500 }).unwrap();
        let read = GainTable::from_bytes(bytes).unwrap();
        let table = read.accept_for(&vehicle, rate).unwrap();
        assert_eq!(table.head().name.as_str(), *name);
        let kind = match *name {
            "lqi-e" => TableKind::Integral,
            name if name.ends_with("-f") => TableKind::FlatOutput,
            _ => TableKind::Equilibrium,
        };
        assert_eq!(table.kind(), kind, "{name}");
        let limits: Limits = vehicles::limits(&described).unwrap();
        assert_eq!(table.limits(), limits, "{name}");
        assert!(read.accept_for(&vehicle, Rate::from_hz(250).unwrap()).is_err());
        assert!(read.accept_for(&Vehicle { id: vehicle.id ^ 1, ..vehicle }, rate).is_err());
    }
}

#[test]
fn a_tables_figures_are_just_below_the_computed_ones() {
    for (name, ..) in FILES {
        let (table, document) = file(name);
        let stated = table.head().certificate;
        let certificate = &document["certificate"];
        let least = |list: &Value, of: &dyn Fn(&Value) -> f64| -> f64 {
            list.as_array().unwrap().iter().map(of).fold(f64::INFINITY, f64::min)
        };
        let margins = &certificate["sampled"]["margins"];
        let each =
            |key: &'static str| least(&margins["each"], &move |channel| channel["balanced"][key].as_f64().unwrap());
        let limit = |key: &str| least(&certificate[key], &|limit| limit["stable_to_s"].as_f64().unwrap());
        let in_rate_loop =
            if certificate["motors_in_rate_loop"].is_null() { f64::INFINITY } else { limit("motors_in_rate_loop") };
        let all = &margins["all"]["balanced"];
        for (figure, stated, found) in [
            ("gain of one", stated.one_channel.gain_factor, each("gain_max")),
            ("phase of one", stated.one_channel.phase_rad, each("phase_rad")),
            ("gain of all", stated.all_channels.gain_factor, all["gain_max"].as_f64().unwrap()),
            ("phase of all", stated.all_channels.phase_rad, all["phase_rad"].as_f64().unwrap()),
            ("delay", stated.delay_max_s, limit("delay")),
            ("lag", stated.motor_lag_max_s, limit("lag").min(in_rate_loop)),
        ] {
            let share = f64::from(stated) / found;
            // Rounded down to four digits: by less than a thousandth. The document's six digits may be rounded either way.
            assert!((0.999..1.0 + 5e-6).contains(&share), "{name}, {figure}: {stated} of {found}");
        }
        let rounding = certificate["rounding"]["largest_absolute"].as_f64().unwrap();
        let entries = document["gain"]["k"].as_array().unwrap().iter().flat_map(|row| row.as_array().unwrap());
        let largest = entries.map(|k| k.as_f64().unwrap().abs()).fold(0.0, f64::max);
        let distance = f64::from(stated.f32_distance) - rounding / largest;
        assert!((-1e-13..2e-10).contains(&distance), "{name}: rounded up to 1e-10");
        assert_eq!(document["certificate_sha256"], stated.hash.to_string());
        assert_eq!(document["design_sha256"], table.head().design_hash.to_string());
        assert_eq!(document["statement"]["design_sha256"], document["design_sha256"]);
    }
}
