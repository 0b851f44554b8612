//! Designs as somebody writes them: carried out, refused, exported.

use std::fs;
use std::path::Path;

use super::{GAINS, assert_done, assert_refused, design, folder, quatrack, stdout};

#[test]
fn a_design_below_its_own_minimum_is_refused_and_nothing_is_written() {
    let dir = folder("minimum");
    let toml = design(&dir, "bold.toml", "lyap-f.toml", "phase_all_deg = 40.0", "phase_all_deg = 60.0");
    let output = quatrack(&["gains", "design", &toml]);
    // (LYAP-F) at 500 Hz has 59.867 degrees.
    let named = ["bold.toml: refused: phase margin of all channels at once is 59.867", "at least 60 deg"];
    assert_refused(&output, 1, &named);
    assert!(output.stdout.is_empty() && !dir.join("generated").exists());
    let slow = design(&dir, "slow.toml", "lqr-e.toml", "control_rate_hz = 500", "control_rate_hz = 20");
    assert_refused(&quatrack(&["gains", "design", &slow]), 1, &["slow.toml: the loop is unstable at 20 Hz"]);
}

#[test]
fn a_design_of_another_craft_that_is_refused_is_told_that_weights_do_not_scale() {
    let dir = folder("heavy");
    let vehicle = "name = \"heavy\"\n[body]\nmass_kg = 1.2\n\
        inertia_kg_m2 = [[8.0e-3, 0.0, 0.0], [0.0, 8.0e-3, 0.0], [0.0, 0.0, 1.4e-2]]\n[motors]\narm_m = 0.16\nthrust_min_n = 0.1\n\
        thrust_max_n = 8.0\ntorque_per_thrust_m = 0.014\nlag_s = 0.03\npublished_lag_s = [0.02, 0.04]\n\
        [limits]\nbody_rates_rad_s = [10.0, 10.0, 5.0]\n";
    fs::write(dir.join("heavy.toml"), vehicle).unwrap();
    let design = "vehicle = \"heavy.toml\"\nlinearisation = \"equilibrium\"\nmethod = \"cascade\"\ncontrol_rate_hz = 500\n\
        motor_lag_ms = 30.0\n[region]\nmotor_lag_ms = [20.0, 40.0]\nmass_percent = 20.0\ninertia_percent = 30.0\n\
        force_percent = [70.0, 105.0]\ndelay_ms = 10.0\n[minimum]\ngain_factor_all = 1.8\n";
    let path = dir.join("design.toml");
    fs::write(&path, design).unwrap();
    let path = path.to_str().unwrap();
    // 1e4 (0.034 / 1.2)^2
    let named = ["refused: gain margin", "do not scale with the mass, 1.2 kg", "force_input = 8.03 for this mass"];
    assert_refused(&quatrack(&["gains", "design", path]), 1, &named);
    fs::write(path, design.replace("[region]", "[weights]\nforce_input = 8.03\n[region]")).unwrap();
    let designed = quatrack(&["gains", "design", path]);
    assert!(designed.status.success(), "{}", String::from_utf8_lossy(&designed.stderr));
    assert!(String::from_utf8(designed.stdout).unwrap().contains("force_input = 8.03 for this mass"));
    // Of a lag that is told the table's region counts, 20 to 40 ms, not the 11.85 to 30 ms of the table that `gains craft` makes.
    let told = |lag_ms: &str| {
        let hover = ["fly", "--gains", path, "--course", "hover", "--duration-s", "0.3"];
        quatrack(&[&hover[..], &["--told-lag-ms", lag_ms]].concat())
    };
    assert_done(&told("35"));
    for lag_ms in ["19", "45", "-1"] {
        let named = format!("told.lag_ms = {lag_ms}: must be from 20 to 40 ms, for which its table is certified");
        assert_refused(&told(lag_ms), 2, &[&named]);
    }
}

