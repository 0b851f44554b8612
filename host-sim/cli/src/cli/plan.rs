//! `quatrack plan`: a plan file in; a summary and, if asked for, the curve's control points out.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use indicatif::ProgressBar;
use quatrack_plan::plan::{
    Bounds, Budget, FlightPlan, Limit, Overrides, PlanError, PlannedFlight, PlannedLeg, Realised, stored,
};
use quatrack_plan::trajectory::polynomial::csv;
use quatrack_plan::trajectory::{file, on_board};
use serde::Serialize;

use super::transform::TransformArgs;
use super::vehicle::VehicleChoice;
use super::{Failure, output};

/// Plan a flight through waypoints within bounds.
///
/// A plan is TOML (docs/plan.md), or rows of waypoints as CSV: t,x,y,z or t,x,y,z,yaw, or x,y,z without times. Without
/// times, the least within the bounds are found. Bounds on the command line go before those of the file.
///
/// Exit code 1: no curve meets the plan, and the least remedies are printed. 2: a file that cannot be used.
///
/// Examples:
///   quatrack plan plans/mild.toml --json mild.json
///   quatrack plan waypoints.csv --speed-max-m-s 1.5 --acceleration-max-m-s2 3 --toml planned.toml
///   quatrack plan square.toml --vehicle crazyflie-2.1 --reverse --start 0,0,1 --csv square.csv
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Args {
    /// Plan (TOML; plans/mild.toml and plans/aggressive.toml show the keys), or waypoints (CSV).
    #[arg(value_name = "FILE")]
    plan: PathBuf,
    /// Write degree, duration and control points as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write degree, duration and control points as TOML.
    #[arg(long, value_name = "FILE")]
    toml: Option<PathBuf>,
    /// Write the pieces in the uav_trajectories form.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write the pieces that a board stores, as a Rust constant with the name of the plan file.
    #[arg(long, value_name = "FILE")]
    rust: Option<PathBuf>,
    /// End the search after this time, s.
    #[arg(long, value_name = "X", default_value_t = TIME_LIMIT_S, allow_negative_numbers = true)]
    time_limit_s: f64,
    /// Length of the flight in time, s.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    duration_s: Option<f64>,
    /// Take thrust and rates from a vehicle: a built-in name, or a TOML file.
    #[arg(long, value_name = "VEHICLE")]
    vehicle: Option<VehicleChoice>,
    /// Highest speed, m/s.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    speed_max_m_s: Option<f64>,
    /// Largest acceleration, m/s^2.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    acceleration_max_m_s2: Option<f64>,
    /// Largest tilt, degrees.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    tilt_max_deg: Option<f64>,
    #[command(flatten)]
    transform: TransformArgs,
}

/// How long a plan is looked for unless it is said, s.
const TIME_LIMIT_S: f64 = 60.0;

/// The figures of a curve in the files.
#[derive(Serialize)]
struct Curve {
    degree: usize,
    duration_s: f64,
    control_points_m: Vec<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    heading_control_points_rad: Option<Vec<f64>>,
}

/// A flight of several.
#[derive(Serialize)]
struct Curves {
    curves: Vec<Curve>,
}

/// Plans the flight of a file.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let path = args.plan.display();
    let text = file::read_text(&args.plan).map_err(Failure::input)?;
    let over = Overrides {
        bounds: args.bounds()?,
        vehicle: args.vehicle.as_ref().map(|choice| &choice.0),
        duration_s: args.duration_s,
        transform: args.transform.transform()?,
        vehicles: None,
    };
    let (plan, flight) = planned(&args.plan, &text, over, args.time_limit_s)?;
    let curves: Vec<Curve> = flight.legs.iter().map(of_leg).collect();
    if let Some(json) = &args.json {
        match <[Curve; 1]>::try_from(curves) {
            Ok([curve]) => output::write_json(json, &output::Named::new("plan", &curve))?,
            Err(curves) => output::write_json(json, &output::Named::new("plan", &Curves { curves }))?,
        }
    }
    if let Some(toml) = &args.toml {
        output::write(toml, as_toml(&flight).as_bytes())?;
    }
    if args.csv.is_some() || args.rust.is_some() {
        let pieces = flight.pieces().map_err(Failure::verdict)?;
        if let Some(path) = &args.csv {
            output::write(path, csv::write(&pieces).as_bytes())?;
        }
        if let Some(rust) = &args.rust {
            let name = args.plan.file_stem().unwrap_or_default().to_string_lossy().to_uppercase();
            let name = name.replace(|c: char| !c.is_ascii_alphanumeric(), "_");
            output::write(rust, stored::rust_source(&name, &on_board::pieces(&pieces)).as_bytes())?;
        }
    }
    let mut text = format!("{path}\n{}", summary(&plan, &flight));
    for written in [&args.json, &args.toml, &args.csv, &args.rust].into_iter().flatten() {
        text += &format!("wrote {}\n", written.display());
    }
    output::print(&text)
}

