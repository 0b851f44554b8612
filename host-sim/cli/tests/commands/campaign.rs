//! `quatrack campaign` and `quatrack report` as their user meets them.

mod folders;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// 0.3 s of hover, 2.3 s with its beginning: short flights with something of everything.
const SCENARIO: &str = "vehicle = \"crazyflie-2.1-brushless\"\ncourse = \"hover\"\nduration_s = 0.3\nlaws = [\"quatrack\", \
                        \"lee\"]\nair = \"vehicle\"\n[noise]\nposition_m = 0.001\n[vary]\nerrors.mass_factor = { normal = [1.0, \
                        0.1], min = 0.8, max = 1.2 }\nerrors.delay_ms = { choice = [0, 5] }\nair.wind_m_s = [{ uniform = [-1.0, \
                        1.0] }, 0.5, 0]\nair.gust_rms_m_s = { log_normal = [0.2, 0.5], max = 1.0 }\n";

fn quatrack(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_quatrack")).args(arguments).output().expect("the command starts")
}

fn flown(arguments: &[&str]) -> String {
    let output = quatrack(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

struct Bench(PathBuf);

impl Bench {
    fn new(name: &str) -> Self {
        let bench = Self(folder(name));
        fs::write(bench.0.join("s.toml"), SCENARIO).unwrap();
        bench
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_owned()
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.0.join(name)).unwrap()
    }
}

#[test]
fn a_run_is_the_same_alone_in_a_shard_and_on_any_number_of_cores() {
    let bench = Bench::new("campaign-same");
    let [scenario, one, many, joined] = ["s.toml", "one", "many", "joined"].map(|name| bench.path(name));
    flown(&["campaign", &scenario, "--runs", "7", "--threads", "1", "--out", &one]);
    for shard in ["2/3", "1/3", "3/3"] {
        flown(&["campaign", &scenario, "--runs", "7", "--shard", shard, "--threads", "2", "--out", &many]);
    }
    flown(&["campaign", "merge", &many, "--out", &joined]);
    for file in ["rows.csv", "rows.parquet", "campaign.json", "scenario.toml"] {
        assert_eq!(bench.bytes(&format!("one/{file}")), bench.bytes(&format!("joined/{file}")), "{file}");
    }
    let text = String::from_utf8(bench.bytes("one/rows.csv")).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 1 + 7 * 2);
    assert_eq!(rows[0][9..], ["air.gust_rms_m_s", "air.wind_m_s.0", "errors.delay_ms", "errors.mass_factor"]);
    // Both laws fly the same figures and noise; runs differ.
    assert!(rows[1][2] == rows[2][2] && rows[1][9..] == rows[2][9..] && rows[1][2] != rows[3][2]);
    let page = flown(&["report", &one, "--without-paper", "--worst", "1"]);
    assert!(page.contains("report.html"), "{page}");
    let html = String::from_utf8(bench.bytes("one/report.html")).unwrap();
    // Nothing is fetched.
    assert!(!html.contains("http") && !html.contains("src=") && html.contains("\"kind\":\"worst\""));
}

#[test]
fn a_campaign_that_was_killed_goes_on_where_it_was() {
    let bench = Bench::new("campaign-killed");
    let [scenario, out] = ["s.toml", "out"].map(|name| bench.path(name));
    let fly = || flown(&["campaign", &scenario, "--runs", "3", "--out", &out]);
    fly();
    let whole = bench.bytes("out/rows.csv");
    // Cut within the header, at a row's end, within the second row of a run and within a number.
    let lines: Vec<usize> = whole.iter().enumerate().filter(|(_, byte)| **byte == b'\n').map(|(i, _)| i + 1).collect();
    for kept in [0, 5, lines[0], lines[2], lines[3], lines[3] + 20, whole.len() - 1] {
        fs::write(bench.0.join("out/rows.csv"), &whole[..kept]).unwrap();
        fly();
        assert_eq!(bench.bytes("out/rows.csv"), whole, "{kept}");
    }
    // The part of a block that a disk left behind is no row.
    let mut torn = whole.clone();
    torn[lines[4]..].fill(0);
    fs::write(bench.0.join("out/rows.csv"), torn).unwrap();
    let said = fly();
    assert!(bench.bytes("out/rows.csv") == whole && said.contains("2 of them before"), "{said}");
    // More runs come after those.
    flown(&["campaign", &scenario, "--runs", "4", "--out", &out]);
    assert!(bench.bytes("out/rows.csv").starts_with(&whole));
}