#[test]
fn a_design_without_an_answer_names_the_states_to_blame() {
    let dir = folder("unsolved");
    for (name, of, from, to, named) in [
        (
            "blind.toml",
            "sampled-lqr-e.toml",
            "position = [",
            "position = [0.0, 0.0, 0.0] # ",
            &["unseen is x (row 1 of Q, 0e0), y (row 2 of Q, 0e0), z (row 3 of Q, 0e0)", "give it a weight"][..],
        ),
        (
            "blind-cascade.toml",
            "cascade-100ms.toml",
            "[region]",
            "[weights]\nposition = [2000.0, 0.0, 4000.0]\n[region]",
            &["unseen is y (row 2 of Q, 0e0)"],
        ),
    ] {
        let refused = quatrack(&["gains", "design", &design(&dir, name, of, from, to)]);
        assert_refused(&refused, 2, named);
        let line = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(!line.contains("residual") && !line.contains("NaN"), "{line}");
    }
}

#[test]
fn the_actuator_aware_law_has_gains_and_a_certificate_and_no_table() {
    let old = format!("{}/../../tests/data/actuator-aware.bin", env!("CARGO_MANIFEST_DIR"));
    let words = ["actuator-aware law", "method = \"cascade\""];
    assert_refused(&quatrack(&["gains", "show", &old]), 2, &words);
    assert_refused(&quatrack(&["fly", "--gains", &old, "--trajectory", "mild"]), 2, &words);
    let design = format!("{GAINS}/actuator-aware.toml");
    assert_refused(&quatrack(&["fly", "--gains", &design, "--trajectory", "mild"]), 2, &words);
    let out = folder("actuator-aware");
    let output = quatrack(&["gains", "design", &design, "--out", out.to_str().unwrap()]);
    assert_done(&output);
    assert!(words.iter().all(|words| stdout(&output).contains(words)), "{}", stdout(&output));
    assert!(out.join("actuator-aware.json").is_file() && !out.join("actuator-aware.bin").exists());
}

#[test]
fn the_page_on_own_designs_prints_the_commands_output() {
    let page = fs::read_to_string(Path::new(GAINS).join("../docs/own-gains.md")).unwrap();
    let block = |after: &str, fence: &str| {
        let from = page.find(after).unwrap();
        let start = from + page[from..].find(fence).unwrap() + fence.len();
        page[start..start + page[start..].find("```").unwrap()].to_owned()
    };
    let toml = block("## 1.", "```toml\n");
    let dir = folder("page");
    let path = dir.join("my-craft.toml");
    fs::write(&path, &toml).unwrap();
    let printed = stdout(&quatrack(&["gains", "design", path.to_str().unwrap()]));
    let shown = block("## 2.", "```text\n");
    let figures: Vec<&str> = shown.lines().filter(|line| line.starts_with("  ")).collect();
    // Four figures of the certificate, and how the weights are taken.
    assert_eq!(figures.len(), 5);
    for line in figures {
        assert!(printed.contains(line), "{line} is not in\n{printed}");
    }
    fs::write(&path, toml.replace("phase_all_deg = 32.0", "phase_all_deg = 60.0")).unwrap();
    let refused = block("Had it asked", "```text\nquatrack: gains/my-craft.toml: ");
    assert_refused(&quatrack(&["gains", "design", path.to_str().unwrap()]), 1, &[refused.trim()]);
}

#[test]
fn a_vehicle_beside_its_designs_is_none_of_them() {
    let dir = folder("beside");
    let there = dir.to_str().unwrap();
    fs::copy(format!("{GAINS}/vehicles/crazyflie-2.1-legacy.toml"), dir.join("my-craft.toml")).unwrap();
    let named = "vehicle = \"my-craft.toml\"";
    let design = design(&dir, "mine.toml", "lyap-f.toml", "vehicle = \"crazyflie-2.1\"", named);
    assert_done(&quatrack(&["gains", "design", &design]));
    let listed = stdout(&quatrack(&["gains", "list", there]));
    assert!(listed.starts_with("mine ") && listed.lines().count() == 1, "{listed}");
    // JSON, Rust and the binary table of the one design.
    assert_eq!(stdout(&quatrack(&["gains", "check", there])), "3 files agree with their designs\n");
    assert_eq!(stdout(&quatrack(&["gains", "generate", there])), "3 files agreed with their designs\n");
    // Neither a design nor a vehicle.
    fs::write(dir.join("other.toml"), "name = \"other\"\n[body]\nmass_kg = 1.0\n").unwrap();
    for command in ["list", "check", "generate"] {
        assert_refused(&quatrack(&["gains", command, there]), 2, &["other.toml: line 2, `[body]`"]);
    }
}

