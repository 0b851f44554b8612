//! `quatrack fly` along courses of one's own: the checks before they are flown, and the refusals.

use std::fs;
use std::path::Path;

use super::fly_scenario::{message, quatrack, scenario};

/// Two pieces of 1 s along x, by their coefficients.
fn pieces(folder: &Path, name: &str, [a, b]: [[f64; 3]; 2]) -> String {
    let axis = |c: &str| (0..8).map(|power| format!("{c}^{power}")).collect::<Vec<_>>().join(",");
    let row = |[p, v, half_a]: [f64; 3]| format!("1.0,{p},{v},{half_a}{}\n", ",0".repeat(29));
    let header = format!("duration,{},{},{},{}\n", axis("x"), axis("y"), axis("z"), axis("yaw"));
    let path = folder.join(name);
    fs::write(&path, format!("{header}{}{}", row(a), row(b))).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_course_of_ones_own_is_looked_at_before_it_is_flown() {
    let (folder, _) = scenario("fly-course", "");
    // 1 m/s from its start; 0.5 m/s more from 1 s on.
    let jumping = pieces(&folder, "jumping.csv", [[0.0, 1.0, 0.0], [1.0, 1.5, 0.0]]);
    let found =
        "note: the reference itself starts in motion, at 1.00 m/s, jumps by 0.500 m/s behind piece 1, at 1.00 s";
    let on_course = ["--vehicle", "crazyflie-2.1", "--course", &jumping];
    for command in [&["fly"][..], &["compare", "--laws", "quatrack"], &["robustness", "--law", "quatrack"]] {
        let flown = quatrack(&[command, &on_course].concat());
        let printed = String::from_utf8(flown.stdout).unwrap();
        assert!(flown.status.success() && printed.contains(found), "{command:?}: {printed}");
    }
    let flown = quatrack(&[&["fly", "--json", "-"], &on_course[..]].concat());
    let figures: serde_json::Value = serde_json::from_slice(&flown.stdout).unwrap();
    assert_eq!(format!("note: {}", figures["reference"].as_str().unwrap()), found);

    // 50 km away numbers of 32 bits are 1/256 m apart: 0.45 of that is lost of the start and of the way, and their sum is not.
    let far = pieces(&folder, "far.csv", [[50_000.001_758, 0.302_539, 0.0], [50_000.304_297, 0.302_539, 0.0]]);
    let refused = quatrack(&["fly", "--vehicle", "crazyflie-2.1", "--course", &far]);
    let said = String::from_utf8(refused.stderr).unwrap();
    assert!(
        refused.status.code() == Some(2) && said.contains("far.csv: x is 50000 m") && said.contains("--start 0,0,0"),
        "{said}"
    );
}

#[test]
fn a_craft_5_m_from_its_trajectory_is_lost() {
    let (folder, _) = scenario("fly-lost", "");
    let path = pieces(&folder, "rest.csv", [[0.0; 3]; 2]);
    // With a thrust of 8 m/s^2 at most it falls 3.6 m in these 2 s; with 2 m/s^2 5 m in sqrt(10 / 7.81) = 1.13 s.
    for (limits, lost) in [("0,8,20", None), ("0,2,20", Some("1.14 s: 5 m from the reference"))] {
        let arguments = ["fly", "--controller", "lqr-e", "--trajectory", &path, "--limits", limits, "--json", "-"];
        let flown = quatrack(&arguments);
        let figures: serde_json::Value = serde_json::from_slice(&flown.stdout).unwrap();
        let said = String::from_utf8(flown.stderr).unwrap();
        assert_eq!(flown.status.code(), Some(if lost.is_some() { 3 } else { 0 }), "{limits}: {said}");
        assert_eq!((figures["lost"].as_str(), figures["iae_m_s"].is_null()), (lost, lost.is_some()), "{figures}");
    }
    let help = String::from_utf8(quatrack(&["fly", "--help"]).stdout).unwrap();
    assert!(help.contains("lost 5 m from"), "{help}");
}

#[test]
fn a_course_that_ends_before_its_duration_is_said_to() {
    let (folder, _) = scenario("fly-ends", "");
    let path = pieces(&folder, "rest.csv", [[0.0; 3]; 2]);
    let flown = quatrack(&["fly", "--vehicle", "crazyflie-2.1", "--course", &path, "--duration-s", "60"]);
    let printed = String::from_utf8(flown.stdout).unwrap();
    assert!(printed.contains("note: the course ends after 2.00 s, before the 60 s that were asked for"), "{printed}");
}

#[test]
fn a_slip_in_the_name_of_a_course_is_named_with_its_file_and_the_courses() {
    let (folder, path) = scenario("fly-slip", "vehicle = \"crazyflie-2.1\"\ncourse = \"eigth\"\n");
    let out = folder.join("out").to_str().unwrap().to_owned();
    let campaign = ["campaign", &path, "--runs", "2", "--out", &out];
    for arguments in [&["fly", "--scenario", &path][..], &["compare", "--scenario", &path], &campaign] {
        let refused = quatrack(arguments);
        let said = String::from_utf8(refused.stderr).unwrap();
        let named =
            ["scenario.toml: course = \"eigth\"", "eight, hover, step, mild, aggressive", "did you mean eight?"];
        assert_eq!((refused.status.code(), message(&said)), (Some(2), 1), "{arguments:?}: {said}");
        assert!(named.iter().all(|name| said.contains(name)), "{arguments:?}: {said}");
    }
    let refused = quatrack(&["fly", "--vehicle", "crazyflie-2.1", "--course", "agressive"]);
    let said = String::from_utf8(refused.stderr).unwrap();
    assert!(said.contains("flags: course = \"agressive\"") && said.contains("did you mean aggressive?"), "{said}");
}

#[cfg(unix)]
#[test]
fn devices_without_an_end_are_refused_by_every_reader() {
    let folder = scenario("fly-endless", "").0;
    let link = |name: &str| {
        let path = folder.join(name);
        std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let [toml, table] = ["zero.toml", "zero.bin"].map(link);
    let out = folder.join("out").to_str().unwrap().to_owned();
    for arguments in [
        &["fly", "--scenario", "/dev/zero"][..],
        &["fly", "--vehicle", &toml],
        &["fly", "--gains", &table, "--vehicle", "crazyflie-2.1"],
        &["campaign", &toml, "--runs", "1", "--out", &out],
        &["gains", "design", &toml, "--out", &out],
        &["gains", "craft", &toml, "--out", &out],
        &["gains", "show", &table],
        &["identify", "/dev/null", "--columns", &toml],
        &["fly", "--vehicle", "crazyflie-2.1", "--course", "/dev/zero"],
    ] {
        let refused = quatrack(arguments);
        let said = String::from_utf8(refused.stderr).unwrap();
        assert_eq!((refused.status.code(), message(&said)), (Some(2), 1), "{arguments:?}: {said}");
        assert!(said.contains("longer than 64 MB, or a device without an end"), "{arguments:?}: {said}");
    }
}