#[test]
fn a_flight_of_a_campaign_is_flown_again() {
    let bench = Bench::new("campaign-replay");
    let [scenario, out, json, plot, own] =
        ["s.toml", "out", "lee.json", "lee.svg", "own.toml"].map(|name| bench.path(name));
    flown(&["campaign", &scenario, "--runs", "2", "--seed", "5", "--out", &out]);
    let text = String::from_utf8(bench.bytes("out/rows.csv")).unwrap();
    let row: Vec<&str> = text.lines().nth(4).unwrap().split(',').collect();
    assert_eq!(row[..2], ["1", "lee"]);
    let replay = ["campaign", "replay", &out, "--run", "1", "--law", "lee"];
    flown(&[&replay[..], &["--json", &json, "--plot", &plot, "--scenario-out", &own]].concat());
    let figures: serde_json::Value = serde_json::from_slice(&bench.bytes("lee.json")).unwrap();
    assert_eq!(figures["iae_m_s"].as_f64().unwrap(), row[4].parse::<f64>().unwrap());
    assert!(bench.bytes("lee.svg").starts_with(b"<svg"));
    // The written scenario is the same flight, and so is the run in a summary's words.
    flown(&["fly", "--scenario", &own, "--json", &json]);
    let again: serde_json::Value = serde_json::from_slice(&bench.bytes("lee.json")).unwrap();
    assert_eq!(again["iae_m_s"], figures["iae_m_s"]);
    let summary_json = bench.path("summary.json");
    let summary = flown(&["campaign", "summary", &out, "--worst", "1", "--json", &summary_json]);
    assert!(
        summary.contains("quatrack campaign replay") && summary.contains("rank correlation with them"),
        "{summary}"
    );
    let summary: serde_json::Value = serde_json::from_slice(&bench.bytes("summary.json")).unwrap();
    assert_eq!(
        (&summary["schema"], &summary["laws"][1]["flights"]),
        (&"quatrack/campaign-summary/1".into(), &2.into())
    );
    // Distributions are nothing to a single flight.
    flown(&["fly", "--scenario", &scenario]);
}

#[test]
fn a_folder_holds_the_vehicle_that_bounds_its_course() {
    let bench = Bench::new("campaign-bounds");
    let [scenario, out, elsewhere] = ["s.toml", "out", "elsewhere"].map(|name| bench.path(name));
    let vehicle = include_str!("../../../../gains/vehicles/crazyflie-2.1-legacy.toml");
    fs::create_dir_all(bench.0.join("craft")).unwrap();
    fs::write(bench.0.join("craft/mine.toml"), vehicle).unwrap();
    let plan = "waypoints = [{ position_m = [0, 0, 1] }, { position_m = [1, 0, 1] }, { position_m = [2, 0.5, 1] }]\n[bounds]\nvehicle = \"craft/mine.toml\"\n";
    fs::write(bench.0.join("plan.toml"), plan).unwrap();
    let text = SCENARIO.replace("\"hover\"\nduration_s = 0.3", "\"plan.toml\"");
    fs::write(&scenario, &text).unwrap();
    flown(&["campaign", &scenario, "--runs", "1", "--out", &out]);
    // Taken elsewhere, without the files that it was flown from.
    fs::rename(&out, &elsewhere).unwrap();
    for gone in ["craft/mine.toml", "plan.toml", "s.toml"] {
        fs::remove_file(bench.0.join(gone)).unwrap();
    }
    let json = bench.path("again.json");
    flown(&["campaign", "replay", &elsewhere, "--run", "0", "--law", "lee", "--json", &json]);
    let again: serde_json::Value = serde_json::from_slice(&bench.bytes("again.json")).unwrap();
    let rows = String::from_utf8(bench.bytes("elsewhere/rows.csv")).unwrap();
    // The second row is Lee's; its fifth cell is the error, which is the same to the bit.
    let iae_m_s: f64 = rows.lines().nth(2).unwrap().split(',').nth(4).unwrap().parse().unwrap();
    assert_eq!(again["iae_m_s"].as_f64().unwrap(), iae_m_s);
    flown(&["report", &elsewhere, "--without-paper", "--worst", "1"]);
    // Its own copy is the one that counts.
    fs::remove_file(bench.0.join("elsewhere/course-vehicle.toml")).unwrap();
    let refused = quatrack(&["campaign", "replay", &elsewhere, "--run", "0"]);
    let said = String::from_utf8(refused.stderr).unwrap();
    assert!(refused.status.code() == Some(2) && said.contains("course-vehicle.toml"), "{said}");
}

