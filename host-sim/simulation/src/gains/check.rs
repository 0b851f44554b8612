//! Committed files against the output of their designs today: designs and their files in; the first difference of each
//! file out, and its right contents.
//!
//! Rust and binary tables are compared byte for byte. In the JSON, gains in f64 agree to 1e-9 and figures of the
//! certificate to 1e-6 of themselves beyond their rounding to six digits; everything else is the same.

mod difference;

use std::path::{Path, PathBuf};

use quatrack_plan::bounded;

use super::GainsError;
use super::artifacts::{artifacts, default_folder};
use super::design::Design;
pub(crate) use difference::Comparison;
use difference::{byte_difference, is_near, json_difference, with_near_lines_of};

/// A file and its difference.
#[derive(Debug, Clone, PartialEq)]
pub struct Checked {
    /// The file.
    pub path: PathBuf,
    /// The first difference; none if it is its design's output.
    pub difference: Option<String>,
    /// Its right contents; none if no design gives it.
    pub contents: Option<Vec<u8>>,
}

impl Checked {
    /// A file against its right contents.
    pub(crate) fn against(path: PathBuf, contents: Vec<u8>, comparison: Comparison) -> Self {
        let difference = match std::fs::read(&path) {
            Err(error) => Some(format!("cannot be read ({error}); make it with `cargo gains generate`")),
            Ok(committed) if is_near(&committed, &contents, comparison) => None,
            Ok(committed) => byte_difference(&committed, &with_near_lines_of(&committed, &contents, comparison)),
        };
        Self { path, difference, contents: Some(contents) }
    }
}

/// A design that could not be carried out.
#[derive(Debug, Clone, PartialEq)]
pub struct Failed {
    /// Its file.
    pub path: PathBuf,
    /// Why.
    pub error: GainsError,
}

/// Designs of a folder, in the order of their names; vehicles beside them and files of folders in it are not among them.
///
/// # Errors
/// The system's error about the folder.
pub fn designs(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut paths = with_extension(folder, &["toml"])?;
    paths.retain(|path| !is_vehicle(path));
    Ok(paths)
}

/// Whether a file is a vehicle by its tables `[body]` and `[motors]`, which no design has. A damaged vehicle is one, too: the
/// design that names it tells its fault.
fn is_vehicle(path: &Path) -> bool {
    let text = bounded::read_to_string(path).unwrap_or_default();
    let file = text.parse::<toml::Table>().unwrap_or_default();
    ["body", "motors"].iter().all(|table| file.get(*table).is_some_and(toml::Value::is_table))
}

/// Compares the files of a design.
///
/// # Errors
/// [`Failed`] if the design gives none.
pub fn check_design(path: &Path, folder: &Path) -> Result<Vec<Checked>, Failed> {
    let certified = Design::from_file(path)
        .and_then(|design| design.certify())
        .map_err(|error| Failed { path: path.to_owned(), error })?;
    let compared = artifacts(&certified, folder).into_iter().map(|file| {
        let difference = match std::fs::read(&file.path) {
            Err(error) => {
                Some(format!("cannot be read ({error}); make it with `quatrack gains design {}`", path.display()))
            }
            Ok(committed) if file.path.extension().is_some_and(|extension| extension == "json") => {
                json_difference(&committed, &certified)
            }
            Ok(committed) => byte_difference(&committed, &file.contents),
        };
        Checked { path: file.path, difference, contents: Some(file.contents) }
    });
    Ok(compared.collect())
}

/// Compares the files of a folder of designs, and finds those that no design gives.
///
/// # Errors
/// [`Failed`] for the first design that gives no files, or for the folder if it cannot be read.
pub fn check_folder(folder: &Path) -> Result<Vec<Checked>, Failed> {
    let unreadable = |error: std::io::Error| Failed {
        path: folder.to_owned(),
        error: GainsError::Unreadable { reason: error.to_string() },
    };
    let designs = designs(folder).map_err(unreadable)?;
    let mut checked = Vec::new();
    for design in &designs {
        checked.extend(check_design(design, &default_folder(design))?);
    }
    let generated = folder.join("generated");
    if generated.is_dir() {
        for path in with_extension(&generated, &["json", "rs", "bin"]).map_err(unreadable)? {
            if !checked.iter().any(|file| file.path == path) {
                let difference = Some("no design gives it; delete it".to_owned());
                checked.push(Checked { path, difference, contents: None });
            }
        }
    }
    Ok(checked)
}

/// Files of a folder with one of the extensions, sorted.
fn with_extension(folder: &Path, extensions: &[&str]) -> std::io::Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let wanted = path.extension().is_some_and(|found| extensions.iter().any(|extension| found == *extension));
        if wanted && path.is_file() {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}
