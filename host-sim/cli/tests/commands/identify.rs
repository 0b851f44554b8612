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
    // An eight is smooth: a tenth of the drag and the moment, whose truth is over the mass of the file, 29 g.
    let mass_ratio = 0.029 / 0.027;
    for (name, truth, share) in [
        ("drag_x_per_s", 0.39 * mass_ratio, 0.1),
        ("drag_y_per_s", 0.43 * mass_ratio, 0.1),
        ("moment_x_n_m_per_m_s", 3.8e-4, 0.1),
        ("moment_y_n_m_per_m_s", 4.3e-4, 0.1),
        ("lag_ms", 67.0, 0.15),
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
