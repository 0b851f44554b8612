//! `quatrack identify`, as its user meets it: a simulated flight of a known craft, its log, and its figures back.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn quatrack(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_quatrack")).args(arguments).output().expect("the command starts")
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn json(path: &Path) -> serde_json::Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// A Crazyflie 2.1 of 27 g in air, through the filter, with noise as on a real one.
const KNOWN: &str = "vehicle = \"crazyflie-2.1\"\nestimator = \"kalman\"\nseed = 3\nspeed_m_s = 2.0\nduration_s = 40.0\n\
                     [air]\ndrag_per_s = [0.39, 0.43, 0.3]\nmoment_n_m_per_m_s = [3.8e-4, 4.3e-4]\ngust_rms_m_s = 0.05\n\
                     [errors]\nlag_ms = 67.0\ndelay_ms = 5.0\nmass_factor = 0.931\n\
                     [noise]\ngyro_rad_s = 0.01\naccelerometer_m_s2 = 0.1\nposition_m = 0.002\n[told]\nlag_ms = 67.0\n";

fn flown(folder: &Path) -> String {
    let [scenario, log] = ["scenario.toml", "log.csv"].map(|name| folder.join(name).to_str().unwrap().to_owned());
    fs::write(&scenario, KNOWN).unwrap();
    let fly = quatrack(&["fly", "--scenario", &scenario, "--log", &log]);
    assert!(fly.status.success(), "{}", String::from_utf8_lossy(&fly.stderr));
    log
}

#[test]
fn a_simulated_craft_is_known_again_and_designs_take_it() {
    let folder = folder("identify");
    let log = flown(&folder);
    let [out, figures, plots] =
        ["craft.toml", "figures.json", "plots"].map(|name| folder.join(name).to_str().unwrap().to_owned());
    let told = quatrack(&["identify", &log, "--mass-kg", "0.027", "--out", &out, "--json", &figures, "--plot", &plots]);
    assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
    let json = json(Path::new(&figures));
    assert_eq!(json["schema"], "quatrack/identify/1");
    // An eight is smooth: the accelerometer tells the drag, whose truth is over the mass of the file, 29 g; the rest roughly.
    let mass_ratio = 0.029 / 0.027;
    for (name, truth, share) in [
        ("drag_x_per_s", 0.39 * mass_ratio, 0.1),
        ("drag_y_per_s", 0.43 * mass_ratio, 0.1),
        ("moment_x_n_m_per_m_s", 3.8e-4, 0.25),
        ("moment_y_n_m_per_m_s", 4.3e-4, 0.25),
    ] {
        let figure = &json["figures"][name];
        let of = |key: &str| figure[key].as_f64().unwrap_or_else(|| panic!("{name}: {figure}"));
        assert!((of("value") / truth - 1.0).abs() < share, "{name}: {figure} for {truth}");
        assert!(of("low") <= of("value") && of("value") <= of("high"));
    }
    let errors = |way: &str, key: &str| json["prediction"][way][key].as_f64().unwrap();
    for key in ["position_m", "body_rate_rad_s"] {
        assert!(errors("ours", key) < errors("no_angular_acceleration", key), "{key}");
    }
    for name in ["prediction", "ahead", "residuals", "lag"] {
        assert!(
            fs::read(Path::new(&plots).join(name).with_extension("png")).unwrap().starts_with(b"\x89PNG"),
            "{name}"
        );
    }
    // The vehicle file is one: it flies, and a scenario reads its air.
    let fly = quatrack(&["fly", "--vehicle", &out, "--air", "vehicle", "--speed-m-s", "1", "--duration-s", "2"]);
    assert!(fly.status.success(), "{}", String::from_utf8_lossy(&fly.stderr));
}

#[test]
fn a_wrong_unit_is_named_and_a_wrong_column_is_refused() {
    let folder = folder("identify-units");
    let log = flown(&folder);
    let text = include_str!("../../../identify/src/log/maps/cflib.toml");
    let map = folder.join("map.toml").to_str().unwrap().to_owned();
    fs::write(&map, text.replace("\"deg/s\"", "\"rad/s\"").replace("form = \"xyzw\"", "form = \"wxyz\"")).unwrap();
    let told = quatrack(&["identify", &log, "--columns", &map, "--mass-kg", "0.027"]);
    let said = String::from_utf8_lossy(&told.stdout).into_owned();
    assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
    assert!(said.contains("its columns are in deg/s, not in rad/s as the map has it"), "{said}");
    assert!(said.contains("the quaternion is scalar last"), "{said}");
    fs::write(&map, text.replace("gyro.x", "gyro.a")).unwrap();
    let told = quatrack(&["identify", &log, "--columns", &map]);
    assert_eq!(told.status.code(), Some(2));
    let said = String::from_utf8_lossy(&told.stderr);
    assert!(said.contains("no column \"gyro.a\" for the gyroscope") && said.lines().count() == 1, "{said}");
}

