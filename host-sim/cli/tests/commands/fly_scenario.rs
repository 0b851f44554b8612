//! `quatrack fly` with a scenario, as its user meets it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub(crate) fn quatrack(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_quatrack")).args(arguments).output().expect("the command starts")
}

pub(crate) fn scenario(name: &str, text: &str) -> (PathBuf, String) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join("scenario.toml");
    fs::write(&path, text).unwrap();
    (folder, path.to_str().unwrap().to_owned())
}

fn json(path: &Path) -> serde_json::Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

const WINDY: &str = "vehicle = \"crazyflie-2.1-brushless\"\nspeed_m_s = 1.0\nduration_s = 1.0\nlaw = \"lee\"\nseed = 5\n\
                     [air]\ndrag_per_s = [0.4, 0.4, 0.4]\nwind_m_s = [1.0, 0.0, 0.0]\ngust_rms_m_s = 0.5\n\
                     [noise]\nposition_m = 0.001\n";

#[test]
fn fly_and_compare_give_the_same_figures_for_the_same_scenario() {
    let (folder, path) = scenario("fly-as-compare", WINDY);
    let [flown, table] = ["flown.json", "table.json"].map(|name| folder.join(name));
    let fly = quatrack(&["fly", "--scenario", &path, "--json", flown.to_str().unwrap()]);
    assert!(fly.status.success(), "{}", String::from_utf8_lossy(&fly.stderr));
    let compare = quatrack(&["compare", "--scenario", &path, "--laws", "lee", "--json", table.to_str().unwrap()]);
    assert!(compare.status.success(), "{}", String::from_utf8_lossy(&compare.stderr));
    let (flown, row) = (json(&flown), &json(&table)["rows"][0]);
    for key in ["law", "iae_m_s", "max_error_m"] {
        assert_eq!(flown[key], row[key], "{key}");
    }
    assert!(flown["lost"].is_null() && row["lost"] == false);
    // Six seconds of turbulence with a scale of metres: a few independent squares, so within a factor of two or so.
    let gusts = flown["gust_rms_m_s"].as_array().unwrap();
    assert!((0.15..1.0).contains(&gusts[0].as_f64().unwrap()), "{gusts:?}");
}

#[test]
fn the_log_has_motors_their_limits_wind_and_estimate_and_the_same_bytes_for_the_same_seed() {
    let (folder, path) = scenario("fly-log", WINDY);
    let log = |name: &str, more: &[&str]| {
        let out = folder.join(name);
        let flown = quatrack(&[&["fly", "--scenario", &path, "--out", out.to_str().unwrap()], more].concat());
        assert!(flown.status.success(), "{}", String::from_utf8_lossy(&flown.stderr));
        fs::read_to_string(out.join("flight.csv")).unwrap()
    };
    let first = log("first", &[]);
    assert!(first == log("again", &[]), "the same seed");
    assert!(first == log("said", &["--seed", "5", "--speed-m-s", "1"]), "flags that repeat the file");
    assert!(first != log("other", &["--seed", "6"]), "another seed");

    let mut rows = first.lines();
    let names: Vec<&str> = rows.next().unwrap().split(',').collect();
    let column = |name: &str| names.iter().position(|known| *known == name).expect("a column");
    let rows: Vec<Vec<f64>> = rows.map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    // A row every 10 ms of the second that is measured, both ends included.
    assert_eq!((rows.len(), rows[0].len()), (101, names.len()));
    let mut squares = 0.0;
    for row in &rows {
        for motor in 1..=4 {
            let of = |column_of: &str| row[column(&format!("{column_of}_{motor}_n"))];
            assert!(of("thrust_min") <= of("thrust") && of("thrust") <= of("thrust_max"), "{row:?}");
        }
        squares += (row[column("est_x_m")] - row[column("x_m")]).powi(2);
        // The mean wind with five deviations of the gusts.
        assert!((row[column("wind_x_m_s")] - 1.0).abs() < 2.5, "{row:?}");
    }
    // A deviation of 1 mm over 101 samples: four deviations of their RMS are 4 / sqrt(202) = 28 %.
    let rms_m = (squares / rows.len() as f64).sqrt();
    assert!((rms_m - 0.001).abs() < 0.00028, "{rms_m}");
}