#[test]
fn a_flight_that_is_lost_before_it_is_measured_has_a_picture() {
    let bench = Bench::new("campaign-early");
    let [scenario, out, plot] = ["early.toml", "out", "early.svg"].map(|name| bench.path(name));
    // With half of its weight for thrust at most it falls 5 m in the 2 s of hover before anything is measured.
    let weak = "vehicle = \"crazyflie-2.1\"\ncourse = \"hover\"\nlaw = \"lee\"\n[errors]\nthrust_factor = 0.5\n[vary]\n\
                errors.mass_factor = { uniform = [1.9, 2.0] }\n";
    fs::write(&scenario, weak).unwrap();
    flown(&["campaign", &scenario, "--runs", "1", "--out", &out]);
    let replay = quatrack(&["campaign", "replay", &out, "--run", "0", "--plot", &plot, "--out", &out]);
    let (printed, said) = (String::from_utf8(replay.stdout).unwrap(), String::from_utf8(replay.stderr).unwrap());
    assert_eq!(replay.status.code(), Some(3), "{said}");
    assert!(printed.contains("early.svg") && !printed.contains("no picture"), "{printed}");
    let svg = String::from_utf8(bench.bytes("early.svg")).unwrap();
    // Flight, course and its shadow; 3 errors, 1 tilt, 4 thrusts with 2 limits.
    assert_eq!(svg.matches("<polyline").count(), 3 + 3 + 1 + 4 + 2);
    // It falls out of the axes, which are those of a hover.
    assert!(svg.contains("lee leaves the axes at "), "no note");
    // Its row is the same flight: the eighth cell is when it was lost.
    let rows = String::from_utf8(bench.bytes("out/rows.csv")).unwrap();
    let lost_s: f64 = rows.lines().nth(1).unwrap().split(',').nth(7).unwrap().parse().unwrap();
    assert!((0.5..2.0).contains(&lost_s) && said.contains(&format!("at {lost_s:.2} s")), "{said}{rows}");
    // The log and the page's replay have its way until then: a row each 10 and 20 ms.
    let log = String::from_utf8(bench.bytes("out/flight.csv")).unwrap();
    assert!(log.lines().count() as f64 > 100.0 * lost_s, "{log}");
    flown(&["report", &out, "--without-paper"]);
    let page = String::from_utf8(bench.bytes("out/report.html")).unwrap();
    let flights = page.split("\"rows\":").nth(1).unwrap();
    let rows = flights.split("]]").next().unwrap().matches('[').count();
    assert!(rows as f64 > 50.0 * lost_s, "{rows} rows");
}