/// What `identify` writes of a craft whose figures are the file's own: lag, thrust per mass, inertia about x and y, delay and air.
const INTERVALS: [(&str, f64, f64); 9] = [
    ("lag_ms", 60.0, 74.0),
    // Over 4 x 0.124 N / 27 g = 18.37: 8 % less is 8.7 % more mass, 6 % more is 5.7 % less.
    ("thrust_per_mass_m_s2", 0.92 * 18.370_37, 1.06 * 18.370_37),
    ("inertia_x_kg_m2", 0.9 * 16.571_710e-6, 1.05 * 16.571_710e-6),
    ("inertia_y_kg_m2", 0.95 * 16.655_602e-6, 1.12 * 16.655_602e-6),
    ("delay_ms", -1.0, 8.0),
    ("drag_x_per_s", 0.36, 0.42),
    ("drag_y_per_s", 0.37, 0.43),
    ("moment_x_n_m_per_m_s", 3.5e-4, 4.1e-4),
    ("moment_y_n_m_per_m_s", 4.0e-4, 4.6e-4),
];

const BY_INTERVALS: &str = "description = \"A craft that its own flights told of.\"\nvehicle = \"craft.toml\"\n\
                            linearisation = \"equilibrium\"\nmethod = \"cascade\"\ncontrol_rate_hz = 500\n\
                            [region]\nfrom = \"identified\"\nforce_percent = [70.0, 105.0]\n[minimum]\nphase_all_deg = 32.0\n";

#[test]
fn a_design_takes_its_region_from_the_intervals_of_its_craft() {
    let folder = folder("identify-region");
    let craft = include_str!("../../../../gains/vehicles/crazyflie-2.1.toml")
        .replace("mass_kg = 0.029", "mass_kg = 0.027")
        .replace("lag_s = 0.126", "lag_s = 0.067")
        .replace("name = \"crazyflie-2.1\"", "name = \"crazyflie-2.1-own\"");
    let table = |(name, low, high): &(&str, f64, f64)| {
        format!("\n[identified.{name}]\nlow = {low}\nhigh = {high}\nsource = \"quatrack identify, 2 logs\"\n")
    };
    let write = |intervals: &[(&str, f64, f64)], design: &str| {
        let vehicle = craft.clone() + &intervals.iter().map(table).collect::<String>();
        fs::write(folder.join("craft.toml"), vehicle).unwrap();
        fs::write(folder.join("own.toml"), design).unwrap();
        quatrack(&["gains", "design", folder.join("own.toml").to_str().unwrap()])
    };
    let designed = write(&INTERVALS, BY_INTERVALS);
    assert!(designed.status.success(), "{}", String::from_utf8_lossy(&designed.stderr));
    let said = String::from_utf8_lossy(&designed.stdout).into_owned();
    assert!(
        said.contains("its region is that of the vehicle's identified intervals: lag_ms, thrust_per_mass_m_s2,"),
        "{said}"
    );

    // The certificate has the bounds, and where they are from.
    let document = json(&folder.join("generated/own.json"));
    let bounds = &document["region"]["bounds"];
    let share = |key: &str| bounds[key].as_f64().unwrap();
    assert_eq!(bounds["lag_s"], serde_json::json!([0.06, 0.074]));
    // Rounded to the six digits that a document has.
    for (key, value) in [
        ("mass_share", 1.0 / 0.92 - 1.0),
        ("inertia_share", 0.12),
        // No flight turned the heading: as much as the built-in tables have.
        ("yaw_inertia_share", 0.3),
        ("delay_s", 0.008),
        ("drag_per_s", 0.43),
    ] {
        assert!((share(key) / value - 1.0).abs() < 1e-5, "{key}: {} for {value}", share(key));
    }
    assert_eq!(bounds["moment_n_s"], serde_json::json!([4.1e-4, 4.6e-4]));
    let from = &document["design"]["parameters"]["region_from"];
    assert_eq!(from[0]["figure"], "lag_ms");
    assert_eq!(from[0]["source"], "quatrack identify, 2 logs");
    for made in ["own.toml", "generated/own.json"] {
        let shown = quatrack(&["gains", "show", folder.join(made).to_str().unwrap()]);
        let said = String::from_utf8_lossy(&shown.stdout).into_owned();
        for line in [
            "motor lag            60.0 to 74.0 ms",
            "mass                 9 % more or less than told",
            "inertia              12 % more or less than told, about yaw 30 %",
            "by the 95 % intervals in the vehicle's file",
            "motor_lag_ms         lag_ms 60.00000 to 74.00000 (quatrack identify, 2 logs)",
        ] {
            assert!(said.contains(line), "{made} has no `{line}`: {said}");
        }
    }
    let shown = quatrack(&["gains", "show", folder.join("generated/own.bin").to_str().unwrap()]);
    assert!(String::from_utf8_lossy(&shown.stdout).contains("inertia              12 % more or less than told\n"));

    // What the flights did not tell is named; what is stated needs no interval.
    let refused = write(&INTERVALS[..2], BY_INTERVALS);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains("identified.inertia_x_kg_m2 is missing; region.from = \"identified\" needs it"), "{said}");
    let stated = BY_INTERVALS.replace("force_percent", "inertia_percent = 25.0\ndelay_ms = 10.0\nforce_percent");
    let designed = write(&INTERVALS[..2], &stated);
    assert!(designed.status.success(), "{}", String::from_utf8_lossy(&designed.stderr));
    let bounds = &json(&folder.join("generated/own.json"))["region"]["bounds"];
    assert_eq!((&bounds["inertia_share"], &bounds["delay_s"]), (&0.25.into(), &0.01.into()));
    // Without the word nothing is taken.
    let refused = write(&INTERVALS, &BY_INTERVALS.replace("from = \"identified\"\n", ""));
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(said.contains("motor_lag_ms is missing"), "{said}");
}
