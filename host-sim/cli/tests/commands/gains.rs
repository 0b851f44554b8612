//! `quatrack gains` and the commands that fly and export its designs, as their user meets them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use quatrack::Trajectory;
use quatrack::gains::table::{GainTable, ScheduleRows, TABLE_BYTES_MAX};
use quatrack_plan::trajectory::file::{self, TrajectoryFile};
use quatrack_plan::trajectory::on_board;

const GAINS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../gains");

fn quatrack(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_quatrack")).args(arguments).output().expect("the command starts")
}

/// A folder of this test's own, emptied.
fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("gains").join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

/// A committed design under another name, with one text for another.
fn design(dir: &Path, name: &str, of: &str, from: &str, to: &str) -> String {
    let text = fs::read_to_string(Path::new(GAINS).join(of)).unwrap();
    assert!(text.contains(from), "nothing to edit: {from}");
    let path = dir.join(name);
    fs::write(&path, text.replacen(from, to, 1)).unwrap();
    path.to_str().unwrap().to_owned()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn assert_done(output: &Output) {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// The command refuses with this code and a line on standard error that names all of this.
fn assert_refused(output: &Output, exit_code: i32, named: &[&str]) {
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(exit_code), "{stderr}");
    for name in named {
        assert!(stderr.contains(name), "`{name}` is not named in {stderr}");
    }
}

#[test]
fn committed_files_are_their_designs_output() {
    let json = folder("committed").join("checked.json");
    assert_done(&quatrack(&["gains", "check", GAINS, "--json", json.to_str().unwrap()]));
    let checked: serde_json::Value = serde_json::from_str(&fs::read_to_string(json).unwrap()).unwrap();
    let files: Vec<&str> =
        checked["files"].as_array().unwrap().iter().map(|file| file["file"].as_str().unwrap()).collect();
    let names = ["lyap-e", "lyap-f", "lqr-e", "lqr-f", "sampled-lqr-e", "sampled-lqr-f", "lqi-e"];
    for name in names.into_iter().chain(["along-mild", "along-aggressive"]) {
        for extension in ["json", "rs", "bin"] {
            let file = format!("generated/{name}.{extension}");
            assert!(files.iter().any(|checked| checked.ends_with(&file)), "{file} is not among {files:?}");
        }
    }
    for source in SOURCES {
        assert!(files.iter().any(|checked| checked.ends_with(source)), "{source} is not among {files:?}");
    }
}

/// The generated sources of a checkout.
const SOURCES: [&str; 5] = [
    "core/src/gains/paper.rs",
    "crazyflie/src/builtin/paper_limits.rs",
    "core/src/gains/cascade.rs",
    "plans/mild.rs",
    "plans/aggressive.rs",
];

#[test]
fn files_missing_or_off_by_a_percent_are_named_and_written_again() {
    let root = folder("checkout");
    let gains = root.join("gains");
    fs::create_dir_all(&gains).unwrap();
    design(&gains, "lyap-f.toml", "lyap-f.toml", "2.0", "2.0");
    // Those that the core's own tables are made of.
    for entry in fs::read_dir(GAINS).unwrap().map(Result::unwrap) {
        let name = entry.file_name().into_string().unwrap();
        if name.starts_with("cascade-") && name.ends_with(".toml") {
            fs::copy(entry.path(), gains.join(name)).unwrap();
        }
    }
    let committed = |source: &str| fs::read_to_string(Path::new(GAINS).join("..").join(source)).unwrap();
    let write = |source: &str, text: &str| {
        let path = root.join(source);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    // A figure of each by 1 % of itself, a duration by 1 ns; one source and the tables are not there.
    for (source, from, to) in [
        (SOURCES[0], "45.7951", "45.3372"),
        (SOURCES[1], "(2.4, 0.0687)", "(2.4, 0.069387)"),
        (SOURCES[2], "0.20049259", "0.2024975"),
        (SOURCES[3], "duration_ns: 833333333", "duration_ns: 833333334"),
    ] {
        let text = committed(source);
        assert!(text.contains(from), "{source} has no {from}");
        write(source, &text.replacen(from, to, 1));
    }
    let there = gains.to_str().unwrap();
    let named = [
        "lyap-f.json: cannot be read",
        "paper.rs: line ",
        "paper_limits.rs: line ",
        "0.069387",
        "cascade.rs: line ",
        "0.2024975",
        "mild.rs: line 4 is",
        "aggressive.rs: cannot be read",
    ];
    assert_refused(&quatrack(&["gains", "check", there]), 1, &named);
    let output = quatrack(&["gains", "generate", there]);
    assert_done(&output);
    for source in SOURCES {
        assert!(stdout(&output).contains(&format!("{source}\n")), "{source}: {}", stdout(&output));
    }
    for source in &SOURCES[..3] {
        assert_eq!(fs::read_to_string(root.join(source)).unwrap(), committed(source), "{source}");
    }
    assert_eq!(
        fs::read(gains.join("generated/lyap-f.bin")).unwrap(),
        fs::read(format!("{GAINS}/generated/lyap-f.bin")).unwrap()
    );
}

#[test]
fn a_changed_file_is_named_with_its_first_difference() {
    let dir = folder("changed");
    let toml = design(&dir, "mine.toml", "lyap-f.toml", "mu_1_s = 2.0", "mu_1_s = 1.5");
    assert_done(&quatrack(&["gains", "design", &toml]));
    let made = dir.join("generated");
    let check = || quatrack(&["gains", "check", &toml]);
    assert_done(&check());

    // A figure of the certificate by 2e-5 of itself: more than the rounding to six digits and 1e-6.
    let json = made.join("mine.json");
    let whole = fs::read_to_string(&json).unwrap();
    let mut value: serde_json::Value = serde_json::from_str(&whole).unwrap();
    let figure = &mut value["certificate"]["sampled"]["spectral_radius"];
    *figure = (figure.as_f64().unwrap() * (1.0 - 2e-5)).into();
    fs::write(&json, value.to_string()).unwrap();
    assert_refused(&check(), 1, &["mine.json: certificate.sampled.spectral_radius is 0.99", "its design gives 0.99"]);
    // A gain in f64 by 2e-9.
    let mut value: serde_json::Value = serde_json::from_str(&whole).unwrap();
    let entry = &mut value["gain"]["k"][0][0];
    *entry = (entry.as_f64().unwrap() * (1.0 + 2e-9)).into();
    fs::write(&json, value.to_string()).unwrap();
    assert_refused(&check(), 1, &["mine.json: gain.k[0][0] is 4.5"]);
    // A file that only looks different is not.
    let value: serde_json::Value = serde_json::from_str(&whole).unwrap();
    fs::write(&json, value.to_string()).unwrap();
    assert_done(&check());

    let rust = made.join("mine.rs");
    let text = fs::read_to_string(&rust).unwrap();
    fs::write(&rust, text.replacen("[4.5, ", "[4.4, ", 1)).unwrap();
    let binary = made.join("mine.bin");
    let mut bytes = fs::read(&binary).unwrap();
    bytes[200] ^= 1;
    fs::write(&binary, &bytes).unwrap();
    fs::remove_file(&json).unwrap();
    // The whole folder: every file that is wrong, and one that no design gives.
    fs::write(made.join("older.bin"), bytes).unwrap();
    let named =
        ["mine.json: cannot be read", "mine.rs: line ", "mine.bin: byte 200 is", "older.bin: no design gives it"];
    assert_refused(&quatrack(&["gains", "check", dir.to_str().unwrap()]), 1, &named);
}

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
}

#[test]
fn without_designs_there_is_a_word_of_help() {
    let dir = folder("elsewhere");
    let there = |arguments: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_quatrack")).args(arguments).current_dir(&dir).output().unwrap()
    };
    assert_refused(&there(&["gains", "check"]), 2, &["gains: no such folder here", "checkout"]);
    assert_refused(&there(&["gains", "list"]), 2, &["gains: no such folder here"]);
    assert_refused(&there(&["gains", "check", "."]), 2, &["no design here"]);
    assert_refused(&there(&["gains", "check", "lost.toml"]), 2, &["lost.toml: cannot read this design"]);
    assert_refused(&there(&["gains", "show", "lost.bin"]), 2, &["lost.bin: cannot be read"]);
    assert_refused(&there(&["gains", "show", "lost.txt"]), 2, &["lost.txt: neither a design"]);
}