#[test]
fn a_flag_goes_before_the_file_and_can_replace_it() {
    let (folder, path) =
        scenario("fly-flags", "vehicle = \"crazyflie-2.1-brushless\"\ncourse = \"step\"\nstep_m = 0.2\n");
    let figures = |name: &str, arguments: &[&str]| {
        let file = folder.join(name);
        let flown = quatrack(&[&["fly", "--json", file.to_str().unwrap()], arguments].concat());
        assert!(flown.status.success(), "{}", String::from_utf8_lossy(&flown.stderr));
        json(&file)
    };
    let with_flags = ["--scenario", &path, "--course", "hover", "--law", "mellinger", "--duration-s", "2"];
    let by_file = figures("file.json", &[&with_flags[..], &["--mass-factor", "1.05"]].concat());
    let alone =
        ["--vehicle", "crazyflie-2.1-brushless", "--course", "hover", "--law", "mellinger", "--duration-s", "2"];
    let by_flags = figures("flags.json", &[&alone[..], &["--mass-factor", "1.05"]].concat());
    assert_eq!(by_file, by_flags);
    // Vacuum, and the mass that the law believes: nothing moves the craft but rounding.
    let as_designed = figures("exact.json", &alone);
    assert!(as_designed["max_error_m"].as_f64().unwrap() < 1e-6, "{as_designed}");
    assert!(by_flags["max_error_m"].as_f64().unwrap() > 1e-3, "{by_flags}");
}

#[test]
fn a_lost_craft_is_said_with_exit_code_3() {
    // Half as strong as it believes, the craft cannot carry itself.
    let (_, path) = scenario("fly-lost", "vehicle = \"crazyflie-2.1\"\ncourse = \"hover\"\nlaw = \"lee\"\n");
    let flown = quatrack(&["fly", "--scenario", &path, "--mass-factor", "2", "--thrust-factor", "0.5"]);
    let (printed, said) = (String::from_utf8(flown.stdout).unwrap(), String::from_utf8(flown.stderr).unwrap());
    assert_eq!((flown.status.code(), said.lines().count()), (Some(3), 1), "{said}");
    assert!(printed.contains("none: the flight was lost") && said.contains("lee was lost at"), "{printed}{said}");
}

/// Lines of a message; the parser of arguments lists missing ones below it, and a way to help.
pub(crate) fn message(said: &str) -> usize {
    let lines = said.split("\n\n").next().unwrap_or_default().lines();
    lines.filter(|line| !line.starts_with("  --")).count()
}

#[test]
fn inputs_that_cannot_be_flown_are_refused_in_one_line() {
    let (folder, path) = scenario("fly-refuses", "vehicle = \"crazyflie-2.1\"\n");
    let endless = folder.join("endless.toml").to_str().unwrap().to_owned();
    fs::write(&endless, "vehicle = \"crazyflie-2.1\"\n[errors]\nmass_factor = nan\n").unwrap();
    for (arguments, named) in [
        (&["--scenario", &endless][..], &["endless.toml, line 3, `mass_factor = nan`", "finite"][..]),
        (&["--scenario", &path, "--mass-factor", "nan"], &["scenario.toml with flags", "errors.mass_factor = NaN"]),
        (
            &["--vehicle", "crazyflie-2.1", "--wind-m-s", "1,0,0"],
            &["flags: air.wind_m_s = [1.0, 0.0, 0.0]", "--air vehicle"],
        ),
        (&["--vehicle", "crazyflie-2.1", "--told-lag-ms", "300"], &["flags: told.lag_ms = 300: must be from 4 to 126"]),
        (&["--scenario", &path, "--mass-factor", "9"], &["scenario.toml with flags", "errors.mass_factor = 9"][..]),
        (&["--vehicle", "crazyflie-2.1", "--lag-ms", "0.2"], &["flags: errors.lag_ms = 0.2", "1 to 1000"]),
        (&["--vehicle", "crazyflie-2.1", "--wind-m-s", "1,0"], &["--wind-m-s", "3 numbers"]),
        (&["--scenario", &path, "--trajectory", "mild"], &["--trajectory", "--course"]),
        (&["--scenario", &path, "--controller", "lqr-e"], &["--scenario", "--controller"]),
        (&["--controller", "lqr-e", "--trajectory", "mild", "--wind-m-s", "1,0,0"], &["--law"]),
        (&["--controller", "lqr-e"], &["--trajectory"]),
        (&["--wind-m-s", "1,0,0"], &["--scenario", "--vehicle"]),
    ] {
        let refused = quatrack(&[&["fly"], arguments].concat());
        let said = String::from_utf8(refused.stderr).unwrap();
        assert_eq!((refused.status.code(), message(&said)), (Some(2), 1), "{arguments:?}: {said}");
        assert!(refused.stdout.is_empty() && named.iter().all(|name| said.contains(name)), "{arguments:?}: {said}");
    }
}

