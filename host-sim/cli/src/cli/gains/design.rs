//! Designs in; tables with their figures, or the header for a craft that the Crazyflie's object does not know, out.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use quatrack_simulation::crazyflie::{craft_header, own_craft, standard_design, standard_force_input};
use quatrack_simulation::gains::{self, Certified, Design, Problem};
use quatrack_simulation::vehicles;
use serde_json::{Value, json};

use super::{failed, read, wrote};
use crate::cli::{Failure, output};

/// Reads, computes and certifies a design.
pub(super) fn certified(path: &Path) -> Result<Certified, Failure> {
    let design = Design::from_file(path).map_err(|error| failed(path, &error))?;
    design.certify().map_err(|error| {
        let failure = failed(path, &error);
        match unscaled(&design).filter(|_| error.is_verdict()) {
            Some(note) => Failure { line: format!("{}; {note}", failure.line), ..failure },
            None => failure,
        }
    })
}

/// What an owner of another craft has to know of a design's weights; nothing for those of the paper's model, which has no mass.
fn unscaled(design: &Design) -> Option<String> {
    let mass_kg = design.vehicle.mass_kg();
    let scaled = match &design.problem {
        Problem::Cascade { .. } => {
            let force_input = standard_force_input(mass_kg);
            // Three digits, as somebody writes them.
            let written = format!("{force_input:.2e}").parse().unwrap_or(force_input);
            format!(", as `quatrack gains craft` takes it: force_input = {written} for this mass")
        }
        Problem::ActuatorAware { .. } => String::new(),
        _ => return None,
    };
    Some(format!(
        "weights are as written and do not scale with the mass, {mass_kg} kg: twice the mass and inertia fly alike with a quarter of \
         force_input{scaled}"
    ))
}

pub(super) fn design(paths: &[PathBuf], out: Option<&Path>, json: Option<&Path>) -> Result<(), Failure> {
    let mut summaries = Vec::new();
    for path in paths {
        let certified = certified(path)?;
        let folder = out.map_or_else(|| gains::default_folder(path), Path::to_path_buf);
        output::create_dir(&folder)?;
        let document = gains::json_document(&certified);
        let mut text = format!("{}\n{}", path.display(), figures(&document));
        text += &notes(&certified);
        for file in gains::artifacts(&certified, &folder) {
            output::write(&file.path, &file.contents)?;
            wrote(&mut text, &file.path);
        }
        if certified.table.is_none() {
            text += &format!("  no table: {}\n", certified.why_no_table());
        }
        output::print(&text)?;
        summaries.push(json!({ "design": path, "name": document["name"], "figures": document["figures"] }));
    }
    if let Some(path) = json {
        output::write_json(path, &output::Named::new("gains-design", &json!({ "designs": summaries })))?;
    }
    Ok(())
}

pub(super) fn craft(path: &Path, out: &Path) -> Result<(), Failure> {
    let text = String::from_utf8_lossy(&read(path)?).into_owned();
    // A vehicle has a body, a design none.
    let is_vehicle = text.lines().any(|line| line.trim() == "[body]");
    let certified = if is_vehicle {
        let vehicle = vehicles::from_file(path).map_err(Failure::input)?;
        standard_design(&vehicle).and_then(|design| design.certify()).map_err(|error| failed(path, &error))?
    } else {
        certified(path)?
    };
    let made = if out.extension().is_some_and(|ending| ending == "bin") {
        own_craft(&certified).map(|own| own.to_bytes().to_vec())
    } else {
        craft_header(&certified).map(String::into_bytes)
    };
    let made = made.map_err(|error| Failure::input(format!("{}: {error}", path.display())))?;
    output::write(out, &made)?;
    let (vehicle, document) = (&certified.design.vehicle, gains::json_document(&certified));
    let cascade = certified.table.as_ref().and_then(gains::Table::cascade);
    let [from_ms, to_ms] = cascade.map_or([0.0; 2], |table| table.certified.motor_lag_s.map(|lag_s| 1e3 * lag_s));
    let mut text = format!(
        "{}: {} kg, motors of {} ms, certified for {from_ms} to {to_ms} ms\n{}",
        vehicle.name(),
        vehicle.mass_kg(),
        1e3 * vehicle.motors().lag_s,
        figures(&document)
    );
    wrote(&mut text, out);
    output::print(&text)
}

/// Notes for an owner about the method.
fn notes(certified: &Certified) -> String {
    let mut text = unscaled(&certified.design).map_or_else(String::new, |note| format!("  {note}\n"));
    if let Problem::Cascade { region_from, .. } = &certified.design.problem
        && !region_from.is_empty()
    {
        let taken: Vec<&str> = region_from.iter().map(|bound| bound.figure).collect();
        let _ = writeln!(text, "  its region is that of the vehicle's identified intervals: {}", taken.join(", "));
    }
    text
}

/// Every figure that a design can ask for, beside the minimum of this one.
pub(super) fn figures(document: &Value) -> String {
    let mut text = String::new();
    for figure in document["figures"].as_array().into_iter().flatten() {
        let unit = figure["unit"].as_str().unwrap_or_default();
        let told = |value: f64| format!("{value} {unit}").trim_end().to_owned();
        let found = figure["found"].as_f64().map_or_else(|| "unlimited".to_owned(), told);
        let asked = figure["asked"].as_f64().map_or_else(String::new, |asked| format!("  at least {}", told(asked)));
        let name = figure["figure"].as_str().unwrap_or_default();
        let _ = writeln!(text, "  {name:<50} {found:>16}{asked}");
    }
    text
}
