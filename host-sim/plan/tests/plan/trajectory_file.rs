//! Trajectory files are known by their content, and refused in one line that names the remedy.

use std::path::{Path, PathBuf};

use proptest::prelude::*;
use quatrack_plan::trajectory::Trajectory;
use quatrack_plan::trajectory::file::{self, FileError, TrajectoryFile};

const TOML: &str = "# a comment\ndegree = 2\nduration_s = 3.0\ncontrol_points_m = [\n  [0.0, 0.0, 0.0],\n  \
                    [1.0, 0.5, 0.25],\n  [1, 1, 1],\n]\n";
const JSON: &str = r#"{"degree": 2, "duration_s": 3.0, "control_points_m": [[0,0,0],[1,0.5,0.25],[1,1,1]]}"#;

fn error(text: &str) -> String {
    let line = file::parse("flight", text).expect_err("must be refused").to_string();
    assert!(line.starts_with("flight: ") && !line.contains('\n'), "{line}");
    line
}

/// A file of this test's own; removed when dropped.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str, bytes: &[u8]) -> Self {
        let path = std::env::temp_dir().join(format!("quatrack-{}-{name}", std::process::id()));
        std::fs::write(&path, bytes).expect("a folder for temporary files");
        Self(path)
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

#[test]
fn json_and_toml_hold_the_same_spline() {
    let TrajectoryFile::Spline(from_toml) = file::parse("a", TOML).expect("TOML") else { panic!("not a spline") };
    let TrajectoryFile::Spline(from_json) = file::parse("b", JSON).expect("JSON") else { panic!("not a spline") };
    assert_eq!(from_toml, from_json);
    assert_eq!((from_toml.degree(), from_toml.duration_s()), (2, 3.0));
    assert_eq!(from_toml.control_points_m()[1].y, 0.5);
}

#[test]
fn rows_are_pieces_and_waypoints_are_a_plan() {
    let row = format!("1,{}", ["0"; 32].join(","));
    assert!(matches!(file::parse("a", &row), Ok(TrajectoryFile::Pieces(_))));
    let plan = "degree = 5\n[[waypoints]]\ntime_s = 1.0\n";
    assert_eq!(file::parse("a", plan).expect("a plan"), TrajectoryFile::Plan(plan.into()));
}

#[test]
fn the_name_does_not_matter() {
    let scratch = Scratch::new("really-toml.csv", TOML.as_bytes());
    assert!(matches!(file::read(&scratch.0), Ok(TrajectoryFile::Spline(_))));
}

#[test]
fn keys_are_told_apart() {
    let wrong = error(&TOML.replace("duration_s", "duration"));
    assert!(
        wrong.starts_with("flight: line 3: unknown field `duration`, expected one of `schema`, `degree`"),
        "{wrong}"
    );
    assert!(error(&JSON.replace("degree", "order")).starts_with("flight: line 1: unknown field `order`"));
    let wrong = error("degree = 5\nduration_s = 1.0\n");
    assert!(wrong.contains("missing field `control_points_m`"), "{wrong}");
    let wrong = error(&TOML.replace("degree = 2", "degree = 2.5"));
    assert!(wrong.starts_with("flight: line 2: invalid type: floating point `2.5`"), "{wrong}");
    let wrong = error(&TOML.replace("[1, 1, 1]", "[1, 1]"));
    assert!(wrong.contains("control_points_m ([[x, y, z], ...], m)"), "{wrong}");
    let wrong = error(&TOML.replace("3.0", "3.0.0"));
    assert!(wrong.starts_with("flight: line 3: "), "{wrong}");
    assert!(error(&JSON[..40]).starts_with("flight: line 1: EOF while parsing"), "{}", error(&JSON[..40]));
}

#[test]
fn splines_and_pieces_that_cannot_be_flown_say_why() {
    assert_eq!(error(&TOML.replace("3.0", "-3.0")), "flight: duration_s = -3: must be a positive number of seconds");
    assert!(error(&TOML.replace("0.25", "nan")).contains("control point 1 (from 0) has the coordinate NaN"));
    assert!(error(&JSON.replace("2,", "9,")).contains("degree = 9: must be from 1 to 7"));
    assert!(error("duration,x^0\n1,2\n").starts_with("flight: line 1: the header has no y^0"));
    assert!(error("1,2,3,4,5,6\n").starts_with("flight: line 1: 6 columns; needs 33"));
}

