//! `quatrack plan`: a plan file in; a summary and, if asked for, the curve's control points out.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use quatrack_plan::plan::{Limit, Plan, PlanError, Realised, stored};
use quatrack_plan::trajectory::bspline::BSpline;
use quatrack_plan::trajectory::on_board;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use serde::Serialize;

use super::{Failure, output};

/// Plan a flight through waypoints within bounds.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Plan file in TOML; plans/mild.toml and plans/aggressive.toml show the keys.
    #[arg(value_name = "FILE.toml")]
    plan: PathBuf,
    /// Write degree, duration and control points as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write degree, duration and control points as TOML.
    #[arg(long, value_name = "FILE")]
    toml: Option<PathBuf>,
    /// Write the pieces that a board stores, as a Rust constant with the name of the plan file.
    #[arg(long, value_name = "FILE")]
    rust: Option<PathBuf>,
}

/// What the files hold.
#[derive(Serialize)]
struct Curve {
    degree: usize,
    duration_s: f64,
    control_points_m: Vec<[f64; 3]>,
}

/// Plans the flight of a file.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let path = args.plan.display();
    let text = fs::read_to_string(&args.plan)
        .map_err(|error| Failure::input(format!("{path}: cannot read this plan file ({error})")))?;
    let plan = Plan::from_toml(&text).map_err(|error| Failure::input(format!("{path}: {error}")))?;
    let curve = plan.solve().map_err(|error| failed(&args.plan, &error))?;
    let contents = Curve {
        degree: curve.degree(),
        duration_s: plan.duration_s(),
        control_points_m: curve.control_points_m().iter().map(|point| [point.x, point.y, point.z]).collect(),
    };
    if let Some(json) = &args.json {
        output::write_json(json, &output::Named::new("plan", &contents))?;
    }
    if let Some(toml) = &args.toml {
        output::write(toml, as_toml(&contents).as_bytes())?;
    }
    if let Some(rust) = &args.rust {
        let pieces = PiecewisePolynomial::from_bspline(&curve).map_err(Failure::verdict)?;
        let name = args.plan.file_stem().unwrap_or_default().to_string_lossy().to_uppercase();
        let name = name.replace(|c: char| !c.is_ascii_alphanumeric(), "_");
        output::write(rust, stored::rust_source(&name, &on_board::pieces(&pieces)).as_bytes())?;
    }
    let mut text = format!("{path}\n{}", summary(&plan, &curve));
    for written in [&args.json, &args.toml, &args.rust].into_iter().flatten() {
        text += &format!("wrote {}\n", written.display());
    }
    output::print(&text)
}

/// How a planning error ends the command: 1 where the plan cannot be met, 2 where the file cannot be used.
pub(super) fn failed(path: &Path, error: &PlanError) -> Failure {
    let line = format!("{}: {error}", path.display());
    match error {
        PlanError::Infeasible(_) | PlanError::NotConverged(_) => Failure::verdict(line),
        _ => Failure::input(line),
    }
}

/// One control point a line; Rust's shortest decimals read back to the same bits.
fn as_toml(curve: &Curve) -> String {
    let points = curve.control_points_m.iter().map(|[x, y, z]| format!("  [{x:?}, {y:?}, {z:?}],\n"));
    format!(
        "degree = {}\nduration_s = {:?}\ncontrol_points_m = [\n{}]\n",
        curve.degree,
        curve.duration_s,
        points.collect::<String>()
    )
}

