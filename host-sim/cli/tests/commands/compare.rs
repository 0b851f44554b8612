//! `quatrack compare` as its user meets it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn compare(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_quatrack")).arg("compare").args(arguments).output().expect("the command starts")
}

fn scenario(name: &str, text: &str) -> (PathBuf, String) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join("scenario.toml");
    fs::write(&path, text).unwrap();
    (folder, path.to_str().unwrap().to_owned())
}

#[test]
fn laws_fly_and_their_table_and_picture_are_written() {
    let text =
        "vehicle = \"crazyflie-2.1-brushless\"\ncourse = \"step\"\nstep_m = 0.2\nduration_s = 1.0\nair = \"vehicle\"\n";
    let (folder, path) = scenario("compare-flies", text);
    let [json, picture] = ["table.json", "step.svg"].map(|name| folder.join(name).to_str().unwrap().to_owned());
    let flown = compare(&["--scenario", &path, "--laws", "lee,quatrack", "--json", &json, "--picture", &picture]);
    let printed = String::from_utf8(flown.stdout).unwrap();
    assert!(flown.status.success() && printed.contains("step of 0.2 m") && printed.contains("drag"), "{printed}");
    let table: serde_json::Value = serde_json::from_str(&fs::read_to_string(json).unwrap()).unwrap();
    assert_eq!(table["schema"], "quatrack/compare/1");
    let names: Vec<_> = table["rows"].as_array().unwrap().iter().map(|row| row["law"].as_str().unwrap()).collect();
    assert_eq!(names, ["lee", "quatrack"]);
    for row in table["rows"].as_array().unwrap() {
        // The error starts at 0.2 m and is gone within a second: between nothing and all of it.
        let iae = row["iae_m_s"].as_f64().unwrap();
        assert!((0.02..0.2).contains(&iae) && row["lost"] == false, "{row}");
        assert!((row["max_error_m"].as_f64().unwrap() - 0.2).abs() < 0.01, "{row}");
    }
    let svg = fs::read_to_string(picture).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains(">lee</text>") && svg.contains(">quatrack</text>"));
}

#[test]
fn robustness_has_its_error_under_the_same_key() {
    let mut command = Command::new(env!("CARGO_BIN_EXE_quatrack"));
    let flown = command.args(["robustness", "--json", "-"]).output().expect("the command starts");
    let table: serde_json::Value = serde_json::from_slice(&flown.stdout).unwrap();
    assert_eq!(table["schema"], "quatrack/robustness/2");
    for rows in [&table["rows"], &table["in_air"]["rows"]] {
        // The first case is the nominal one, of a law that is not lost.
        let first = &rows.as_array().unwrap()[0];
        assert!(first["iae_m_s"].is_f64() && first["iae"].is_null(), "{first}");
    }
}

/// Lines of a message; the parser of arguments lists missing ones below it, and a way to help.
fn message(said: &str) -> usize {
    let lines = said.split("\n\n").next().unwrap_or_default().lines();
    lines.filter(|line| !line.starts_with("  --")).count()
}

#[test]
fn inputs_that_cannot_be_flown_are_refused_in_one_line() {
    let (folder, path) = scenario("compare-refuses", "vehicle = \"crazyflie-2.1\"\n[told]\nmass_kg = 29.0\n");
    let missing = folder.join("missing.toml").to_str().unwrap().to_owned();
    let (_, unknown) = scenario("compare-unknown", "vehicle = \"crazyflie-2.1\"\nspeed = 2.1\n");
    let (_, nowhere) = scenario("compare-nowhere", "vehicle = \"crazyflie-2.1\"\ncourse = \"nowhere.csv\"\n");
    for (arguments, named) in [
        (vec!["--scenario", path.as_str()], &["scenario.toml: told.mass_kg = 29: must be from 0.0145 to 0.058"][..]),
        (vec!["--scenario", &unknown], &["scenario.toml, line 2, `speed = 2.1`: unknown field `speed`"]),
        (vec!["--scenario", &missing], &["missing.toml", "cannot be read"]),
        (vec!["--scenario", &nowhere], &["nowhere.csv"]),
        (vec!["--scenario", &path, "--laws", "mpc"], &["mpc", "quatrack, mellinger"]),
        (vec![], &["--scenario"]),
    ] {
        let refused = compare(&arguments);
        let said = String::from_utf8(refused.stderr).unwrap();
        assert_eq!((refused.status.code(), message(&said)), (Some(2), 1), "{arguments:?}: {said}");
        assert!(refused.stdout.is_empty() && named.iter().all(|name| said.contains(name)), "{arguments:?}: {said}");
    }
}