#[cfg(unix)]
#[test]
fn a_scenario_is_read_once() {
    use std::io::Write as _;
    use std::process::Stdio;
    let bench = Bench::new("campaign-pipe");
    let arguments = ["campaign", "/dev/stdin", "--runs", "1", "--out", &bench.path("out")];
    let mut command = Command::new(env!("CARGO_BIN_EXE_quatrack"));
    let mut flying = command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    flying.stdin.take().unwrap().write_all(SCENARIO.as_bytes()).unwrap();
    assert!(flying.wait().unwrap().success());
    let [scenario, out] = ["s.toml", "again"].map(|name| bench.path(name));
    flown(&["campaign", &scenario, "--runs", "1", "--out", &out]);
    assert_eq!(bench.bytes("out/rows.csv"), bench.bytes("again/rows.csv"));
}

#[test]
fn a_lost_shard_is_named() {
    let bench = Bench::new("campaign-lost");
    let [scenario, out] = ["s.toml", "out"].map(|name| bench.path(name));
    for shard in ["1/3", "3/3"] {
        flown(&["campaign", &scenario, "--runs", "6", "--shard", shard, "--out", &out]);
    }
    let merged = |named: &str| {
        let refused = quatrack(&["campaign", "merge", &out]);
        let said = String::from_utf8(refused.stderr).unwrap();
        assert!(refused.status.code() == Some(1) && said.lines().count() == 1 && said.contains(named), "{said}");
    };
    merged("shard 2/3 is missing (2 runs)");
    flown(&["campaign", &scenario, "--runs", "6", "--shard", "2/3", "--out", &out]);
    let cut = bench.bytes("out/rows-3-of-3.csv");
    fs::write(bench.0.join("out/rows-3-of-3.csv"), &cut[..cut.len() - 3]).unwrap();
    merged("shard 3/3 ends after 1 of 2 runs");
}

/// Lines of a message; the parser of arguments lists missing ones below it, and a way to help.
fn message(said: &str) -> usize {
    let lines = said.split("\n\n").next().unwrap_or_default().lines();
    lines.filter(|line| !line.starts_with("  --")).count()
}

#[test]
fn inputs_that_cannot_be_flown_are_refused_in_one_line() {
    let bench = Bench::new("campaign-refuses");
    let refused = |name: &str, text: &str, arguments: &[&str], named: &str| {
        fs::write(bench.0.join(name), text).unwrap();
        let (scenario, out) = (bench.path(name), bench.path("out"));
        let output = quatrack(&[&["campaign", &scenario, "--out", &out], arguments].concat());
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), message(&said)), (Some(2), 1), "{name}: {said}");
        assert!(said.contains(named), "{name}: {said}");
        assert!(!bench.0.join("out").exists(), "{name}");
    };
    let ten = ["--runs", "10"];
    let vary = |line: &str| format!("vehicle = \"crazyflie-2.1\"\n[vary]\n{line}\n");
    let wide = "errors.mass_factor = { uniform = [0.4, 1.0] }";
    refused(
        "wide.toml",
        &vary(wide),
        &ten,
        "vary.errors.mass_factor: can draw 0.4: errors.mass_factor = 0.4: must be from 0.5",
    );
    refused("unknown.toml", &vary("errors.mass = { uniform = [1, 2] }"), &ten, "unknown field `mass`");
    refused("kind.toml", &vary("speed_m_s = { gauss = [1, 2] }"), &ten, "vary.speed_m_s.gauss");
    let large = format!("seed = 9223372036854775808\n{SCENARIO}");
    refused("seed.toml", &large, &ten, "seed.toml: seed = 9223372036854775808: must be at most 9223372036854775807");
    refused("law.toml", "vehicle = \"crazyflie-2.1\"\nlaws = [\"mpc\"]\n", &ten, "mpc");
    refused("runs.toml", SCENARIO, &[], "--runs");
    refused("none.toml", SCENARIO, &["--runs", "0"], "--runs");
    refused("shard.toml", SCENARIO, &["--runs", "10", "--shard", "4/3"], "i/n");
    let nothing = quatrack(&["campaign", "summary", &bench.path("")]);
    assert!(nothing.status.code() == Some(2) && String::from_utf8(nothing.stderr).unwrap().contains("campaign.json"));
}