#[test]
fn an_unknown_form_is_refused_with_the_accepted_ones() {
    for (text, found) in [
        ("", "flight: the file is empty; accepted are "),
        (" \r\n\t", "flight: the file is empty; accepted are "),
        ("# only this\n", "flight: nothing but comments; accepted are "),
        ("mass_kg = 1\n", "flight: has only the keys mass_kg; accepted are "),
        ("waypoints = []\ncontrol_points_m = []\n", "flight: has both waypoints and control_points_m; keep one"),
    ] {
        let line = error(text);
        assert!(line.starts_with(found), "{line}");
        assert!(line.contains("control points as JSON or TOML"), "{line}");
    }
}

#[test]
fn waypoints_and_samples_are_named_with_a_way_on() {
    for (text, found) in [
        (
            "t,x,y,z\n0,0,0,0\n1,1,0,0\n",
            "flight: rows of waypoints with times, no trajectory yet; `quatrack plan flight",
        ),
        ("0.0,0.45,1.4\n0.0,0.05,1.7\n", "flight: rows of waypoints, no trajectory yet"),
        ("t_s,x_m,y_m,z_m,q0\n0,0,0,1,1\n", "flight: rows of a flight sampled over time (t_s,x_m,y_m,z_m,q0)"),
        ("0;0;0;1;0;0;0\n0,1;0;0;1;0;0;0\n0,2;0;0;1;0;0;0\n", "flight: rows of a flight sampled over time (7 columns"),
    ] {
        let line = error(text);
        assert!(line.starts_with(found), "{line}");
    }
}

#[test]
fn headings_and_several_curves_are_read() {
    let turned = JSON.replace("}", r#", "heading_control_points_rad": [0, 0.5, 1]}"#);
    let TrajectoryFile::Spline(spline) = file::parse("a", &turned).expect("a heading") else { panic!("not a spline") };
    assert_eq!((spline.at(0.0).heading_rad, spline.at(3.0).heading_rad), (0.0, 1.0));
    assert!(error(&turned.replace("0.5, 1]", "0.5]")).contains("must be 3 finite numbers"));
    let back = turned.replace("[0,0,0],[1,0.5,0.25],[1,1,1]", "[1,1,1],[0,0,0]").replace("2,", "1,");
    let back = back.replace("[0, 0.5, 1]", "[1, 1]");
    let both = format!(r#"{{"curves": [{turned}, {back}]}}"#);
    let TrajectoryFile::Pieces(pieces) = file::parse("b", &both).expect("two curves") else { panic!("not pieces") };
    assert_eq!((pieces.duration_s(), pieces.pieces().len()), (6.0, 2));
    assert!(error(&both.replace("[1, 1]", "[0, 0]")).contains("yaw jumps by 1"));
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let missing = file::read(Path::new("no-such-flight.csv")).expect_err("missing");
    assert!(matches!(missing, FileError::Unreadable { .. }));
    assert!(missing.to_string().starts_with("no-such-flight.csv: cannot be read ("), "{missing}");
    let folder = file::read(&std::env::temp_dir()).expect_err("a folder");
    assert!(matches!(folder, FileError::Unreadable { .. }), "{folder}");
    let scratch = Scratch::new("latin1.toml", b"# first\n# caf\xe9\n");
    let latin = file::read(&scratch.0).expect_err("not UTF-8").to_string();
    assert!(latin.ends_with("line 2 is not UTF-8; save the file as UTF-8 text"), "{latin}");
}

#[test]
fn the_recovered_control_points_read() {
    for (name, duration_s, points) in [("mild", 30.0, 41), ("aggressive", 12.0, 43)] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/paper/trajectories");
        let path = folder.join(format!("{name}.toml"));
        if !path.exists() {
            println!("skipped: {name}.toml is not on this machine");
            continue;
        }
        let Ok(TrajectoryFile::Spline(spline)) = file::read(&path) else { panic!("{name} is a spline") };
        assert_eq!((spline.duration_s(), spline.control_points_m().len(), spline.degree()), (duration_s, points, 5));
    }
}

proptest! {
    #[test]
    fn no_text_breaks_the_reader(text in any::<String>()) {
        if let Err(error) = file::parse("flight", &text) {
            prop_assert!(!error.to_string().contains('\n'), "{}", error);
        }
    }

    #[test]
    fn no_damage_to_a_file_breaks_the_reader(
        json in any::<bool>(),
        at in any::<prop::sample::Index>(),
        insert in "[-0-9.,\n#e{}\\[\\]=\"a-z]{0,4}",
    ) {
        let mut text = if json { JSON } else { TOML }.to_owned();
        let at = at.index(text.len());
        text.replace_range(at..=at, &insert);
        match file::parse("flight", &text) {
            Ok(TrajectoryFile::Spline(spline)) => prop_assert!(spline.duration_s() > 0.0),
            Ok(_) => {}
            Err(error) => prop_assert!(!error.to_string().contains('\n'), "{}", error),
        }
    }
}
