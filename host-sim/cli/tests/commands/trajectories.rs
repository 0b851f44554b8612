//! Trajectories and plans as they are typed: files read, moved and written, the end of a flight that is lost, and the
//! message about a reference that cannot be followed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn quatrack(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_quatrack")).args(arguments).output().expect("the command starts")
}

fn texts(output: &Output) -> (Option<i32>, String, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

/// A folder of this test's own, emptied.
fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

fn file(dir: &Path, name: &str, contents: &[u8]) -> String {
    let path = dir.join(name);
    fs::write(&path, contents).unwrap();
    path.to_str().unwrap().to_owned()
}

/// One metre along x in 2 s, from rest to rest, and on by another; commas separate.
const HOPS: &str = "duration,x^0,x^4,x^5,x^6,x^7,y^0,z^0\n2,0,2.1875,-2.625,1.09375,-0.15625,0,1\n\
                    2,1,2.1875,-2.625,1.09375,-0.15625,0,1\n";

#[test]
fn files_of_other_tools_fly_alike() {
    let dir = folder("alike");
    let iae = |name: &str, text: &str| {
        let path = file(&dir, name, text.as_bytes());
        let (code, stdout, stderr) = texts(&quatrack(&["fly", "--controller", "lqr-e", "--trajectory", &path]));
        assert_eq!(code, Some(0), "{name}: {stderr}");
        stdout.lines().nth(1).unwrap().to_owned()
    };
    let expected = iae("commas.csv", HOPS);
    assert_eq!(iae("semicolons.csv", &HOPS.replace(',', ";").replace('.', ",")), expected);
    assert_eq!(iae("tabs.csv", &HOPS.replace(',', "\t")), expected);
    let indexed: String = HOPS.lines().zip(["", "0", "1"]).map(|(line, index)| format!("{index},{line}\n")).collect();
    assert_eq!(iae("pandas.csv", &indexed), expected);
}

#[test]
fn a_lost_flight_is_exit_code_3_and_says_so_in_the_help() {
    let dir = folder("lost");
    let json = dir.join("lost.json");
    let flown = ["fly", "--controller", "lqr-e", "--trajectory", "aggressive", "--rate-hz", "25", "--json"];
    let (code, stdout, stderr) = texts(&quatrack(&[&flown[..], &[json.to_str().unwrap()]].concat()));
    assert_eq!(code, Some(3), "{stderr}");
    assert!(stderr.contains("LQR-E was lost at") && stdout.contains("none: the flight was lost"), "{stdout}{stderr}");
    let report: serde_json::Value = serde_json::from_str(&fs::read_to_string(json).unwrap()).unwrap();
    assert!(report["lost"].is_string() && report["max_error_m"].as_f64().unwrap() > 1.0);
    for command in ["fly", "refit"] {
        let (_, help, _) = texts(&quatrack(&[command, "--help"]));
        assert!(help.contains("lost") && help.contains("xit code"), "{help}");
    }
}

#[test]
fn a_reference_that_cannot_be_followed_is_named_in_one_line() {
    let dir = folder("reference");
    // 1.5 m/s from the start, then 0.5 m/s.
    let path = file(&dir, "moving.csv", b"duration,x^0,x^1,y^0,z^0\n2,0,1.5,0,1\n2,3,0.5,0,1\n");
    let (_, stdout, _) =
        texts(&quatrack(&["fly", "--controller", "lqr-e", "--trajectory", &path, "--limits", "0,9.5,20"]));
    let note = stdout.lines().find(|line| line.contains("note: the reference itself")).expect("a note").to_owned();
    for named in ["starts in motion, at 1.50 m/s", "jumps by 1.000 m/s behind piece 1", "where the limit is 9.50"] {
        assert!(note.contains(named), "{note}");
    }
    let (_, stdout, _) = texts(&quatrack(&["refit", &path, "--limits", "none"]));
    assert!(stdout.contains("note: the reference itself starts in motion"), "{stdout}");
}

#[test]
fn a_trajectory_is_flown_slower_backwards_and_elsewhere() {
    let dir = folder("moved");
    let path = file(&dir, "hops.csv", HOPS.as_bytes());
    let flags = ["--time-scale", "2", "--reverse", "--start", "5,0,1"];
    let out = dir.join("moved.csv");
    let refit = [&["refit", &path, "--csv", out.to_str().unwrap()], &flags[..]].concat();
    let (code, stdout, stderr) = texts(&quatrack(&refit));
    assert_eq!(code, Some(0), "{stderr}");
    assert!(stdout.contains("2 pieces, 8.00 s"), "{stdout}");
    let rows = fs::read_to_string(out).unwrap();
    assert!(rows.lines().nth(1).unwrap().starts_with("4,5,"), "{rows}");
    for (flag, value) in [("--time-scale", "0"), ("--time-scale", "-1"), ("--scale", "nan"), ("--start", "1,2")] {
        let (code, _, stderr) = texts(&quatrack(&["fly", "--controller", "lqr-e", "--trajectory", &path, flag, value]));
        assert_eq!(code, Some(2), "{flag} {value}");
        assert!(stderr.contains(flag), "{stderr}");
    }
}

#[test]
fn the_compressed_form_is_written_and_read() {
    let dir = folder("compressed");
    let path = dir.join("w.ctraj");
    let (code, stdout, stderr) = texts(&quatrack(&["refit", "aggressive", "--compressed", path.to_str().unwrap()]));
    assert_eq!(code, Some(0), "{stderr}");
    assert!(stdout.contains("of 4096 bytes, at most "), "{stdout}");
    // Of each of its pieces three axes of 7 control points at most, no heading: one that is straight along an axis has fewer.
    let (bytes, pieces) = (fs::metadata(&path).unwrap().len(), 45);
    assert!(bytes > pieces * 3 && bytes <= 8 + pieces * (3 + 3 * 7 * 2) + 3, "{bytes}");
    let flown = ["fly", "--controller", "lqr-e", "--trajectory", path.to_str().unwrap()];
    let (code, stdout, stderr) = texts(&quatrack(&flown));
    assert_eq!(code, Some(0), "{stderr}");
    let iae: f64 = stdout.lines().nth(1).unwrap().split_whitespace().rev().nth(2).unwrap().parse().unwrap();
    // Half a millimetre a control point for 12 s, beside the original's.
    assert!((iae - 0.1114).abs() < 12.0 * 0.5e-3, "{iae}");
}

#[test]
fn the_compressed_form_has_more_pieces_than_the_other_where_they_fit() {
    let dir = folder("compressed-many");
    // Forty times from rest to rest, 0.3 m there or back: 31 pieces are centimetres off.
    let header = ["x", "y", "z", "yaw"].map(|name| (0..8).map(|k| format!(",{name}^{k}")).collect::<String>()).concat();
    let mut rows = format!("duration{header}\n");
    for piece in 0..40 {
        let (from, way) = if piece % 2 == 0 { (0.0, 0.3) } else { (0.3, -0.3) };
        let x = [35.0, -84.0, 70.0, -20.0].map(|c| format!(",{}", c * way)).concat();
        rows += &format!("1,{from},0,0,0{x}{},1{}\n", ",0".repeat(8), ",0".repeat(15));
    }
    let (given, packed) = (file(&dir, "many.csv", rows.as_bytes()), dir.join("many.ctraj"));
    let tight = ["--compressed", packed.to_str().unwrap(), "--tolerance-m", "0.001"];
    let (code, stdout, stderr) = texts(&quatrack(&[&["refit", &given], &tight[..]].concat()));
    assert_eq!(code, Some(0), "{stdout}{stderr}");
    let (code, _, stderr) = texts(&quatrack(&["refit", &given, "--csv", "-", "--tolerance-m", "0.001"]));
    assert!(code == Some(1) && stderr.contains("31 pieces are"), "the fit: {stderr}");
}

#[test]
fn standard_output_holds_one_file() {
    let (code, stdout, stderr) = texts(&quatrack(&["plan", "../../plans/mild.toml", "--json", "-", "--csv", "-"]));
    assert!(code == Some(2) && stdout.is_empty(), "{stdout}");
    assert!(
        stderr.contains("'--csv <FILE>': standard output holds one file, and another argument has it; name a file"),
        "{stderr}"
    );
}

#[test]
fn a_tolerance_holds_for_the_compressed_form_too() {
    let dir = folder("compressed-tolerance");
    let [packed, pieces] = ["w.ctraj", "w.csv"].map(|name| dir.join(name));
    let refit = |tolerance_m: &str| {
        let files = ["--compressed", packed.to_str().unwrap(), "--csv", pieces.to_str().unwrap()];
        texts(&quatrack(&[&["refit", "aggressive", "--tolerance-m", tolerance_m], &files[..]].concat()))
    };
    // The fit is 8 um off, its compressed form 1.1 mm: half a millimetre an axis, and half a millisecond at 2.2 m/s.
    let (code, _, stderr) = refit("0.001");
    assert_eq!(code, Some(1), "{stderr}");
    assert!(!packed.exists() && !pieces.exists(), "something was written");
    for named in ["the compressed form is", "--tolerance-m 0.001", "--csv in place of --compressed", "--time-scale 2"] {
        assert!(stderr.contains(named), "{stderr}");
    }
    let allowed = stderr.trim().rsplit(' ').next().unwrap();
    let (code, stdout, stderr) = refit(allowed);
    assert_eq!(code, Some(0), "{allowed}: {stderr}");
    assert!(packed.exists() && pieces.exists(), "{stdout}");
}

#[test]
fn waypoints_become_a_trajectory_that_flies() {
    let dir = folder("waypoints");
    let rows = file(&dir, "places.csv", b"t,x,y,z\n0,0,0,1\n1,0.2,0,1\n2,0.5,0.3,1\n3,0.5,0.6,1.2\n");
    let (code, _, stderr) = texts(&quatrack(&["fly", "--controller", "lqr-e", "--trajectory", &rows]));
    assert_eq!(code, Some(2));
    assert!(stderr.contains("rows of waypoints with times") && stderr.contains("quatrack plan"), "{stderr}");
    let toml = dir.join("planned.toml");
    let plan = ["plan", &rows, "--time-scale", "2", "--toml", toml.to_str().unwrap()];
    let (code, stdout, stderr) = texts(&quatrack(&plan));
    assert_eq!(code, Some(0), "{stderr}");
    assert!(stdout.contains("24 spans, 29 control points, 6 s"), "{stdout}");
    let (code, ..) = texts(&quatrack(&["fly", "--controller", "lqr-e", "--trajectory", toml.to_str().unwrap()]));
    assert_eq!(code, Some(0));
    // Without times the command that is printed gives bounds, and plans as printed.
    let rows = file(&dir, "untimed.csv", b"x,y,z\n0,0,1\n0.2,0,1\n0.5,0.3,1\n");
    let (_, _, stderr) = texts(&quatrack(&["fly", "--controller", "lqr-e", "--trajectory", &rows]));
    let command = stderr.split('`').nth(1).and_then(|command| command.strip_prefix("quatrack ")).expect("a command");
    let arguments = command.split(' ');
    let planning = Command::new(env!("CARGO_BIN_EXE_quatrack")).args(arguments).current_dir(&dir).output().unwrap();
    let (code, _, stderr) = texts(&planning);
    assert_eq!(code, Some(0), "{stderr}");
    // Stops make several curves, which fly as one trajectory.
    let stop = b"waypoints = [{ time_s = 0, position_m = [0, 0, 1] }, { time_s = 3, position_m = [1, 0, 1], stop = true, yaw_deg = 30 },\n\
                 { time_s = 6, position_m = [1, 1, 1] }]\n";
    let stop = file(&dir, "stop.toml", stop);
    let json = dir.join("stop.json");
    let (code, _, stderr) = texts(&quatrack(&["plan", &stop, "--json", json.to_str().unwrap()]));
    assert_eq!(code, Some(0), "{stderr}");
    let (code, stdout, _) = texts(&quatrack(&["fly", "--controller", "lqr-e", "--trajectory", json.to_str().unwrap()]));
    assert!(code == Some(0) && stdout.contains(", 6.00 s,"), "{stdout}");
}

#[test]
fn a_file_that_is_no_plan_is_named_for_what_it_is() {
    let dir = folder("no-plan");
    let samples = file(&dir, "samples.csv", b"x,y,z,speed\n0,0,1,1\n2,0,1,1\n");
    let (code, _, stderr) = texts(&quatrack(&["plan", &samples]));
    assert_eq!(code, Some(2));
    assert!(stderr.contains("rows of a flight sampled over time (x,y,z,speed)"), "{stderr}");
    let spline = file(
        &dir,
        "spline.json",
        br#"{"degree":5,"duration_s":2,"control_points_m":[[0,0,0],[0,0,0],[0,0,0],[1,0,0],[1,0,0],[1,0,0]]}"#,
    );
    let (code, _, stderr) = texts(&quatrack(&["plan", &spline]));
    assert_eq!(code, Some(2));
    assert!(
        stderr.contains(&format!("is a trajectory already, nothing to plan; `quatrack fly --trajectory {spline}`")),
        "{stderr}"
    );
    // A slip in a plan is one still.
    let slip = file(&dir, "slip.toml", b"[[waypoints]\ntime_s = 0\n");
    let (_, _, stderr) = texts(&quatrack(&["plan", &slip]));
    assert!(stderr.contains("slip.toml: line 1"), "{stderr}");
}

#[test]
fn a_plan_ends_in_its_time_and_never_reads_on_for_ever() {
    let plan = concat!(env!("CARGO_MANIFEST_DIR"), "/../../plans/mild.toml");
    let (code, _, stderr) = texts(&quatrack(&["plan", plan, "--time-limit-s", "1e-9"]));
    assert_eq!(code, Some(1), "{stderr}");
    assert!(stderr.contains("no answer within 0.000000001 s") && stderr.contains("--time-limit-s"), "{stderr}");
    let (code, _, stderr) = texts(&quatrack(&["plan", plan, "--time-limit-s", "0"]));
    assert_eq!(code, Some(2), "{stderr}");
    if Path::new("/dev/zero").exists() {
        let (code, _, stderr) = texts(&quatrack(&["plan", "/dev/zero"]));
        assert_eq!(code, Some(2));
        assert!(stderr.contains("a device without an end"), "{stderr}");
    }
}

#[test]
fn names_that_are_nearly_right_are_asked_about() {
    let (_, _, stderr) = texts(&quatrack(&["fly", "--vehicle", "crazyfly-2.1"]));
    assert!(stderr.contains("did you mean crazyflie-2.1?"), "{stderr}");
    let (_, _, stderr) = texts(&quatrack(&["fly", "--vehicle", "crazyflie-2.1", "--law", "melinger"]));
    assert!(stderr.contains("did you mean mellinger?"), "{stderr}");
    let (_, _, stderr) = texts(&quatrack(&["export", "--format", "json", "--design", "lqre"]));
    assert!(stderr.contains("did you mean lqr-e?"), "{stderr}");
    let (_, _, stderr) = texts(&quatrack(&["manoeuvres", "--lag-ms", "-5"]));
    assert!(stderr.contains("errors.lag_ms = -5: must be from 1 to 1000, in ms"), "{stderr}");
}

#[test]
fn a_certificate_in_the_place_of_a_table_is_named_with_the_table_beside_it() {
    let gains = concat!(env!("CARGO_MANIFEST_DIR"), "/../../gains/generated/sampled-lqr-e.json");
    let (code, _, stderr) = texts(&quatrack(&["fly", "--gains", gains, "--trajectory", "mild"]));
    assert_eq!(code, Some(2));
    assert!(stderr.contains("is JSON") && stderr.contains("sampled-lqr-e.bin"), "{stderr}");
}

#[test]
fn shells_and_manuals_know_the_command() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let (code, stdout, _) = texts(&quatrack(&["completions", shell]));
        assert!(code == Some(0) && stdout.contains("refit") && stdout.contains("time-limit-s"), "{shell}");
    }
    let (code, stdout, _) = texts(&quatrack(&["man"]));
    assert!(code == Some(0) && stdout.contains(".TH quatrack"), "{stdout}");
    let (code, stdout, _) = texts(&quatrack(&["man", "plan"]));
    assert!(code == Some(0) && stdout.contains("acceleration"), "{stdout}");
    let (code, _, stderr) = texts(&quatrack(&["man", "plane"]));
    assert!(code == Some(2) && stderr.contains("did you mean plan?"), "{stderr}");
}
