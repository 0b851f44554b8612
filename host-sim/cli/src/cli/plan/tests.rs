//! The command on the paper's plans: its two files, its summary, and its exit codes.

use std::fs;

use super::*;
use quatrack_plan::plan::paper;

#[derive(clap::Parser)]
struct Whole {
    #[command(flatten)]
    args: Args,
}

/// The arguments of the command as they are typed.
fn arguments(typed: &[&str]) -> Args {
    use clap::Parser as _;
    Whole::parse_from([&["plan"], typed].concat()).args
}

/// A folder of its own for a test, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("quatrack-plan-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// Writes a plan file and runs the command on it with both outputs.
    fn run(&self, plan: &str) -> Result<(), Failure> {
        let at = |name: &str| self.0.join(name);
        fs::write(at("plan.toml"), plan).unwrap();
        let [plan, json, toml] = ["plan.toml", "curve.json", "curve.toml"].map(|name| at(name).display().to_string());
        run(&arguments(&[&plan, "--json", &json, "--toml", &toml]))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn both_files_hold_the_curve_to_the_bit() {
    let folder = Folder::new("files");
    folder.run(paper::AGGRESSIVE_TOML).unwrap();
    let curve = paper::aggressive().unwrap().solve().unwrap();
    let json = fs::read_to_string(folder.0.join("curve.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let mut keys: Vec<_> = json.as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    assert_eq!(keys, ["control_points_m", "degree", "duration_s", "schema"]);
    assert_eq!((json["degree"].as_u64(), json["duration_s"].as_f64()), (Some(5), Some(12.0)));
    let toml = fs::read_to_string(folder.0.join("curve.toml")).unwrap();
    let toml: toml::Table = toml.parse().unwrap();
    assert_eq!((toml["degree"].as_integer(), toml["duration_s"].as_float()), (Some(5), Some(12.0)));
    assert_eq!(toml.len(), 3);
    assert_eq!(json["control_points_m"].as_array().unwrap().len(), 43);
    assert_eq!(toml["control_points_m"].as_array().unwrap().len(), 43);
    for (j, point) in curve.control_points_m().iter().enumerate() {
        for axis in 0..3 {
            // serde_json reads decimals to the nearest double only up to one rounding; TOML exactly.
            let (json, toml) = (&json["control_points_m"][j][axis], &toml["control_points_m"][j][axis]);
            assert!((json.as_f64().unwrap() - point[axis]).abs() <= f64::EPSILON * point[axis].abs());
            assert_eq!(toml.as_float(), Some(point[axis]));
        }
    }
}

#[test]
fn summary_shows_the_flown_extremes_beside_their_bounds() {
    let (plan, flight) = planned(Path::new("mild"), paper::MILD_TOML, Overrides::default(), 60.0).unwrap();
    let text = summary(&plan, &flight);
    let row = |name: &str| -> Vec<String> {
        let line = text.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("{name}:\n{text}"));
        line[name.len()..].split_whitespace().map(str::to_owned).collect()
    };
    assert!(text.starts_with("degree 5, 36 spans, 41 control points, 30 s, 9.731 m long\n"), "{text}");
    assert_eq!(row("speed, largest, m/s"), ["0.4932", "0.5000", "0.5"]);
    assert_eq!(row("tilt, largest, deg")[1..], ["1.7500", "1.75"]);
    assert_eq!(row("thrust, least, m/s^2")[1..], ["9.7000", "9.7"]);
    assert_eq!(row("acceleration, largest, m/s^2")[1..], ["-", "-"]);
    assert_eq!(row("2 "), ["4.5000", "0.050000", "0.05"]);
    assert_eq!(row("10 "), ["30.0000", "0.000000", "exact"]);
}

#[test]
fn an_impossible_plan_exits_1_and_writes_nothing() {
    let folder = Folder::new("impossible");
    let failure = folder.run(&paper::MILD_TOML.replace("speed_max_m_s = 0.5", "speed_max_m_s = 0.2")).unwrap_err();
    assert_eq!(failure.exit_code, 1);
    assert!(failure.line.contains("plan.toml: no curve meets the plan: speed_max_m_s = 0.2"), "{}", failure.line);
    assert!(!folder.0.join("curve.json").exists() && !folder.0.join("curve.toml").exists());
}

#[test]
fn a_plan_that_cannot_be_used_exits_2_with_the_files_name() {
    let folder = Folder::new("unusable");
    for plan in ["", "degree = ", "degree = 5\nspan = 3\n"] {
        let failure = folder.run(plan).unwrap_err();
        assert_eq!(failure.exit_code, 2);
        assert!(failure.line.contains("plan.toml: ") && !failure.line.contains('\n'), "{}", failure.line);
    }
    let absent = arguments(&[&folder.0.join("absent.toml").display().to_string()]);
    let failure = run(&absent).unwrap_err();
    assert_eq!(failure.exit_code, 2);
    assert!(failure.line.contains("absent.toml: cannot be read"), "{}", failure.line);
    fs::write(folder.0.join("plan.toml"), paper::AGGRESSIVE_TOML).unwrap();
    let [plan, nowhere] = ["plan.toml", "no/such/folder.json"].map(|name| folder.0.join(name).display().to_string());
    let nowhere = arguments(&[&plan, "--json", &nowhere]);
    assert_eq!(run(&nowhere).unwrap_err().exit_code, 2);
}
