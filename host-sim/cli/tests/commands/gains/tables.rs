//! Tables and designs shown, listed and flown.

use std::fs;
use std::path::Path;

use quatrack::Trajectory;
use quatrack::gains::table::{GainTable, ScheduleRows, TABLE_BYTES_MAX};
use quatrack_plan::trajectory::file::{self, TrajectoryFile};
use quatrack_plan::trajectory::on_board;

use super::{GAINS, assert_done, assert_refused, folder, quatrack, stdout};

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
    assert_refused(&quatrack(&heavy), 2, &[&table, "within 20 % of the vehicle's 0.0393 kg"]);
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
