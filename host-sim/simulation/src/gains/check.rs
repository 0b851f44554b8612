//! What is committed against what its designs give today: designs and their files in; the first difference of each file
//! out.
//!
//! Rust and binary tables are compared byte for byte. In the JSON, gains in f64 agree to 1e-9 and figures of the
//! certificate to 1e-6 of themselves beyond their rounding to six digits; everything else is the same.

use std::path::{Path, PathBuf};

use quatrack_design::design::codegen;
use serde_json::Value;

use super::GainsError;
use super::artifacts::{FIGURES, artifacts, default_folder, document};
use super::certified::Certified;
use super::design::Design;
use super::significant::{SAME_GAIN, is_same_figure};

/// A decimal of an f64 is read to one rounding.
const READ: f64 = 1e-15;

/// A file and what is wrong with it.
#[derive(Debug, Clone, PartialEq)]
pub struct Checked {
    /// The file.
    pub path: PathBuf,
    /// The first difference; none if it is what its design gives.
    pub difference: Option<String>,
}

/// A design that could not be carried out.
#[derive(Debug, Clone, PartialEq)]
pub struct Failed {
    /// Its file.
    pub path: PathBuf,
    /// Why.
    pub error: GainsError,
}

/// Designs of a folder, in the order of their names; those of folders in it are not among them.
///
/// # Errors
/// What the system says of the folder.
pub fn designs(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    with_extension(folder, &["toml"])
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
        Checked { path: file.path, difference }
    });
    Ok(compared.collect())
}

/// Compares everything that belongs to a folder of designs: their files, files that no design gives, and the core's own
/// tables of the paper where the folder stands beside it.
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
                checked.push(Checked { path, difference });
            }
        }
    }
    let paper = folder.join("../core/src/gains/paper.rs");
    if let Ok(committed) = std::fs::read(&paper) {
        let path = paper.canonicalize().unwrap_or(paper);
        let computed = codegen::paper_tables().map_err(|error| Failed { path: path.clone(), error: error.into() })?;
        checked.push(Checked { path, difference: byte_difference(&committed, computed.as_bytes()) });
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

fn byte_difference(committed: &[u8], computed: &[u8]) -> Option<String> {
    if committed == computed {
        return None;
    }
    if let (Ok(committed), Ok(computed)) = (std::str::from_utf8(committed), std::str::from_utf8(computed)) {
        let end = "(the end)";
        let lines = committed.lines().count().max(computed.lines().count()) + 1;
        let mut pairs = committed.lines().chain([end]).zip(computed.lines().chain([end])).take(lines);
        if let Some((number, (here, there))) =
            (1..).zip(&mut pairs).find(|(_, (committed, computed))| committed != computed)
        {
            return Some(format!("line {number} is `{}`; its design gives `{}`", here.trim(), there.trim()));
        }
    }
    let position = committed.iter().zip(computed).position(|(committed, computed)| committed != computed);
    Some(match position {
        Some(at) => {
            format!("byte {at} is {:#04x}; its design gives {:#04x}", committed[at], computed[at])
        }
        None => format!("{} bytes; its design gives {}", committed.len(), computed.len()),
    })
}

/// How numbers are compared.
#[derive(Clone, Copy)]
enum Rule {
    Figure,
    Relative(f64),
}

fn json_difference(committed: &[u8], certified: &Certified) -> Option<String> {
    let committed: Value = match serde_json::from_slice(committed) {
        Ok(value) => value,
        Err(error) => return Some(format!("no JSON ({error})")),
    };
    difference("", &committed, &document(certified), Rule::Relative(READ))
}

fn difference(path: &str, committed: &Value, computed: &Value, rule: Rule) -> Option<String> {
    match (committed, computed) {
        (Value::Object(here), Value::Object(there)) => {
            if let Some(key) = here.keys().find(|key| !there.contains_key(*key)) {
                return Some(format!("{path}{key} is there; its design gives none"));
            }
            there.iter().find_map(|(key, computed)| {
                let rule = match key.as_str() {
                    key if FIGURES.contains(&key) => Rule::Figure,
                    "gain" => Rule::Relative(SAME_GAIN),
                    _ => rule,
                };
                let dot = if computed.is_object() { "." } else { "" };
                match here.get(key) {
                    Some(committed) => difference(&format!("{path}{key}{dot}"), committed, computed, rule),
                    None => Some(format!("{path}{key} is missing")),
                }
            })
        }
        (Value::Array(here), Value::Array(there)) if here.len() == there.len() => {
            here.iter().zip(there).enumerate().find_map(|(i, (committed, computed))| {
                let dot = if computed.is_object() { "." } else { "" };
                difference(&format!("{path}[{i}]{dot}"), committed, computed, rule)
            })
        }
        (Value::Number(_), Value::Number(_)) => {
            let (here, there) = (committed.as_f64()?, computed.as_f64()?);
            let same = match rule {
                Rule::Figure => is_same_figure(here, there),
                Rule::Relative(share) => (here - there).abs() <= share * there.abs(),
            };
            (!same).then(|| format!("{path} is {here}; its design gives {there}"))
        }
        _ if committed == computed => None,
        _ => Some(format!("{path} is {committed}; its design gives {computed}")),
    }
}