#[test]
fn tables_are_shown_from_every_form_and_listed() {
    let dir = folder("shown");
    let made = |extension: &str| format!("{GAINS}/generated/lqr-e.{extension}");
    let from_design = stdout(&quatrack(&["gains", "show", &format!("{GAINS}/lqr-e.toml")]));
    assert!(from_design.contains("45.7951") && from_design.contains("crazyflie-2.1"), "{from_design}");
    assert_eq!(stdout(&quatrack(&["gains", "show", &made("json")])), from_design);
    let json = dir.join("table.json");
    let output = quatrack(&["gains", "show", &made("bin"), "--json", json.to_str().unwrap()]);
    assert!(stdout(&output).contains("equilibrium table for crazyflie-2.1"), "{}", stdout(&output));
    let table: serde_json::Value = serde_json::from_str(&fs::read_to_string(json).unwrap()).unwrap();
    assert_eq!((&table["control_rate_hz"], &table["k_f32"][3][5]), (&500.into(), &10.0.into()));
    let json = dir.join("list.json");
    let output = quatrack(&["gains", "list", GAINS, "--json", json.to_str().unwrap()]);
    let line = stdout(&output).lines().find(|line| line.starts_with("lyap-f ")).map(str::to_owned).unwrap();
    assert!(["flat-output", "lyapunov", "500 Hz"].iter().all(|word| line.contains(word)), "{line}");
    let list: serde_json::Value = serde_json::from_str(&fs::read_to_string(json).unwrap()).unwrap();
    assert!(list["designs"].as_array().unwrap().iter().all(|entry| entry["generated"] == true));
}

