//! A folder of designs in; a line for each, and all as JSON, out.

use std::fmt::Write as _;
use std::path::Path;

use quatrack_simulation::gains::{self, Design};
use serde::Serialize;
use serde_json::json;

use super::{FOLDER, failed, require_folder};
use crate::cli::{Failure, output};

/// A line of the list.
#[derive(Serialize)]
struct Entry {
    name: String,
    linearisation: String,
    method: String,
    vehicle: String,
    control_rate_hz: u32,
    description: String,
    /// Whether all of its files are there; `check` tells whether they are right.
    generated: bool,
}

pub(super) fn list(folder: Option<&Path>, json: Option<&Path>) -> Result<(), Failure> {
    let folder = folder.unwrap_or(Path::new(FOLDER));
    require_folder(folder)?;
    let paths = gains::designs(folder)
        .map_err(|error| Failure::input(format!("{}: cannot be read ({error})", folder.display())))?;
    let mut entries = Vec::new();
    for path in &paths {
        let design = Design::from_file(path).map_err(|error| failed(path, &error))?;
        let beside = gains::default_folder(path);
        let (linearisation, method) = design.problem.named();
        entries.push(Entry {
            generated: beside.join(format!("{}.json", design.name)).is_file(),
            name: design.name.to_string(),
            linearisation: linearisation.to_owned(),
            method: method.to_owned(),
            vehicle: design.vehicle.name().to_owned(),
            control_rate_hz: design.rate.hz(),
            description: design.description,
        });
    }
    let mut text = String::new();
    for Entry { name, linearisation, method, vehicle, control_rate_hz, description, generated } in &entries {
        let first = description.lines().next().unwrap_or_default();
        let state = if *generated { "" } else { " (not generated)" };
        let _ = writeln!(
            text,
            "{name:<24} {linearisation:<12} {method:<12} {vehicle:<26} {control_rate_hz:>5} Hz  {first}{state}"
        );
    }
    output::print(&text)?;
    json.map_or(Ok(()), |path| {
        output::write_json(path, &output::Named::new("gains-list", &json!({ "designs": entries })))
    })
}
