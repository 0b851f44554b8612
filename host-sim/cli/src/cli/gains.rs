//! `quatrack gains`: design files in; tables, their check and their figures out.

mod show;
mod sign;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::Subcommand;
use quatrack_plan::bounded;
use quatrack_simulation::crazyflie::{craft_header, own_craft, standard_design, standard_force_input};
use quatrack_simulation::gains::{self, Certified, Checked, Design, Failed, GainsError, Problem};
use quatrack_simulation::generated::{self, GenerateError};
use quatrack_simulation::vehicles;
use serde::Serialize;
use serde_json::{Value, json};

use super::{Failure, output};

/// The folder of designs unless another is named.
const FOLDER: &str = "gains";

/// Designs gain tables, certifies them, and checks those that are committed.
#[derive(clap::Args)]
#[command(arg_required_else_help = true)]
pub(crate) struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Computes the gains of a design, certifies them as rounded to f32, and writes NAME.json (f64 gains and every
    /// figure), NAME.rs (the f32 table) and NAME.bin (the table that a board loads).
    ///
    /// A design that misses its own minimum is refused with the figure, its value and the minimum: exit code 1, nothing
    /// written.
    Design {
        /// Designs, TOML files; a file's name is its table's.
        #[arg(required = true, value_name = "FILE")]
        designs: Vec<PathBuf>,
        /// Folder to write to, created where it is missing [default: generated, beside the design]
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Write the figures that a design can ask for, as JSON.
        #[arg(long, value_name = "FILE")]
        json: Option<PathBuf>,
    },
    /// Writes every generated file that differs from its design's output: the tables of a folder and, in a checkout, the
    /// sources made of them: core/src/gains/paper.rs and cascade.rs, crazyflie/src/builtin/paper_limits.rs, plans/*.rs.
    ///
    /// A file that `check` passes stays as it is. Exit code 1 for a file that no design gives.
    Generate {
        /// Folders of designs [default: gains]
        #[arg(value_name = "DIR")]
        folders: Vec<PathBuf>,
    },
    /// Computes everything again and compares it with the files that are there: tables and sources byte for byte, figures
    /// and coefficients of plans to 1e-6. In a checkout these are all the files that `generate` writes.
    ///
    /// Exit code 1 with the first difference of each file.
    Check {
        /// Folders of designs, or designs [default: gains]
        #[arg(value_name = "DIR|FILE")]
        paths: Vec<PathBuf>,
        /// Write the differences, as JSON.
        #[arg(long, value_name = "FILE")]
        json: Option<PathBuf>,
    },
    /// Prints a table and its certificate.
    Show {
        /// A design (TOML), or a file made of one (JSON or binary).
        #[arg(value_name = "FILE")]
        file: PathBuf,
        /// Write all of it as JSON.
        #[arg(long, value_name = "FILE")]
        json: Option<PathBuf>,
        /// Of a design of the cascade: draw loop gain, sensitivity with the disk margin, and steps into a folder, as SVG and
        /// PNG.
        #[arg(long, value_name = "DIR")]
        plot: Option<PathBuf>,
    },
    /// Writes the header or file by which the Crazyflie's object flies a craft that it does not know, with a table of its own.
    ///
    /// Of a vehicle file the table is the standard cascade for it, certified over the same region as the built-in ones.
    /// Exit code 1 where that cannot be had: then write a design.
    Craft {
        /// A vehicle, or a design of the cascade for one: TOML files.
        #[arg(value_name = "FILE")]
        file: PathBuf,
        /// The header to write; with the ending .bin a file that crazyflie/tools/upload.py sends to a craft
        /// [default: quatrack_craft.h]
        #[arg(long, value_name = "FILE", default_value = "quatrack_craft.h", hide_default_value = true)]
        out: PathBuf,
    },
    /// Signs tables, for boards that take signed ones alone: NAME.bin becomes NAME.signed.bin.
    Sign {
        /// Tables, as `design` writes them.
        #[arg(required = true, value_name = "TABLE")]
        tables: Vec<PathBuf>,
        /// The file of the key to sign with (`quatrack keys new`).
        #[arg(long, value_name = "FILE")]
        key_file: PathBuf,
        /// Folder to write to [default: the table's]
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// Prints a line for each design of a folder.
    List {
        /// The folder [default: gains]
        #[arg(value_name = "DIR")]
        folder: Option<PathBuf>,
        /// Write the list as JSON.
        #[arg(long, value_name = "FILE")]
        json: Option<PathBuf>,
    },
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    match &args.command {
        Command::Design { designs, out, json } => design(designs, out.as_deref(), json.as_deref()),
        Command::Generate { folders } => generate(folders),
        Command::Check { paths, json } => check(paths, json.as_deref()),
        Command::Show { file, json, plot } => show::show(file, json.as_deref(), plot.as_deref()),
        Command::Craft { file, out } => craft(file, out),
        Command::Sign { tables, key_file, out } => sign::sign(tables, key_file, out.as_deref()),
        Command::List { folder, json } => list(folder.as_deref(), json.as_deref()),
    }
}

/// Reads, computes and certifies a design.
fn certified(path: &Path) -> Result<Certified, Failure> {
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

/// How an error of a design ends the command: 1 where the answer is no, 2 where the file cannot be used.
pub(super) fn failed(path: &Path, error: &GainsError) -> Failure {
    let line = format!("{}: {error}", path.display());
    if error.is_verdict() { Failure::verdict(line) } else { Failure::input(line) }
}

fn wrote(text: &mut String, path: &Path) {
    let _ = writeln!(text, "wrote {}", path.display());
}

fn design(paths: &[PathBuf], out: Option<&Path>, json: Option<&Path>) -> Result<(), Failure> {
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

fn craft(path: &Path, out: &Path) -> Result<(), Failure> {
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
fn figures(document: &Value) -> String {
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

fn generate(folders: &[PathBuf]) -> Result<(), Failure> {
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

fn check(paths: &[PathBuf], json: Option<&Path>) -> Result<(), Failure> {
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

fn require_folder(folder: &Path) -> Result<(), Failure> {
    if folder.is_dir() {
        return Ok(());
    }
    Err(Failure::input(format!(
        "{}: no such folder here; run this beside one, as in a checkout, or name a folder of designs",
        folder.display()
    )))
}

fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    bounded::read(path).map_err(|error| Failure::input(format!("{}: cannot be read ({error})", path.display())))
}

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

fn list(folder: Option<&Path>, json: Option<&Path>) -> Result<(), Failure> {
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