#[test]
fn a_table_flies_as_the_design_that_it_was_made_of() {
    let dir = folder("flown");
    let flown = |name: &str, arguments: &[&str]| -> serde_json::Value {
        let json = dir.join(name);
        let shared = ["fly", "--trajectory", "aggressive", "--feed-forward", "--json", json.to_str().unwrap()];
        assert_done(&quatrack(&[&shared, arguments].concat()));
        serde_json::from_str(&fs::read_to_string(json).unwrap()).unwrap()
    };
    let table = format!("{GAINS}/generated/lqr-e.bin");
    let from_table = flown("table.json", &["--gains", &table]);
    // The same f32 gains, rate and limits: the same flight to the last digit.
    assert_eq!(from_table, flown("paper.json", &["--controller", "lqr-e", "--limits", "crazyflie-2.1"]));
    assert!(from_table["iae_m_s"].as_f64().unwrap() < 4e-4, "{from_table}");
    let fly = |arguments: &[&str]| quatrack(&[&["fly", "--trajectory", "mild", "--gains", &table], arguments].concat());
    assert_refused(&fly(&["--rate-hz", "100"]), 2, &["lqr-e.bin", "500 Hz", "--rate-hz 100"]);
    assert_refused(&fly(&["--precision", "f64"]), 2, &["--precision f64"]);
    assert_refused(&fly(&["--controller", "lqr-e"]), 2, &["--gains", "--controller"]);
    assert_refused(&fly(&["--mu", "2"]), 2, &["--mu"]);
    let damaged = dir.join("damaged.bin");
    let mut bytes = fs::read(&table).unwrap();
    bytes[300] ^= 4;
    fs::write(&damaged, bytes).unwrap();
    let damaged = damaged.to_str().unwrap();
    assert_refused(&quatrack(&["fly", "--trajectory", "mild", "--gains", damaged]), 2, &[damaged, "checksum"]);
}

#[test]
fn gains_along_a_trajectory_fly_that_one_alone() {
    let dir = folder("along");
    // A second of rest at the origin, and another one a metre off.
    let coefficients = |constant: &str| format!("1.0,{constant}{}\n", ",0".repeat(31));
    let header: Vec<String> = ["x", "y", "z", "yaw"]
        .iter()
        .flat_map(|coordinate| (0..8).map(move |power| format!("{coordinate}^{power}")))
        .collect();
    let trajectory = |name: &str, constant: &str| {
        let path = dir.join(name);
        fs::write(&path, format!("duration,{}\n{}", header.join(","), coefficients(constant))).unwrap();
        path
    };
    let (here, there) = (trajectory("here.csv", "0"), trajectory("there.csv", "1"));
    let flown = file::read(&here).unwrap();
    let TrajectoryFile::Pieces(pieces) = flown else { panic!("pieces") };
    let pieces = on_board::pieces(&pieces);
    let lqr_e = fs::read(format!("{GAINS}/generated/lqr-e.bin")).unwrap();
    let head = *GainTable::from_bytes(&lqr_e).unwrap().head();
    let gain = *quatrack::gains::paper::LQR_E.gain().rows();
    let rows = ScheduleRows {
        trajectory: Trajectory::new(&pieces).unwrap().checksum(),
        steps_per_knot: 500,
        gains: &[gain, gain],
    };
    let mut buffer = vec![0; TABLE_BYTES_MAX];
    let table = dir.join("along.bin");
    let written = GainTable::along(&mut buffer, &head, &rows).unwrap();
    fs::write(&table, written.to_bytes(&mut vec![0; TABLE_BYTES_MAX]).unwrap()).unwrap();
    let fly = |trajectory: &Path| {
        quatrack(&["fly", "--gains", table.to_str().unwrap(), "--trajectory", trajectory.to_str().unwrap()])
    };
    let output = fly(&here);
    assert_done(&output);
    assert!(stdout(&output).contains("largest position error    0.000000 m"), "{}", stdout(&output));
    assert_refused(&fly(&there), 2, &["along.bin: its gains are for another trajectory", "there.csv"]);
}

