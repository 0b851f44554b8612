//! What every command writes: files that are whole or absent, JSON, and argument errors.

use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde::Serialize;

use super::Failure;

/// Prints help, version or an argument error as clap does, which knows what may have been meant; exit code 2 for an error.
pub(crate) fn argument_error(error: &clap::Error) -> ExitCode {
    // Whether or not anybody reads it, there is nothing more to do.
    let _ = error.print();
    if error.use_stderr() { ExitCode::from(2) } else { ExitCode::SUCCESS }
}

/// Prints a text as it is. A reader that has seen enough and closed the pipe is no failure.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    match io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::input(format!("standard output: cannot be written ({error})")))
        }
        _ => Ok(()),
    }
}

/// Creates `dir` and what leads to it.
pub(crate) fn create_dir(dir: &Path) -> Result<(), Failure> {
    fs::create_dir_all(dir).map_err(|error| {
        Failure::input(format!("{}: cannot create this folder ({error}); choose another", dir.display()))
    })
}

/// Writes a file under a temporary name beside it and renames it, so that the file at `path` is always whole.
pub(crate) fn write(path: &Path, contents: &[u8]) -> Result<(), Failure> {
    let mut partial = path.as_os_str().to_owned();
    partial.push(".partial");
    let partial = PathBuf::from(partial);
    fs::write(&partial, contents).and_then(|()| fs::rename(&partial, path)).map_err(|error| {
        // The first error is the one to report; a leftover of it is only tidied away.
        let _ = fs::remove_file(&partial);
        Failure::input(format!("{}: cannot write this file ({error}); choose another place", path.display()))
    })
}

/// A value with what it is before its own keys: `"schema": "quatrack/NAME/1"`. The forms are in `docs/json.md`.
#[derive(Serialize)]
pub(crate) struct Named<'a, T> {
    schema: String,
    #[serde(flatten)]
    value: &'a T,
}

impl<'a, T: Serialize> Named<'a, T> {
    /// Of a value with keys.
    pub(crate) fn new(name: &str, value: &'a T) -> Self {
        Self { schema: format!("quatrack/{name}/1"), value }
    }
}

/// Writes `value` as JSON, ended by a line feed.
pub(crate) fn write_json(path: &Path, value: &impl Serialize) -> Result<(), Failure> {
    let mut text = serde_json::to_string_pretty(value)
        .map_err(|error| Failure::input(format!("{}: cannot be written as JSON ({error})", path.display())))?;
    text.push('\n');
    write(path, text.as_bytes())
}
