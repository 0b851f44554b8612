//! The command as its user meets it: its output, its files, and its refusals.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn quatrack(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_quatrack")).args(arguments).output().expect("the command starts")
}

/// A folder of this test's own, emptied.
fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

fn file(dir: &Path, name: &str, contents: &str) -> String {
    let path = dir.join(name);
    fs::write(&path, contents).unwrap();
    path.to_str().unwrap().to_owned()
}

/// The command refuses with this code, prints nothing but one line on standard error, and that line names all of this. An
/// error of the arguments themselves is printed by clap, in more lines.
fn assert_refused(arguments: &[&str], exit_code: i32, named: &[&str]) {
    let output = quatrack(arguments);
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(exit_code), "{arguments:?}: {stderr}");
    let by_clap = stderr.starts_with("error: ");
    assert!(by_clap || stderr.lines().count() == 1, "{arguments:?}: one line, not {stderr}");
    assert!(output.stdout.is_empty(), "{arguments:?}: nothing that looks like a result");
    for name in named {
        assert!(stderr.contains(name), "{arguments:?}: `{name}` is not named in {stderr}");
    }
}

const HEADER: &str = "duration,x^0,x^1,x^2,x^3,x^4,x^5,x^6,x^7,y^0,y^1,y^2,y^3,y^4,y^5,y^6,y^7,\
                      z^0,z^1,z^2,z^3,z^4,z^5,z^6,z^7,yaw^0,yaw^1,yaw^2,yaw^3,yaw^4,yaw^5,yaw^6,yaw^7\n";

/// A row at rest at `x` for `duration`.
fn row(duration: &str, x: &str) -> String {
    format!("{duration},{x}{}\n", ",0".repeat(31))
}

#[test]
fn trajectory_files_that_cannot_be_flown_are_refused_in_one_line() {
    let dir = folder("bad_trajectories");
    let fly = |path: &str, named: &[&str]| {
        let arguments = ["fly", "--controller", "lqr-e", "--trajectory", path];
        assert_refused(&arguments, 2, &[&[path], named].concat());
    };
    fly("no/such/file.csv", &["No such file"]);
    let case = |name: &str, rows: &str| file(&dir, name, &format!("{HEADER}{rows}"));
    fly(&case("columns.csv", "1.0,0,0\n"), &["line 2", "3"]);
    fly(&case("word.csv", &row("1.0", "fast")), &["line 2", "fast"]);
    fly(&case("nan.csv", &row("1.0", "NaN")), &["line 2", "NaN"]);
    fly(&case("infinite.csv", &row("1.0", "inf")), &["line 2", "inf"]);
    fly(&case("zero.csv", &row("0", "0")), &["line 2", "0"]);
    fly(&case("negative.csv", &row("-1.5", "0")), &["line 2", "-1.5"]);
    fly(&case("jump.csv", &(row("1.0", "0") + &row("1.0", "0.5"))), &["piece 1", "0.5"]);
    fly(&case("empty.csv", ""), &[]);
    fly(&file(&dir, "nothing.csv", ""), &[]);
    fly(&file(&dir, "prose.txt", "to be or not to be\n"), &["accepted"]);
    fly(&file(&dir, "one_point.toml", "degree = 5\nduration_s = 1.0\ncontrol_points_m = [[0.0, 0.0, 0.0]]\n"), &["1"]);
    fly(&file(&dir, "one_waypoint.toml", "[[waypoints]]\ntime_s = 0.0\nposition_m = [0.0, 0.0, 0.0]\n"), &[]);
}

#[test]
fn options_out_of_range_are_refused_in_one_line() {
    let fly = |more: &[&str], named: &[&str]| {
        let arguments = [&["fly", "--controller", "lyap-e", "--trajectory", "mild"], more].concat();
        assert_refused(&arguments, 2, named);
    };
    fly(&["--rate-hz", "-5"], &["--rate-hz -5", "1 to 10000"]);
    fly(&["--rate-hz", "0"], &["--rate-hz 0"]);
    fly(&["--rate-hz", "0.5"], &["--rate-hz 0.5"]);
    fly(&["--rate-hz", "fast"], &["fast"]);
    fly(&["--mu", "-1"], &["--mu -1"]);
    fly(&["--mu", "0"], &["--mu 0"]);
    fly(&["--mu", "nan"], &["--mu NaN"]);
    fly(&["--limits", "boeing"], &["boeing", "crazyflie-2.1"]);
    fly(&["--limits", "9,1,20"], &["9"]);
    fly(&["--limits", "0,20,-3"], &["-3"]);
    fly(&["--precision", "f16"], &["f16", "f32"]);
    assert_refused(&["fly", "--controller", "pid", "--trajectory", "mild"], 2, &["pid", "lqr-e"]);
    assert_refused(&["fly", "--controller", "lqr-e", "--trajectory", "mild", "--mu", "1"], 2, &["--mu"]);
    assert_refused(&["fly"], 2, &["--controller"]);
    assert_refused(&["land"], 2, &["land"]);
}

