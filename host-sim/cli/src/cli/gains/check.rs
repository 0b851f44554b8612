//! Designs and the files that were made of them in; the differences, or the files written anew, out.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use quatrack_simulation::gains::{self, Checked, Failed};
use quatrack_simulation::generated::{self, GenerateError};
use serde_json::{Value, json};

use super::{FOLDER, failed, require_folder, wrote};
use crate::cli::{Failure, output};

/// The differences of folders of designs, or of designs; of [`FOLDER`] where none is named.
fn compared(paths: &[PathBuf]) -> Result<Vec<Checked>, Failure> {
    let default = [PathBuf::from(FOLDER)];
    let paths = if paths.is_empty() { require_folder(Path::new(FOLDER)).map(|()| &default[..])? } else { paths };
    let mut checked: Vec<Checked> = Vec::new();
    for path in paths {
        let found = if path.is_dir() { generated::check(path) } else { check_file(path).map_err(GenerateError::Table) };
        checked.extend(found.map_err(|error| match error {
            GenerateError::Table(Failed { path, error }) => failed(&path, &error),
            other => Failure::verdict(other),
        })?);
    }
    if checked.is_empty() {
        return Err(Failure::input(format!(
            "{}: no design here; designs are files ending in .toml",
            paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
        )));
    }
    Ok(checked)
}

pub(super) fn generate(folders: &[PathBuf]) -> Result<(), Failure> {
    let mut text = String::new();
    let (mut same, mut left) = (0, String::new());
    for file in compared(folders)? {
        match (&file.difference, &file.contents) {
            (None, _) => same += 1,
            (Some(_), Some(contents)) => {
                if let Some(folder) = file.path.parent() {
                    output::create_dir(folder)?;
                }
                output::write(&file.path, contents)?;
                wrote(&mut text, &file.path);
                if file.path.parent().is_some_and(|folder| folder.ends_with("plans")) {
                    text += "  run this once more: gains along a trajectory are made for the plans built into this program\n";
                }
            }
            (Some(_), None) => left = format!("{left}{}\n", told(&file)),
        }
    }
    let _ = writeln!(text, "{same} files agreed with their designs");
    output::print(&text)?;
    if left.is_empty() { Ok(()) } else { Err(Failure::verdict(left.trim_end().replace('\n', "\nquatrack: "))) }
}

pub(super) fn check(paths: &[PathBuf], json: Option<&Path>) -> Result<(), Failure> {
    let checked = compared(paths)?;
    if let Some(path) = json {
        let files: Vec<Value> =
            checked.iter().map(|file| json!({ "file": file.path, "difference": file.difference })).collect();
        output::write_json(path, &output::Named::new("gains-check", &json!({ "files": files })))?;
    }
    let differing: Vec<&Checked> = checked.iter().filter(|file| file.difference.is_some()).collect();
    match differing.split_first() {
        None => output::print(&format!("{} files agree with their designs\n", checked.len())),
        Some((first, others)) => {
            let mut line = told(first);
            for other in others {
                line += "\nquatrack: ";
                line += &told(other);
            }
            Err(Failure::verdict(line))
        }
    }
}

fn told(checked: &Checked) -> String {
    format!("{}: {}", checked.path.display(), checked.difference.as_deref().unwrap_or_default())
}

/// A design, or the design of a file that was made of one.
fn check_file(path: &Path) -> Result<Vec<Checked>, Failed> {
    let is_made = path.extension().is_some_and(|extension| ["json", "rs", "bin"].iter().any(|made| extension == *made));
    let beside = path.parent().and_then(Path::parent).filter(|_| is_made);
    match (beside, path.file_stem()) {
        (Some(folder), Some(stem)) => {
            let design = folder.join(stem).with_extension("toml");
            let folder = gains::default_folder(&design);
            let mut checked = gains::check_design(&design, &folder)?;
            checked.retain(|file| file.path.file_name() == path.file_name());
            Ok(checked)
        }
        _ => gains::check_design(path, &gains::default_folder(path)),
    }
}
