//! Committed files against the output of their designs today: designs and their files in; the first difference of each
//! file out, and its right contents.
//!
//! Rust and binary tables are compared byte for byte. In the JSON, gains in f64 agree to 1e-9 and figures of the
//! certificate to 1e-6 of themselves beyond their rounding to six digits; everything else is the same.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::GainsError;
use super::artifacts::{FIGURES, artifacts, default_folder, document};
use super::certified::Certified;
use super::design::Design;
use super::rounding::{SAME_GAIN, is_same_figure};

/// A decimal of an f64 is read to one rounding.
const READ: f64 = 1e-15;

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

/// The comparison of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Comparison {
    /// Byte for byte.
    Bytes,
    /// Text byte for byte between its numbers; integers exactly, others to this share of themselves, or of 1 below 1.
    Numbers(f64),
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

/// Designs of a folder, in the order of their names; those of folders in it are not among them.
///
/// # Errors
/// The system's error about the folder.
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

/// The computed text with each line that is near the committed one as committed: the first difference is a real one.
fn with_near_lines_of(committed: &[u8], computed: &[u8], comparison: Comparison) -> Vec<u8> {
    let lines = |text| <[u8]>::split_inclusive(text, |byte| *byte == b'\n');
    let nothing: &[u8] = &[];
    let pairs = lines(computed).zip(lines(committed).chain(std::iter::repeat(nothing)));
    pairs.flat_map(|(there, here)| if is_near(here, there, comparison) { here } else { there }).copied().collect()
}

fn is_near(committed: &[u8], computed: &[u8], comparison: Comparison) -> bool {
    let (Comparison::Numbers(share), Ok(committed), Ok(computed)) =
        (comparison, std::str::from_utf8(committed), std::str::from_utf8(computed))
    else {
        return committed == computed;
    };
    let is_in_number = |c: char| c.is_ascii_alphanumeric() || ['.', '-', '_'].contains(&c);
    let words = |text| str::split_inclusive(text, move |c| !is_in_number(c));
    let (mut here, mut there) = (words(committed), words(computed));
    loop {
        match (here.next(), there.next()) {
            (None, None) => return true,
            (Some(here), Some(there)) if here == there => {}
            (Some(here), Some(there)) if is_near_number(here, there, share) => {}
            _ => return false,
        }
    }
}

/// Two numbers with a point, each with the character that ends it.
fn is_near_number(here: &str, there: &str, share: f64) -> bool {
    let parted = |word: &str| {
        let (at, end) = word.char_indices().next_back()?;
        let digits = word.get(..at).filter(|digits| digits.contains('.') || digits.contains('e'))?;
        digits.parse::<f64>().ok().map(|number| (number, end))
    };
    match (parted(here), parted(there)) {
        (Some((here, end)), Some((there, other_end))) => {
            end == other_end && (here - there).abs() <= share * there.abs().max(1.0)
        }
        _ => false,
    }
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

/// The comparison of numbers.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_may_differ_in_their_last_digits_and_nothing_else() {
        let near = |committed: &str, computed: &str| {
            is_near(committed.as_bytes(), computed.as_bytes(), Comparison::Numbers(1e-6))
        };
        let text = "pub static W: [Piece; 1] = [\n    duration_ns: 315789474,\n    x: [0.25, -1.5e-3, 2000.0],\n];\n";
        assert!(near(text, text));
        // Below 1 by 1e-6, above by that share.
        assert!(near(&text.replace("0.25", "0.2500009"), text) && !near(&text.replace("0.25", "0.2500011"), text));
        assert!(near(&text.replace("2000.0", "2000.0019"), text) && !near(&text.replace("2000.0", "2000.0021"), text));
        assert!(near(&text.replace("-1.5e-3", "-0.0015005"), text) && !near(&text.replace("-1.5e-3", "1.5e-3"), text));
        // Integers, names, and how many numbers there are.
        for (from, to) in [("474", "475"), ("W", "V"), (", 2000.0", ""), ("2000.0]", "2000.0)"), ("];\n", "];")] {
            assert!(!near(&text.replace(from, to), text), "{to} instead of {from}");
        }
    }
}