#[test]
fn places_that_cannot_be_written_are_refused_in_one_line() {
    let dir = folder("unwritable");
    let blocked = file(&dir, "a_file", "");
    let inside = format!("{blocked}/out");
    assert_refused(&["reproduce", "--out", &inside], 2, &[&inside]);
    let arguments = ["fly", "--controller", "lqr-e", "--trajectory", "mild", "--out", &inside];
    assert_refused(&arguments, 2, &[&inside]);
}

#[test]
fn a_flight_is_logged_whole_with_named_columns() {
    let dir = folder("flight");
    let out = dir.to_str().unwrap();
    let json = dir.join("metrics.json");
    let output = quatrack(&[
        "fly",
        "--controller",
        "LQR-E",
        "--trajectory",
        "aggressive",
        "--rate-hz",
        "250",
        "--limits",
        "crazyflie-2.1",
        "--out",
        out,
        "--json",
        json.to_str().unwrap(),
    ]);
    assert!(output.status.success());
    let log = fs::read_to_string(dir.join("flight.csv")).unwrap();
    let header: Vec<&str> = log.lines().next().unwrap().split(',').collect();
    assert_eq!((header[0], header[1], header[4], header[11]), ("t_s", "x_m", "q0", "ref_x_m"));
    // 12 s at 100 Hz, both ends, and the header.
    assert_eq!(log.lines().count(), 1202);
    assert!(log.lines().all(|line| line.split(',').count() == header.len()));
    let metrics: serde_json::Value = serde_json::from_str(&fs::read_to_string(json).unwrap()).unwrap();
    assert!((metrics["iae_m_s"].as_f64().unwrap() - 0.1115).abs() < 1e-3);
    assert_eq!(metrics["saturated_steps"], 0);
    // A file written is there under its own name only.
    assert!(
        fs::read_dir(&dir).unwrap().all(|entry| !entry
            .unwrap()
            .file_name()
            .to_string_lossy()
            .starts_with(".quatrack-"))
    );
}

#[test]
fn limits_that_bind_are_counted() {
    let arguments = ["fly", "--controller", "lqr-e", "--trajectory", "aggressive", "--limits", "0,12,20"];
    let output = quatrack(&arguments);
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    let steps: u64 =
        text.lines().find_map(|line| line.trim().strip_prefix("saturated steps")).unwrap().trim().parse().unwrap();
    assert!(steps > 0, "the W asks for 13 m/s^2:\n{text}");
}

#[test]
fn a_planned_file_flies_like_its_plan() {
    let dir = folder("planned");
    let json = dir.join("w.json");
    let plan = concat!(env!("CARGO_MANIFEST_DIR"), "/../../plans/aggressive.toml");
    assert!(quatrack(&["plan", plan, "--json", json.to_str().unwrap()]).status.success());
    let iae = |trajectory: &str| {
        let output = quatrack(&["fly", "--controller", "lqr-e", "--trajectory", trajectory]);
        String::from_utf8(output.stdout).unwrap().lines().nth(1).unwrap().to_owned()
    };
    assert_eq!(iae(json.to_str().unwrap()), iae("aggressive"));
    assert_eq!(iae(plan), iae("aggressive"));
}