impl Args {
    fn bounds(&self) -> Result<Bounds, Failure> {
        let positive = |flag: &str, value: Option<f64>, most: f64| match value {
            Some(value) if !(value > 0.0 && value <= most) => {
                Err(Failure::input(format!("{flag} {value}: must be above 0, up to {most}")))
            }
            value => Ok(value),
        };
        positive("--duration-s", self.duration_s, 1e5)?;
        positive("--time-limit-s", Some(self.time_limit_s), 1e6)?;
        Ok(Bounds {
            speed_max_m_s: positive("--speed-max-m-s", self.speed_max_m_s, 1e6)?,
            acceleration_max_m_s2: positive("--acceleration-max-m-s2", self.acceleration_max_m_s2, 1e6)?,
            tilt_max_rad: positive("--tilt-max-deg", self.tilt_max_deg, 89.99)?.map(f64::to_radians),
            ..Bounds::default()
        })
    }
}

/// Plans the text of a file, with a word on how it goes where somebody watches.
pub(super) fn planned(
    path: &Path,
    text: &str,
    over: Overrides<'_>,
    limit_s: f64,
) -> Result<(FlightPlan, PlannedFlight), Failure> {
    let folder = path.parent().unwrap_or(Path::new(""));
    // A vehicle's file is beside the plan that names it.
    let find = |name: &str| {
        let here = folder.join(name);
        let choice = if here.is_file() { here.to_string_lossy().parse() } else { name.parse() };
        choice.map(|VehicleChoice(vehicle)| vehicle)
    };
    let bar = ProgressBar::new_spinner();
    let progress = |stage: &str| {
        bar.enable_steady_tick(Duration::from_millis(200));
        bar.set_message(stage.to_owned());
    };
    let budget = Budget::of_seconds(limit_s, &progress);
    let over = Overrides { vehicles: Some(&find), ..over };
    let planned = FlightPlan::from_toml(text, &over, &budget).and_then(|plan| {
        let flight = plan.solve(&budget)?;
        Ok((plan, flight))
    });
    bar.finish_and_clear();
    planned.map_err(|error| failed(path, &error))
}

/// The same with nothing over the file's keys, in the usual time.
pub(super) fn of_text(path: &Path, text: &str) -> Result<PlannedFlight, Failure> {
    planned(path, text, Overrides::default(), TIME_LIMIT_S).map(|(_, flight)| flight)
}

/// How a planning error ends the command: 1 where the plan cannot be met, 2 where the file cannot be used.
pub(super) fn failed(path: &Path, error: &PlanError) -> Failure {
    let line = format!("{}: {error}", path.display());
    match error {
        PlanError::TimeLimit { .. } => Failure::verdict(format!("{line} (`quatrack plan` has --time-limit-s)")),
        PlanError::Infeasible(_)
        | PlanError::NotConverged(_)
        | PlanError::HeadingRate { .. }
        | PlanError::NoTimes { .. } => Failure::verdict(line),
        _ => Failure::input(line),
    }
}

fn of_leg(leg: &PlannedLeg) -> Curve {
    Curve {
        degree: leg.curve.degree(),
        duration_s: leg.plan.duration_s(),
        control_points_m: leg.curve.control_points_m().iter().map(|point| [point.x, point.y, point.z]).collect(),
        heading_control_points_rad: leg.curve.heading_control_points_rad().map(<[f64]>::to_vec),
    }
}