#[test]
fn a_picture_has_path_errors_tilt_motors_with_their_limits_and_wind() {
    let (folder, path) = scenario("fly-plot", WINDY);
    let picture = folder.join("flight.svg");
    let flown = quatrack(&["fly", "--scenario", &path, "--plot", picture.to_str().unwrap()]);
    assert!(flown.status.success(), "{}", String::from_utf8_lossy(&flown.stderr));
    let svg = fs::read_to_string(picture).unwrap();
    for text in
        ["error (m)", "tilt (deg)", "thrust (N)", "wind (m/s)", "motor 4", "limits", "lee", "course", "time (s)"]
    {
        assert!(svg.contains(&format!(">{text}</text>")), "{text}");
    }
    let (lines, dashed) = (svg.matches("<polyline").count(), |line: &&str| line.contains("stroke-dasharray"));
    // In space: the flight, its course and the course's shadow; then 3 errors, 1 tilt, 4 thrusts with 2 limits, 3 winds.
    assert_eq!(lines, 3 + 3 + 1 + 4 + 2 + 3);
    // Of these the course and the two limits are dashed.
    assert_eq!(svg.lines().filter(|line| line.starts_with("<polyline")).filter(dashed).count(), 3);
    // Without wind there is no panel for it.
    let still = folder.join("still.svg");
    let flown = quatrack(&["fly", "--vehicle", "crazyflie-2.1", "--law", "lee", "--plot", still.to_str().unwrap()]);
    assert!(flown.status.success(), "{}", String::from_utf8_lossy(&flown.stderr));
    assert!(!fs::read_to_string(still).unwrap().contains("wind"));
}

#[test]
fn gains_of_ones_own_fly_the_craft_that_their_design_names() {
    let (folder, _) = scenario("fly-own-gains", "");
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../gains");
    let vehicle = fs::read_to_string(root.join("vehicles/crazyflie-2.1.toml")).unwrap();
    let mass = vehicle.lines().find(|line| line.starts_with("mass_kg")).expect("a mass");
    let name = vehicle.lines().find(|line| line.starts_with("name")).expect("a name");
    let own = vehicle.replace(mass, "mass_kg = 0.030").replace(name, "name = \"own-craft\"");
    fs::write(folder.join("own.toml"), &own).unwrap();
    let design = fs::read_to_string(root.join("cascade-100ms.toml")).unwrap();
    let named = design.lines().find(|line| line.starts_with("vehicle")).expect("a vehicle");
    let path = folder.join("mine.toml");
    fs::write(&path, design.replace(named, "vehicle = \"own.toml\"")).unwrap();

    let (path, own) = (path.to_str().unwrap(), folder.join("own.toml"));
    let hover = |vehicle: &[&str], file: &Path| {
        let fly = ["fly", "--gains", path, "--course", "hover", "--json", file.to_str().unwrap()];
        quatrack(&[&fly, vehicle].concat())
    };
    // On its own craft in vacuum at hover, told the true mass, it has nothing to do but to learn that there is no air.
    let files = ["design.json", "vehicle.json"].map(|name| folder.join(name));
    for (file, vehicle) in files.iter().zip([&[][..], &["--vehicle", own.to_str().unwrap()]]) {
        let flown = hover(vehicle, file);
        assert!(flown.status.success(), "{}", String::from_utf8_lossy(&flown.stderr));
        let figures = json(file);
        assert!(figures["law"] == "mine" && figures["max_error_m"].as_f64().unwrap() < 1e-4, "{figures}");
    }
    assert_eq!(json(&files[0]), json(&files[1]), "the design names its craft");

    let other = hover(&["--vehicle", "crazyflie-2.1"], &folder.join("other.json"));
    let said = String::from_utf8(other.stderr).unwrap();
    assert_eq!((other.status.code(), said.lines().count()), (Some(2), 1), "{said}");
    assert!(said.contains("made for own-craft") && said.contains("crazyflie-2.1"), "{said}");
}