#[test]
fn a_refit_fits_the_memory_and_flies_like_its_original() {
    let dir = folder("refit");
    let at = |name: &str| dir.join(name).to_str().unwrap().to_owned();
    let (csv, json) = (at("w.csv"), at("fit.json"));
    let output = quatrack(&["refit", "aggressive", "--csv", &csv, "--json", &json]);
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("38 pieces") && text.contains("4092 of 4096 bytes"), "{text}");
    let report: serde_json::Value = serde_json::from_str(&fs::read_to_string(&json).unwrap()).unwrap();
    assert_eq!((report["original_pieces"].as_u64(), report["pieces"].as_u64()), (Some(38), Some(31)));
    assert!(report["largest_difference"]["position_m"].as_f64().unwrap() < 1e-5);
    // IAE of positions that differ by less than 1e-5 m for 12 s.
    let iae = |law: &str, of: &str| report[law][of].as_f64().unwrap();
    for law in ["lqr_e", "lqr_e_feed_forward"] {
        let original = iae(law, "original_iae_m_s");
        assert!((iae(law, "refit_from_original_iae_m_s") - original).abs() < 12.0 * 1e-5);
        assert!((iae(law, "refit_iae_m_s") - original).abs() < 12.0 * 1e-5);
    }
    assert!((iae("lqr_e", "original_iae_m_s") - 0.1115).abs() < 1e-3);
    // The file is read as it was stored: nothing is left to fit.
    let again = at("again.csv");
    assert!(quatrack(&["refit", &csv, "--csv", &again]).status.success());
    assert_eq!(fs::read_to_string(&csv).unwrap(), fs::read_to_string(&again).unwrap());
}

#[test]
fn a_refit_out_of_tolerance_exits_1_and_writes_nothing() {
    let dir = folder("coarse_refit");
    let csv = dir.join("w.csv");
    let arguments = ["refit", "aggressive", "--pieces", "8", "--tolerance-m", "0.001", "--csv", csv.to_str().unwrap()];
    let output = quatrack(&arguments);
    assert_eq!(output.status.code(), Some(1));
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(stderr.contains("aggressive: 8 pieces are") && stderr.contains("--tolerance-m 0.001"), "{stderr}");
    assert!(!csv.exists());
    // Without a tolerance it is written, and 8 cm are said.
    let output = quatrack(&["refit", "aggressive", "--pieces", "6", "--csv", csv.to_str().unwrap()]);
    let printed = String::from_utf8(output.stdout).unwrap();
    let note = "note: 6 pieces are 0.083 m off, which is far; allow more pieces (--pieces, at most 31)";
    assert!(output.status.success() && csv.exists() && printed.contains(note), "{printed}");
    let output = quatrack(&["refit", "aggressive", "--pieces", "8"]);
    assert!(!String::from_utf8(output.stdout).unwrap().contains("which is far"), "8 mm");
    assert_refused(&["refit", "aggressive", "--pieces", "32"], 2, &["32", "1..=31"]);
    assert_refused(&["refit", "aggressive", "--pieces", "0"], 2, &["0", "1..=31"]);
    assert_refused(&["refit", "mild", "--tolerance-m", "0"], 2, &["--tolerance-m", "positive"]);
    assert_refused(&["refit", "no/such/file.csv"], 2, &["no/such/file.csv"]);
}

#[test]
fn reproduce_writes_the_table_and_the_figures() {
    let dir = folder("reproduce");
    let json = dir.join("table.json");
    let output = quatrack(&["reproduce", "--beyond", "--out", dir.to_str().unwrap(), "--json", json.to_str().unwrap()]);
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("8 of 8 cells round to the printed digits") && text.contains("saturated steps: 0"));
    for number in 2..=5 {
        assert!(fs::read_to_string(dir.join(format!("figure{number}.svg"))).unwrap().trim_end().ends_with("</svg>"));
        assert_eq!(fs::read(dir.join(format!("figure{number}.png"))).unwrap()[..4], *b"\x89PNG");
    }
    let table: serde_json::Value = serde_json::from_str(&fs::read_to_string(json).unwrap()).unwrap();
    assert_eq!(table["iae"]["mild"]["LQR-E"]["paper"], 0.018);
    assert!(table["iae"]["aggressive"]["LYAP-F"]["core_f32"]["1000"].is_f64());
    assert!(text.contains("Past the paper"));
    assert!(table["beyond"]["aggressive"]["LQR-E"]["100"]["feed_forward"].is_f64());
}

#[test]
fn help_is_for_people() {
    for command in ["reproduce", "fly", "plan", "refit", "analyze"] {
        let output = quatrack(&[command, "--help"]);
        assert!(output.status.success(), "{command}");
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains("Usage:") && text.contains("--json"), "{command}: {text}");
    }
}