#[test]
fn the_committed_gains_along_the_w_are_shown_listed_and_flown() {
    let dir = folder("along-w");
    let table = format!("{GAINS}/generated/along-aggressive.bin");
    let json = dir.join("flown.json");
    let fly = |trajectory: &str| {
        let shared = ["fly", "--gains", &table, "--feed-forward", "--json", json.to_str().unwrap()];
        quatrack(&[&shared[..], &["--trajectory", trajectory]].concat())
    };
    assert_done(&fly("aggressive"));
    let flown: serde_json::Value = serde_json::from_str(&fs::read_to_string(&json).unwrap()).unwrap();
    // The error that remains under a hold of 10 ms, a fiftieth of the paper's 0.11; no limit of the vehicle is reached.
    assert!(flown["iae_m_s"].as_f64().unwrap() < 2.5e-3 && flown["saturated_steps"] == 0, "{flown}");
    assert_refused(&fly("mild"), 2, &["along-aggressive.bin: its gains are for another trajectory", "mild"]);
    let shown = |extension: &str| stdout(&quatrack(&["gains", "show", &table.replace("bin", extension)]));
    let knots = "59 knots, one in 21 control steps, for the trajectory 6e3047d3";
    assert!(shown("bin").contains(knots) && shown("json").contains(knots), "{}", shown("bin"));
    let json = dir.join("table.json");
    assert_done(&quatrack(&["gains", "show", &table, "--json", json.to_str().unwrap()]));
    let shown: serde_json::Value = serde_json::from_str(&fs::read_to_string(json).unwrap()).unwrap();
    assert_eq!((&shown["trajectory"], shown["k_f32"].as_array().map(Vec::len)), (&"6e3047d3".into(), Some(59)));
    let list = stdout(&quatrack(&["gains", "list", GAINS]));
    let line = list.lines().find(|line| line.starts_with("along-aggressive ")).unwrap();
    assert!(line.contains("equilibrium  along ") && line.contains("100 Hz"), "{line}");
    let export = quatrack(&["export", "--format", "json", "--design", &format!("{GAINS}/along-aggressive.toml")]);
    assert_refused(&export, 2, &["method = \"along\"", "one gain"]);
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
    assert_eq!(figures.len(), 4);
    for line in figures {
        assert!(printed.contains(line), "{line} is not in\n{printed}");
    }
    fs::write(&path, toml.replace("phase_all_deg = 32.0", "phase_all_deg = 60.0")).unwrap();
    let refused = block("Had it asked", "```text\nquatrack: gains/my-craft.toml: ");
    assert_refused(&quatrack(&["gains", "design", path.to_str().unwrap()]), 1, &[refused.trim()]);
}

