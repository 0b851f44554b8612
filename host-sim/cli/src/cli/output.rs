//! Outputs of every command: files that are whole or absent, JSON, and argument errors.

use std::ffi::OsString;
use std::fs;
use std::io::{self, Write as _};
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use clap::builder::{OsStringValueParser, TryMapValueParser, TypedValueParser as _, ValueParserFactory};
use serde::Serialize;

use super::Failure;

/// Prints help, version or an argument error as clap does, which suggests the nearest argument; exit code 2 for an error.
pub(crate) fn argument_error(error: &clap::Error) -> ExitCode {
    // Whether or not anybody reads it, there is nothing more to do.
    let _ = error.print();
    if error.use_stderr() { ExitCode::from(2) } else { ExitCode::SUCCESS }
}

/// Whether a file goes to standard output.
static IS_TAKEN: AtomicBool = AtomicBool::new(false);

/// A file to write, as an argument names it. `-` is standard output, which then is that file alone: what is printed beside
/// it goes to standard error.
#[derive(Clone, Debug)]
pub(crate) struct File(PathBuf);

impl ValueParserFactory for File {
    type Parser = TryMapValueParser<OsStringValueParser, fn(OsString) -> Result<Self, &'static str>>;

    fn value_parser() -> Self::Parser {
        OsStringValueParser::new().try_map(Self::of)
    }
}

impl File {
    /// Of a command's arguments: no other argument takes standard output, so that `-` elsewhere means what it does there, and
    /// only one of them may.
    pub(super) fn of(name: OsString) -> Result<Self, &'static str> {
        if name == "-" && IS_TAKEN.swap(true, Relaxed) {
            return Err("standard output holds one file, and another argument has it; name a file");
        }
        Ok(Self(name.into()))
    }
}

impl Deref for File {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

/// Prints a text as it is. A reader that has seen enough and closed the pipe is no failure.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    if IS_TAKEN.load(Relaxed) {
        // Nobody may be listening, which is no failure of the command.
        let _ = io::stderr().write_all(text.as_bytes());
        return Ok(());
    }
    print_bytes(text.as_bytes())
}

fn print_bytes(bytes: &[u8]) -> Result<(), Failure> {
    match io::stdout().write_all(bytes) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::input(format!("standard output: cannot be written ({error})")))
        }
        _ => Ok(()),
    }
}

/// Creates `dir` and its parents.
pub(crate) fn create_dir(dir: &Path) -> Result<(), Failure> {
    fs::create_dir_all(dir).map_err(|error| {
        Failure::input(format!("{}: cannot create this folder ({error}); choose another", dir.display()))
    })
}

/// Writes a file, which is whole at every moment: under a name that nobody guesses, in the same folder, and then renamed.
/// The target of a link is written, the link stays; a file keeps its mode. `-` is standard output, and a device or a pipe
/// is written to.
pub(crate) fn write(path: &Path, contents: &[u8]) -> Result<(), Failure> {
    if path.as_os_str() == "-" {
        return print_bytes(contents);
    }
    replace(path, contents).map_err(|error| {
        Failure::input(format!("{}: cannot write this file ({error}); choose another place", path.display()))
    })
}

/// A value with its schema before its own keys: `"schema": "quatrack/NAME/1"`. The forms are in `docs/json.md`.
#[derive(Serialize)]
pub(crate) struct Named<'a, T> {
    schema: String,
    #[serde(flatten)]
    value: &'a T,
}

impl<'a, T: Serialize> Named<'a, T> {
    /// The object of a value with keys.
    pub(crate) fn new(name: &str, value: &'a T) -> Self {
        Self::of_form(name, 1, value)
    }

    /// The same where its keys have changed since the first form.
    pub(crate) fn of_form(name: &str, form: u32, value: &'a T) -> Self {
        Self { schema: format!("quatrack/{name}/{form}"), value }
    }
}

/// How the name of a file begins that is not whole yet.
const TEMPORARY: &str = ".quatrack-";

fn replace(path: &Path, contents: &[u8]) -> io::Result<()> {
    let target = target_of(path)?;
    let known = match fs::metadata(&target) {
        Ok(known) => Some(known),
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        Err(error) => return Err(error),
    };
    if known.as_ref().is_some_and(fs::Metadata::is_dir) {
        return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"));
    }
    if known.as_ref().is_some_and(|known| !known.is_file()) {
        // A device or a pipe cannot be replaced and is not to be.
        return fs::OpenOptions::new().write(true).open(&target)?.write_all(contents);
    }
    if known.is_some() {
        // Renaming asks for no right to the file itself: one that may not be written is not replaced.
        fs::OpenOptions::new().write(true).open(&target)?;
    }
    let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut file = temporary().prefix(TEMPORARY).tempfile_in(folder)?;
    file.write_all(contents)?;
    if let Some(known) = known {
        file.as_file().set_permissions(known.permissions())?;
    }
    file.persist(&target).map_err(|error| error.error)?;
    Ok(())
}