/// One control point a line; Rust's shortest decimals read back to the same bits.
fn as_toml(flight: &PlannedFlight) -> String {
    let several = flight.legs.len() > 1;
    let table = |leg: &PlannedLeg| {
        let curve = of_leg(leg);
        let points = curve.control_points_m.iter().map(|[x, y, z]| format!("  [{x:?}, {y:?}, {z:?}],\n"));
        let heading = curve.heading_control_points_rad.map_or_else(String::new, |heading| {
            let lines: String = heading.iter().map(|value| format!("  {value:?},\n")).collect();
            format!("heading_control_points_rad = [\n{lines}]\n")
        });
        format!(
            "{}degree = {}\nduration_s = {:?}\ncontrol_points_m = [\n{}]\n{heading}",
            if several { "[[curves]]\n" } else { "" },
            curve.degree,
            curve.duration_s,
            points.collect::<String>()
        )
    };
    flight.legs.iter().map(table).collect::<Vec<_>>().join("\n")
}

fn summary(plan: &FlightPlan, flight: &PlannedFlight) -> String {
    let mut text: String = plan.notes().iter().map(|note| format!("note: {note}\n")).collect();
    if plan.has_free_times() {
        let _ = writeln!(text, "note: the times are the least within the bounds, {:.4} s in all", flight.duration_s());
    }
    for (leg, number) in flight.legs.iter().zip(1..) {
        if flight.legs.len() > 1 {
            let _ = writeln!(text, "{}curve {number} of {}", if number > 1 { "\n" } else { "" }, flight.legs.len());
        }
        text += &leg_summary(leg);
        if let Some(detour) = &leg.detour {
            let cause = detour.waypoint.map_or_else(String::new, |number| {
                format!("; without waypoint {number} it is shortest: give that one another time or more tolerance_m")
            });
            let _ = writeln!(
                text,
                "\nwarning: the curve is {:.1} times as long as the straight lines through its waypoints{cause}",
                detour.times
            );
        }
    }
    text
}

fn leg_summary(PlannedLeg { plan, curve, realised, .. }: &PlannedLeg) -> String {
    let sampled = &realised.sampled;
    let bounds = plan.bounds();
    let mut text = format!(
        "degree {}, {} spans, {} control points, {} s, {:.3} m long\n\n",
        plan.degree(),
        plan.spans(),
        curve.control_points_m().len(),
        // A duration that was found has more digits than anybody reads.
        (plan.duration_s() * 1e6).round() / 1e6,
        sampled.length_m
    );
    line(&mut text, ["", "sampled", "control points", "bound"]);
    let one = 1.0;
    let deg = 1_f64.to_degrees();
    let rows = [
        ("speed, largest, m/s", sampled.speed_max_m_s, Some(Limit::Speed), bounds.speed_max_m_s, one),
        (
            "acceleration, largest, m/s^2",
            sampled.acceleration_max_m_s2,
            bounds.acceleration_max_m_s2.map(|_| Limit::Acceleration),
            bounds.acceleration_max_m_s2,
            one,
        ),
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
        let proved = limit.and_then(|limit| proved(realised, limit));
        let cell = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{:.4}", value * unit));
        // A bound is printed as written, but for the rounding of degrees.
        let asked = bound.map_or("-".to_owned(), |bound| format!("{}", (bound * unit * 1e9).round() / 1e9));
        line(&mut text, [name, &cell(Some(sampled)), &cell(proved), &asked]);
    }
    text.push('\n');
    line(&mut text, ["waypoint", "time, s", "missed by, m", "tolerance, m"]);
    for ((waypoint, miss), number) in plan.waypoints().iter().zip(&realised.misses_m).zip(plan.first_number()..) {
        let time = format!("{:.4}", waypoint.time_s);
        // The residual of an equality is rounding, and differs between machines.
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
            let [plan, json, toml] =
                ["plan.toml", "curve.json", "curve.toml"].map(|name| at(name).display().to_string());
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
        let [plan, nowhere] =
            ["plan.toml", "no/such/folder.json"].map(|name| folder.0.join(name).display().to_string());
        let nowhere = arguments(&[&plan, "--json", &nowhere]);
        assert_eq!(run(&nowhere).unwrap_err().exit_code, 2);
    }
}