#[test]
fn a_vehicle_file_becomes_a_header_for_the_crazyflie_and_flies() {
    let dir = folder("craft");
    let vehicle = format!("{GAINS}/vehicles/crazyflie-2.1-legacy.toml");
    let header = dir.join("quatrack_craft.h");
    let printed = stdout(&quatrack(&["gains", "craft", &vehicle, "--out", header.to_str().unwrap()]));
    assert!(printed.starts_with("crazyflie-2.1-legacy: 0.029 kg, motors of 126 ms, certified for "), "{printed}");
    let text = fs::read_to_string(&header).unwrap();
    assert!(text.contains("static const quatrackCraft_t ownCraft = {\n  .massKg = "), "{text}");
    // A design for it does as well; one that the object does not fly writes nothing.
    let design = design(&dir, "of-legacy.toml", "cascade-100ms.toml", "\"crazyflie-2.1\"", &format!("\"{vehicle}\""));
    assert_done(&quatrack(&["gains", "craft", &design, "--out", header.to_str().unwrap()]));
    let other = dir.join("none.h");
    let refused = quatrack(&["gains", "craft", &format!("{GAINS}/lqr-e.toml"), "--out", other.to_str().unwrap()]);
    assert_refused(&refused, 2, &["lqr is no law that the Crazyflie object flies", "method = \"cascade\""]);
    assert!(!other.exists());
    // The same to be sent: its magic, 15 figures, the table, a checksum.
    let file = dir.join("legacy.bin");
    assert_done(&quatrack(&["gains", "craft", &vehicle, "--out", file.to_str().unwrap()]));
    let bytes = fs::read(&file).unwrap();
    assert_eq!((bytes.len(), &bytes[..6]), (6 + 60 + 326 + 4, &b"QTCR\x01\0"[..]));
    assert_eq!(bytes[6..10], 0.029_f32.to_le_bytes());
    let shown = stdout(&quatrack(&["gains", "show", file.to_str().unwrap()]));
    assert!(
        shown.starts_with("a craft of 0.029 kg, motors of 126 ms, with its table; `upload.py craft` sends it\n"),
        "{shown}"
    );
    assert!(shown.contains("crazyflie-2.1-legacy"), "{shown}");
    // Its own name is at fault, not that of its file.
    let long = dir.join("long.toml");
    let text = fs::read_to_string(&vehicle).unwrap();
    fs::write(&long, text.replace("\"crazyflie-2.1-legacy\"", "\"a-name-of-32-characters-in-total\"")).unwrap();
    let refused = quatrack(&["gains", "craft", long.to_str().unwrap(), "--out", other.to_str().unwrap()]);
    assert_refused(&refused, 2, &["long.toml: the vehicle's name is the table's name: name: 32 bytes; give 1 to 31"]);
    let mut damaged = bytes.clone();
    damaged[8] ^= 1;
    let broken = dir.join("damaged.bin");
    fs::write(&broken, damaged).unwrap();
    let refused = quatrack(&["gains", "show", broken.to_str().unwrap()]);
    assert_refused(&refused, 2, &["a craft that is damaged; make it again with `quatrack gains craft`"]);
    // The one that upload.py is tried with.
    assert_eq!(bytes, include_bytes!("../../../../../tests/data/legacy-craft.bin"));
    let flown = quatrack(&["crazyflie", "--vehicle", &vehicle]);
    assert_done(&flown);
}

#[test]
fn exports_name_every_row_and_column() {
    let csv = stdout(&quatrack(&["export", "--format", "csv", "--design", "LQR-E"]));
    assert_eq!(csv.lines().next(), Some("matrix,row,column,value,row_name,row_unit,column_name,column_unit"));
    assert!(csv.contains("\nA,6,4,19.62,vx,m/s,q2,1\n") && csv.contains("\nB,3,1,0.5,q1,1,p,rad/s\n"), "{csv}");
    let json = stdout(&quatrack(&["export", "--format", "json", "--design", &format!("{GAINS}/sampled-lqr-f.toml")]));
    let export: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(export["period_s"], 0.002);
    assert_eq!(export["matrices"]["K"]["rows"][3], serde_json::json!({ "name": "jx", "unit": "m/s^3" }));
    assert_refused(&quatrack(&["export", "--format", "json", "--design", "pid"]), 2, &["pid", "lqr-e"]);
    assert_refused(&quatrack(&["export", "--design", "lqr-e"]), 2, &["--format"]);
}