#[test]
fn the_example_of_the_documentation_flies_as_it_is_printed() {
    let docs = include_str!("../../../../docs/scenarios.md");
    let example = docs.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("an example");
    let (_, path) = scenario("fly-documented", example);
    let flown = quatrack(&["fly", "--scenario", &path]);
    let printed = String::from_utf8(flown.stdout).unwrap();
    assert!(
        flown.status.success() && printed.contains("eight at 2.1 m/s"),
        "{}",
        String::from_utf8_lossy(&flown.stderr)
    );
    // Its battery is for another vehicle: all of it is a scenario's, too.
    let with_battery = example
        .replace("\"crazyflie-2.1-brushless\"", "\"crazyflie-2.1\"")
        .replace("mass_kg = 0.045 ", "mass_kg = 0.029 ")
        .replace("# [battery]", "[battery]")
        .replace("# charge", "charge");
    assert!(with_battery.contains("\n[battery]") && with_battery.contains("\ncharge = 1.0"));
    let (_, path) = scenario("fly-documented-battery", &with_battery);
    let flown = quatrack(&["fly", "--scenario", &path, "--law", "mellinger"]);
    assert!(flown.status.success(), "{}", String::from_utf8_lossy(&flown.stderr));
}

#[test]
fn standard_output_is_the_json_alone_where_it_is_written_there() {
    let flown =
        quatrack(&["fly", "--vehicle", "crazyflie-2.1", "--course", "hover", "--duration-s", "1", "--json", "-"]);
    let figures: serde_json::Value = serde_json::from_slice(&flown.stdout).expect("JSON and nothing else");
    assert_eq!(figures["schema"], "quatrack/fly/1");
    let said = String::from_utf8(flown.stderr).unwrap();
    assert!(flown.status.success() && said.contains("largest position error") && said.contains("wrote -"), "{said}");
    // A folder of that name is a folder.
    let (folder, path) = scenario("fly-dash", "vehicle = \"crazyflie-2.1\"\ncourse = \"hover\"\nduration_s = 0.2\n");
    let mut command = Command::new(env!("CARGO_BIN_EXE_quatrack"));
    let flown = command.args(["fly", "--scenario", &path, "--out", "-"]).current_dir(&folder).output().unwrap();
    let printed = String::from_utf8(flown.stdout).unwrap();
    assert!(printed.contains("largest position error") && folder.join("-/flight.csv").is_file(), "{printed}");
}

#[test]
fn robustness_and_crazyflie_fly_the_scenario_too() {
    let text = "vehicle = \"crazyflie-2.1-brushless\"\ncourse = \"hover\"\nduration_s = 1.0\n[air]\nwind_m_s = [1.0, 0.0, 0.0]\n\
                drag_per_s = [0.4, 0.4, 0.4]\n";
    let (folder, path) = scenario("fly-others", text);
    let file = |name: &str| folder.join(name);
    let run = |arguments: &[&str], name: &str| {
        let done = quatrack(&[arguments, &["--scenario", &path, "--json", file(name).to_str().unwrap()]].concat());
        assert!(done.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&done.stderr));
        json(&file(name))
    };
    let alone = run(&["fly"], "fly.json");
    let object = run(&["fly", "--law", "crazyflie"], "object.json");
    assert_eq!(run(&["crazyflie"], "crazyflie.json"), object);
    let table = run(&["robustness", "--law", "quatrack"], "robustness.json");
    let rows = table["rows"].as_array().unwrap();
    // Ten cases but for the fast eight, which a hover has not.
    assert_eq!(rows.len(), 9);
    assert_eq!((&rows[0]["case"], &rows[0]["iae_m_s"]), (&"nominal".into(), &alone["iae_m_s"]));
    assert_ne!(rows[1]["iae_m_s"], alone["iae_m_s"]);
}
