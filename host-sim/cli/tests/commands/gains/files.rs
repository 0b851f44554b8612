//! Committed and generated files of gains, held against their designs.

use std::fs;
use std::path::Path;
use std::process::Command;

use super::{GAINS, assert_done, assert_refused, design, folder, quatrack, stdout};

#[test]
fn committed_files_are_their_designs_output() {
    let json = folder("committed").join("checked.json");
    assert_done(&quatrack(&["gains", "check", GAINS, "--json", json.to_str().unwrap()]));
    let checked: serde_json::Value = serde_json::from_str(&fs::read_to_string(json).unwrap()).unwrap();
    let files: Vec<&str> =
        checked["files"].as_array().unwrap().iter().map(|file| file["file"].as_str().unwrap()).collect();
    let names = ["lyap-e", "lyap-f", "lqr-e", "lqr-f", "sampled-lqr-e", "sampled-lqr-f", "lqi-e"];
    for name in names.into_iter().chain(["along-mild", "along-aggressive"]) {
        for extension in ["json", "rs", "bin"] {
            let file = format!("generated/{name}.{extension}");
            assert!(files.iter().any(|checked| checked.ends_with(&file)), "{file} is not among {files:?}");
        }
    }
    for source in SOURCES {
        assert!(files.iter().any(|checked| checked.ends_with(source)), "{source} is not among {files:?}");
    }
}

/// The generated sources of a checkout.
const SOURCES: [&str; 5] = [
    "core/src/gains/paper.rs",
    "crazyflie/src/builtin/paper_limits.rs",
    "core/src/gains/cascade.rs",
    "plans/mild.rs",
    "plans/aggressive.rs",
];

