//! `quatrack gains` and the commands that fly and export its designs, as their user meets them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

mod designs;
mod files;
mod tables;

const GAINS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../gains");

fn quatrack(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_quatrack")).args(arguments).output().expect("the command starts")
}

/// A folder of this test's own, emptied.
fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("gains").join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

/// A committed design under another name, with one text for another.
fn design(dir: &Path, name: &str, of: &str, from: &str, to: &str) -> String {
    let text = fs::read_to_string(Path::new(GAINS).join(of)).unwrap();
    assert!(text.contains(from), "nothing to edit: {from}");
    let path = dir.join(name);
    fs::write(&path, text.replacen(from, to, 1)).unwrap();
    path.to_str().unwrap().to_owned()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn assert_done(output: &Output) {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// The command refuses with this code and a line on standard error that names all of this.
fn assert_refused(output: &Output, exit_code: i32, named: &[&str]) {
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(exit_code), "{stderr}");
    for name in named {
        assert!(stderr.contains(name), "`{name}` is not named in {stderr}");
    }
}