#[test]
fn a_table_of_the_cascade_states_its_certified_region_and_flies_its_vehicle() {
    let dir = folder("cascade");
    let (design, table) =
        (format!("{GAINS}/cascade-brushless-50ms.toml"), format!("{GAINS}/generated/cascade-brushless-50ms.bin"));
    let pictures = dir.join("pictures");
    let shown = stdout(&quatrack(&["gains", "show", &design, "--plot", pictures.to_str().unwrap()]));
    for said in
        ["drag 0.353 1/s", "25.0 to 75.0 ms", "70 to 105 %", "largest spectral radius", "motor lag of all channels"]
    {
        assert!(shown.contains(said), "{said} is not in\n{shown}");
    }
    for extension in ["svg", "png"] {
        assert!(pictures.join(format!("cascade-brushless-50ms.{extension}")).is_file());
    }
    // A law of the paper is drawn as well, by its four commands.
    let paper = format!("{GAINS}/lqr-e.toml");
    assert_done(&quatrack(&["gains", "show", &paper, "--plot", pictures.to_str().unwrap()]));
    let drawn = fs::read_to_string(pictures.join("lqr-e.svg")).unwrap();
    for label in ["in vacuum", "thrust", "p, q", "x, y", "yaw"] {
        assert!(drawn.contains(label), "{label} is not in the picture");
    }
    assert_refused(&quatrack(&["gains", "show", &table, "--plot", "out"]), 2, &[&table, "--plot takes a design"]);
    let json = dir.join("table.json");
    assert_done(&quatrack(&["gains", "show", &table, "--json", json.to_str().unwrap()]));
    let shown: serde_json::Value = serde_json::from_str(&fs::read_to_string(json).unwrap()).unwrap();
    assert_eq!((&shown["air"]["learn"], shown["k_f32"][0].as_array().map(Vec::len)), (&true.into(), Some(16)));

    let flown = |name: &str, arguments: &[&str]| -> serde_json::Value {
        let json = dir.join(name);
        assert_done(&quatrack(&[&["fly", "--json", json.to_str().unwrap(), "--duration-s", "3"], arguments].concat()));
        serde_json::from_str(&fs::read_to_string(json).unwrap()).unwrap()
    };
    // The table is that of the default law: the same flight to the last digit, of the vehicle that it was made for.
    let own = flown("own.json", &["--gains", &design, "--air", "vehicle"]);
    let default = flown("default.json", &["--vehicle", "crazyflie-2.1-brushless", "--air", "vehicle"]);
    assert_eq!((&own["iae_m_s"], &own["law"]), (&default["iae_m_s"], &"cascade-brushless-50ms".into()));
    assert_refused(&quatrack(&["fly", "--gains", &table, "--vehicle", "crazyflie-2.1"]), 2, &[&table, "made for"]);
    let heavy = ["fly", "--gains", &table, "--vehicle", "crazyflie-2.1-brushless", "--told-mass-kg", "0.05"];
    assert_refused(&quatrack(&heavy), 2, &[&table, "certified for 0.0393 kg"]);
    let on_trajectory = ["fly", "--gains", &table, "--trajectory", "mild"];
    assert_refused(&quatrack(&on_trajectory), 2, &[&table, "--course instead of --trajectory"]);

    // A corner that is not stable names itself; a key of another method, too.
    let text = fs::read_to_string(&design).unwrap();
    let refused = |from: &str, to: &str, code: i32, words: &[&str]| {
        let path = dir.join("changed.toml");
        fs::write(&path, text.replace(from, to)).unwrap();
        assert_refused(&quatrack(&["gains", "design", path.to_str().unwrap()]), code, words);
    };
    refused(
        "motor_lag_ms = [25.0, 75.0]",
        "motor_lag_ms = [25.0, 250.0]",
        1,
        &["spectral radius of x with pitch", "250.0 ms"],
    );
    refused("motor_lag_ms = [25.0, 75.0]", "motor_lag_ms = [55.0, 75.0]", 2, &["region.motor_lag_ms = 55"]);
    refused("drag_per_s = 0.353", "drag_per_s = 3.53", 2, &["air.drag_per_s = 3.53", "from 0 to 1"]);
    refused("[minimum]", "[weights]\nattitude = [1.0, 1.0, 1.0]\n[minimum]", 2, &["weights.attitude"]);
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
    let flown = quatrack(&["crazyflie", "--vehicle", &vehicle]);
    assert_done(&flown);
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
fn text_given_for_a_binary_table_is_named_with_the_table_beside_it() {
    let json = format!("{GAINS}/generated/lqr-e.json");
    let beside = format!(
        "is JSON, a certificate perhaps, not a binary gain table; the table beside it is {GAINS}/generated/lqr-e.bin"
    );
    assert_refused(&quatrack(&["fly", "--gains", &json]), 2, &[&beside]);
    assert_refused(&quatrack(&["fly", "--gains", &json, "--trajectory", "mild"]), 2, &[&beside]);
    assert_refused(&quatrack(&["compare", "--gains", &json]), 2, &[&beside]);
}