#[test]
fn files_missing_or_off_by_a_percent_are_named_and_written_again() {
    let root = folder("checkout");
    let gains = root.join("gains");
    fs::create_dir_all(&gains).unwrap();
    design(&gains, "lyap-f.toml", "lyap-f.toml", "2.0", "2.0");
    // Those that the core's own tables are made of.
    for entry in fs::read_dir(GAINS).unwrap().map(Result::unwrap) {
        let name = entry.file_name().into_string().unwrap();
        if name.starts_with("cascade-") && name.ends_with(".toml") {
            fs::copy(entry.path(), gains.join(name)).unwrap();
        }
    }
    let committed = |source: &str| fs::read_to_string(Path::new(GAINS).join("..").join(source)).unwrap();
    let write = |source: &str, text: &str| {
        let path = root.join(source);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    // A figure of each by 1 % of itself, a duration by 1 ns; one source and the tables are not there.
    for (source, from, to) in [
        (SOURCES[0], "45.7951", "45.3372"),
        (SOURCES[1], "(2.4, 0.0687)", "(2.4, 0.069387)"),
        (SOURCES[2], "0.20049259", "0.2024975"),
        (SOURCES[3], "duration_ns: 833333333", "duration_ns: 833333334"),
    ] {
        let text = committed(source);
        assert!(text.contains(from), "{source} has no {from}");
        write(source, &text.replacen(from, to, 1));
    }
    let there = gains.to_str().unwrap();
    let named = [
        "lyap-f.json: cannot be read",
        "paper.rs: line ",
        "paper_limits.rs: line ",
        "0.069387",
        "cascade.rs: line ",
        "0.2024975",
        "mild.rs: line 4 is",
        "aggressive.rs: cannot be read",
    ];
    assert_refused(&quatrack(&["gains", "check", there]), 1, &named);
    let output = quatrack(&["gains", "generate", there]);
    assert_done(&output);
    for source in SOURCES {
        assert!(stdout(&output).contains(&format!("{source}\n")), "{source}: {}", stdout(&output));
    }
    for source in &SOURCES[..3] {
        assert_eq!(fs::read_to_string(root.join(source)).unwrap(), committed(source), "{source}");
    }
    assert_eq!(
        fs::read(gains.join("generated/lyap-f.bin")).unwrap(),
        fs::read(format!("{GAINS}/generated/lyap-f.bin")).unwrap()
    );
}

#[test]
fn a_changed_file_is_named_with_its_first_difference() {
    let dir = folder("changed");
    let toml = design(&dir, "mine.toml", "lyap-f.toml", "mu_1_s = 2.0", "mu_1_s = 1.5");
    assert_done(&quatrack(&["gains", "design", &toml]));
    let made = dir.join("generated");
    let check = || quatrack(&["gains", "check", &toml]);
    assert_done(&check());

    // A figure of the certificate by 2e-5 of itself: more than the rounding to six digits and 1e-6.
    let json = made.join("mine.json");
    let whole = fs::read_to_string(&json).unwrap();
    let mut value: serde_json::Value = serde_json::from_str(&whole).unwrap();
    let figure = &mut value["certificate"]["sampled"]["spectral_radius"];
    *figure = (figure.as_f64().unwrap() * (1.0 - 2e-5)).into();
    fs::write(&json, value.to_string()).unwrap();
    assert_refused(&check(), 1, &["mine.json: certificate.sampled.spectral_radius is 0.99", "its design gives 0.99"]);
    // A gain in f64 by 2e-9.
    let mut value: serde_json::Value = serde_json::from_str(&whole).unwrap();
    let entry = &mut value["gain"]["k"][0][0];
    *entry = (entry.as_f64().unwrap() * (1.0 + 2e-9)).into();
    fs::write(&json, value.to_string()).unwrap();
    assert_refused(&check(), 1, &["mine.json: gain.k[0][0] is 4.5"]);
    // A file that only looks different is not.
    let value: serde_json::Value = serde_json::from_str(&whole).unwrap();
    fs::write(&json, value.to_string()).unwrap();
    assert_done(&check());

    let rust = made.join("mine.rs");
    let text = fs::read_to_string(&rust).unwrap();
    fs::write(&rust, text.replacen("[4.5, ", "[4.4, ", 1)).unwrap();
    let binary = made.join("mine.bin");
    let mut bytes = fs::read(&binary).unwrap();
    bytes[200] ^= 1;
    fs::write(&binary, &bytes).unwrap();
    fs::remove_file(&json).unwrap();
    // The whole folder: every file that is wrong, and one that no design gives.
    fs::write(made.join("older.bin"), bytes).unwrap();
    let named =
        ["mine.json: cannot be read", "mine.rs: line ", "mine.bin: byte 200 is", "older.bin: no design gives it"];
    assert_refused(&quatrack(&["gains", "check", dir.to_str().unwrap()]), 1, &named);
}

#[test]
fn without_designs_there_is_a_word_of_help() {
    let dir = folder("elsewhere");
    let there = |arguments: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_quatrack")).args(arguments).current_dir(&dir).output().unwrap()
    };
    assert_refused(&there(&["gains", "check"]), 2, &["gains: no such folder here", "checkout"]);
    assert_refused(&there(&["gains", "list"]), 2, &["gains: no such folder here"]);
    assert_refused(&there(&["gains", "check", "."]), 2, &["no design here"]);
    assert_refused(&there(&["gains", "check", "lost.toml"]), 2, &["lost.toml: cannot read this design"]);
    assert_refused(&there(&["gains", "show", "lost.bin"]), 2, &["lost.bin: cannot be read"]);
    assert_refused(&there(&["gains", "show", "lost.txt"]), 2, &["lost.txt: neither a design"]);
}

#[test]
fn text_given_for_a_binary_table_is_named_with_the_table_beside_it() {
    let json = format!("{GAINS}/generated/lqr-e.json");
    let beside = format!(
        "is JSON, a certificate perhaps, not a binary gain table; the table beside it is {GAINS}/generated/lqr-e.bin"
    );
    assert_refused(&quatrack(&["fly", "--gains", &json]), 2, &[&beside]);
    assert_refused(&quatrack(&["fly", "--gains", &json, "--trajectory", "mild"]), 2, &[&beside]);
    assert_refused(&quatrack(&["compare", "--gains", &json]), 2, &[&beside]);
}