fn summary(plan: &Plan, curve: &BSpline) -> String {
    let realised = plan.realised(curve);
    let sampled = &realised.sampled;
    let bounds = plan.bounds();
    let mut text = format!(
        "degree {}, {} spans, {} control points, {} s, {:.3} m long\n\n",
        plan.degree(),
        plan.spans(),
        curve.control_points_m().len(),
        plan.duration_s(),
        sampled.length_m
    );
    line(&mut text, ["", "sampled", "control points", "bound"]);
    let one = 1.0;
    let deg = 1_f64.to_degrees();
    let rows = [
        ("speed, largest, m/s", sampled.speed_max_m_s, Some(Limit::Speed), bounds.speed_max_m_s, one),
        ("acceleration, largest, m/s^2", sampled.acceleration_max_m_s2, None, None, one),
        ("tilt, largest, deg", sampled.tilt_max_rad, Some(Limit::Tilt), bounds.tilt_max_rad, deg),
        ("thrust, least, m/s^2", sampled.thrust_min_m_s2, Some(Limit::ThrustMin), bounds.thrust_min_m_s2, one),
        ("thrust, largest, m/s^2", sampled.thrust_max_m_s2, Some(Limit::ThrustMax), bounds.thrust_max_m_s2, one),
        (
            "turn of the thrust, deg/s",
            sampled.turn_rate_max_rad_s,
            Some(Limit::BodyRate),
            bounds.body_rate_max_rad_s,
            deg,
        ),
        ("body rate, largest, deg/s", sampled.body_rate_max_rad_s, None, None, deg),
    ];
    for (name, sampled, limit, bound, unit) in rows {
        let proved = limit.and_then(|limit| proved(&realised, limit));
        let cell = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{:.4}", value * unit));
        // A bound is what was asked for: printed as written, but for the rounding of degrees.
        let asked = bound.map_or("-".to_owned(), |bound| format!("{}", (bound * unit * 1e9).round() / 1e9));
        line(&mut text, [name, &cell(Some(sampled)), &cell(proved), &asked]);
    }
    text.push('\n');
    line(&mut text, ["waypoint", "time, s", "missed by, m", "tolerance, m"]);
    for ((waypoint, miss), number) in plan.waypoints().iter().zip(&realised.misses_m).zip(1..) {
        let time = format!("{:.4}", waypoint.time_s);
        // What is left of an equality is rounding, and differs between machines.
        let miss = format!("{:.6}", (miss * 1e6).round() / 1e6);
        let tolerance = if waypoint.tolerance_m == 0.0 { "exact".to_owned() } else { waypoint.tolerance_m.to_string() };
        line(&mut text, [&number.to_string(), &time, &miss, &tolerance]);
    }
    text
}

/// Largest (or least) value of a limit that the control points prove for all t.
fn proved(realised: &Realised, limit: Limit) -> Option<f64> {
    realised.proved.iter().find(|(of, _)| *of == limit).map(|(_, value)| *value)
}

fn line(text: &mut String, [name, a, b, c]: [&str; 4]) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{name:<30} {a:>10} {b:>15} {c:>13}");
}

#[cfg(test)]
mod tests {
    use super::*;
    use quatrack_plan::plan::paper;

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
            run(&Args { plan: at("plan.toml"), json: Some(at("curve.json")), toml: Some(at("curve.toml")), rust: None })
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
        assert_eq!(keys, ["control_points_m", "degree", "duration_s"]);
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
    fn summary_shows_what_is_flown_beside_its_bounds() {
        let plan = paper::mild().unwrap();
        let text = summary(&plan, &plan.solve().unwrap());
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
    fn what_cannot_be_used_exits_2_with_the_files_name() {
        let folder = Folder::new("unusable");
        for plan in ["", "degree = ", "degree = 5\nspan = 3\n"] {
            let failure = folder.run(plan).unwrap_err();
            assert_eq!(failure.exit_code, 2);
            assert!(failure.line.contains("plan.toml: ") && !failure.line.contains('\n'), "{}", failure.line);
        }
        let absent = Args { plan: folder.0.join("absent.toml"), json: None, toml: None, rust: None };
        let failure = run(&absent).unwrap_err();
        assert_eq!(failure.exit_code, 2);
        assert!(failure.line.contains("absent.toml: cannot read this plan file"), "{}", failure.line);
        fs::write(folder.0.join("plan.toml"), paper::AGGRESSIVE_TOML).unwrap();
        let nowhere = Args {
            plan: folder.0.join("plan.toml"),
            json: Some(folder.0.join("no/such/folder.json")),
            toml: None,
            rust: None,
        };
        assert_eq!(run(&nowhere).unwrap_err().exit_code, 2);
    }
}