/// A file with the mode that any new one has: the process's mask takes bits off it.
#[cfg(unix)]
fn temporary<'p>() -> tempfile::Builder<'p, 'p> {
    use std::os::unix::fs::PermissionsExt as _;
    let mut builder = tempfile::Builder::new();
    builder.permissions(fs::Permissions::from_mode(0o666));
    builder
}

#[cfg(not(unix))]
fn temporary<'p>() -> tempfile::Builder<'p, 'p> {
    tempfile::Builder::new()
}

/// The end of a path's links, whether it is there or not.
fn target_of(path: &Path) -> io::Result<PathBuf> {
    let mut target = path.to_path_buf();
    // As deep as Linux follows.
    for _ in 0..40 {
        match fs::read_link(&target) {
            Ok(next) => target = target.parent().unwrap_or(Path::new("")).join(next),
            Err(_) => return Ok(target),
        }
    }
    Err(io::Error::other("too many links"))
}

/// Writes `value` as JSON, ended by a line feed.
pub(crate) fn write_json(path: &Path, value: &impl Serialize) -> Result<(), Failure> {
    let mut text = serde_json::to_string_pretty(value)
        .map_err(|error| Failure::input(format!("{}: cannot be written as JSON ({error})", path.display())))?;
    text.push('\n');
    write(path, text.as_bytes())
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    use std::os::unix::fs::symlink;

    use super::*;

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().permissions().mode() & 0o777
    }

    #[test]
    fn a_link_stays_its_target_is_written_and_keeps_its_mode() {
        let folder = tempfile::tempdir().unwrap();
        let (target, link) = (folder.path().join("target"), folder.path().join("link"));
        fs::write(&target, "old").unwrap();
        fs::set_permissions(&target, fs::Permissions::from_mode(0o640)).unwrap();
        symlink("target", &link).unwrap();
        write(&link, b"new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!((fs::read(&target).unwrap(), mode(&target)), (b"new".to_vec(), 0o640));
        // A link to nowhere leads to a new file.
        let hanging = folder.path().join("hanging");
        symlink("made", &hanging).unwrap();
        write(&hanging, b"new").unwrap();
        assert_eq!(fs::read(folder.path().join("made")).unwrap(), b"new");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 4, "nothing else is left");
    }

    #[test]
    fn a_folder_a_circle_and_a_protected_file_stay() {
        let folder = tempfile::tempdir().unwrap();
        assert!(write(folder.path(), b"new").is_err());
        let circle = folder.path().join("circle");
        symlink("circle", &circle).unwrap();
        assert!(write(&circle, b"new").is_err());
        let fixed = folder.path().join("fixed");
        fs::write(&fixed, "old").unwrap();
        fs::set_permissions(&fixed, fs::Permissions::from_mode(0o444)).unwrap();
        // A superuser may write anything.
        if fs::OpenOptions::new().write(true).open(&fixed).is_err() {
            assert!(write(&fixed, b"new").is_err());
            assert_eq!(fs::read(&fixed).unwrap(), b"old");
        }
    }

    #[test]
    fn a_device_and_a_pipe_are_written_to() {
        write(Path::new("/dev/null"), b"new").unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        rustix::fs::mknodat(rustix::fs::CWD, &pipe, rustix::fs::FileType::Fifo, 0o600.into(), 0).unwrap();
        let reader = std::thread::spawn({
            let pipe = pipe.clone();
            move || fs::read(pipe).unwrap()
        });
        write(&pipe, b"new").unwrap();
        assert_eq!(reader.join().unwrap(), b"new");
    }

    #[test]
    fn many_writers_of_one_file_never_tear_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        std::thread::scope(|scope| {
            for byte in 0..4_u8 {
                let path = &path;
                scope.spawn(move || (0..50).for_each(|_| write(path, &[byte; 100_000]).unwrap()));
            }
            for _ in 0..200 {
                let Ok(read) = fs::read(&path) else { continue };
                assert!(read.len() == 100_000 && read.iter().all(|byte| *byte == read[0]));
            }
        });
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
