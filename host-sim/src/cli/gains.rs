//! `quatrack gains`: design files in; tables, their check and their figures out.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use clap::Subcommand;
use quatrack::gains::table::{GainTable, ScheduleTable, TableError, TableHead, TableKind};
use quatrack_sim::gains::{self, Certified, Checked, Design, Failed, GainsError, Signal};
use serde::Serialize;
use serde_json::{Value, json};

use super::{Failure, output};

/// Where designs stand unless told otherwise.
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
    /// Computes everything again and compares it with the files that are there: tables byte for byte, figures to 1e-6.
    ///
    /// Exit code 1 with the first difference of each file.
    Check {
        /// Folders of designs, or designs [default: gains]
        #[arg(value_name = "DIR|FILE")]
        paths: Vec<PathBuf>,
        /// Write what was found, as JSON.
        #[arg(long, value_name = "FILE")]
        json: Option<PathBuf>,
    },
    /// Prints a table and its certificate.
    Show {
        /// A design (TOML), or what was made of one (JSON or binary).
        #[arg(value_name = "FILE")]
        file: PathBuf,
        /// Write all of it as JSON.
        #[arg(long, value_name = "FILE")]
        json: Option<PathBuf>,
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
        Command::Check { paths, json } => check(paths, json.as_deref()),
        Command::Show { file, json } => show(file, json.as_deref()),
        Command::List { folder, json } => list(folder.as_deref(), json.as_deref()),
    }
}

/// Reads, computes and certifies a design.
fn certified(path: &Path) -> Result<Certified, Failure> {
    Design::from_file(path).and_then(|design| design.certify()).map_err(|error| failed(path, &error))
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
        for file in gains::artifacts(&certified, &folder) {
            output::write(&file.path, &file.contents)?;
            wrote(&mut text, &file.path);
        }
        if certified.table.is_none() {
            text += "  no table: no law on board remembers its last commands, so delay_samples above 0 has gains and a \
                     certificate only\n";
        }
        output::print(&text)?;
        summaries.push(json!({ "design": path, "name": document["name"], "figures": document["figures"] }));
    }
    if let Some(path) = json {
        output::write_json(path, &summaries)?;
    }
    Ok(())
}

/// Every figure that a design can ask for, beside what this one asks.
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

fn check(paths: &[PathBuf], json: Option<&Path>) -> Result<(), Failure> {
    let default = [PathBuf::from(FOLDER)];
    let paths = if paths.is_empty() { require_folder(Path::new(FOLDER)).map(|()| &default[..])? } else { paths };
    let mut checked: Vec<Checked> = Vec::new();
    for path in paths {
        let found = if path.is_dir() { gains::check_folder(path) } else { check_file(path) };
        checked.extend(found.map_err(|Failed { path, error }| failed(&path, &error))?);
    }
    if checked.is_empty() {
        return Err(Failure::input(format!(
            "{}: no design here; designs are files ending in .toml",
            paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
        )));
    }
    if let Some(path) = json {
        let files: Vec<Value> =
            checked.iter().map(|file| json!({ "file": file.path, "difference": file.difference })).collect();
        output::write_json(path, &files)?;
    }
    let differing: Vec<&Checked> = checked.iter().filter(|file| file.difference.is_some()).collect();
    match differing.split_first() {
        None => output::print(&format!("{} files are what their designs give\n", checked.len())),
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
        "{}: no such folder here; run this where one stands, as in a checkout, or name a folder of designs",
        folder.display()
    )))
}

fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    fs::read(path).map_err(|error| Failure::input(format!("{}: cannot be read ({error})", path.display())))
}

fn show(path: &Path, json: Option<&Path>) -> Result<(), Failure> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let (text, document) = match extension.as_str() {
        "toml" => {
            let document = gains::json_document(&certified(path)?);
            (of_document(&document), document)
        }
        "json" => {
            let document: Value = serde_json::from_slice(&read(path)?)
                .map_err(|error| Failure::input(format!("{}: no JSON ({error})", path.display())))?;
            if document.get("certificate_sha256").is_none() {
                let reason = "not made by `quatrack gains design`: certificate_sha256 is missing";
                return Err(Failure::input(format!("{}: {reason}", path.display())));
            }
            (of_document(&document), document)
        }
        "bin" => {
            let table =
                Binary::read(&read(path)?).map_err(|error| Failure::input(format!("{}: {error}", path.display())))?;
            (of_table(&table), table_json(&table))
        }
        _ => {
            let reason = "neither a design (.toml) nor made of one (.json, .bin)";
            return Err(Failure::input(format!("{}: {reason}", path.display())));
        }
    };
    output::print(&text)?;
    json.map_or(Ok(()), |path| output::write_json(path, &document))
}

/// What a document says of its design and its gains.
fn of_document(document: &Value) -> String {
    let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let mut out = format!("{}: {}\n", text(&document["name"]), text(&document["description"]).replace('\n', " "));
    let design = &document["design"];
    let _ = writeln!(
        out,
        "  for {} (id {}) at {} Hz, {} {}",
        text(&design["vehicle"]),
        text(&design["vehicle_id"]),
        design["control_rate_hz"],
        text(&design["linearisation"]),
        text(&design["method"]),
    );
    let _ = writeln!(
        out,
        "  thrust {} m/s^2, body rates {} rad/s\n  design      {}\n  certificate {}\n",
        design["thrust_m_s2"],
        design["body_rates_max_rad_s"],
        text(&document["design_sha256"]),
        text(&document["certificate_sha256"]),
    );
    let gain = &document["gain"];
    let names = |signals: &Value| -> Vec<String> {
        signals.as_array().into_iter().flatten().map(|signal| text(&signal["name"])).collect()
    };
    let entries = |k: &Value| -> Vec<Vec<f64>> {
        let numbers = |row: &Value| row.as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
        k.as_array().into_iter().flatten().map(numbers).collect()
    };
    let (rows, columns) = (names(&gain["rows"]), names(&gain["columns"]));
    let knots = &gain["knots"];
    if knots.is_object() {
        let gains: Vec<_> = gain["k"].as_array().into_iter().flatten().map(entries).collect();
        let _ = writeln!(out, "  {}", told_knots(gains.len(), &knots["steps_per_knot"], &knots["trajectory"]));
        out += &over_time(&rows, &columns, &gains);
    } else {
        out += &matrix(&rows, &columns, &entries(&gain["k"]));
    }
    out + "\n" + &figures(document)
}

fn told_knots(count: usize, steps_per_knot: &Value, trajectory: &Value) -> String {
    let trajectory = trajectory.as_str().unwrap_or_default();
    format!("{count} knots, one in {steps_per_knot} control steps, for the trajectory {trajectory}")
}

/// The gain that is flown behind the last knot, and the one furthest from it.
fn over_time(rows: &[String], columns: &[String], gains: &[Vec<Vec<f64>>]) -> String {
    let Some(last) = gains.last() else { return String::new() };
    let distance = |gain: &[Vec<f64>]| -> f64 {
        let pairs = gain.iter().flatten().zip(last.iter().flatten());
        pairs.map(|(entry, last)| (entry - last).powi(2)).sum()
    };
    let mut out = format!("\n  the last, flown from there on\n{}", matrix(rows, columns, last));
    let furthest = gains.iter().enumerate().max_by(|(_, x), (_, y)| distance(x).total_cmp(&distance(y)));
    if let Some((knot, gain)) = furthest {
        let _ = write!(out, "\n  knot {knot}, furthest from it\n{}", matrix(rows, columns, gain));
    }
    out
}

/// A binary table of either form.
enum Binary {
    Fixed(GainTable),
    OverTime { head: TableHead, steps_per_knot: u16, trajectory: u32, gains: Vec<[[f32; 9]; 4]> },
}

impl Binary {
    fn read(bytes: &[u8]) -> Result<Self, TableError> {
        if TableKind::of(bytes)? != TableKind::AlongTrajectory {
            return GainTable::from_bytes(bytes).map(Self::Fixed);
        }
        let table = ScheduleTable::from_bytes(bytes)?;
        let schedule = table.schedule();
        Ok(Self::OverTime {
            head: *table.head(),
            steps_per_knot: schedule.steps_per_knot(),
            trajectory: schedule.trajectory(),
            gains: (0..schedule.knots()).filter_map(|knot| schedule.gain(knot)).collect(),
        })
    }

    fn head(&self) -> &TableHead {
        match self {
            Self::Fixed(table) => table.head(),
            Self::OverTime { head, .. } => head,
        }
    }

    fn kind(&self) -> TableKind {
        match self {
            Self::Fixed(table) => table.kind(),
            Self::OverTime { .. } => TableKind::AlongTrajectory,
        }
    }
}

/// The entries of one gain by rows.
fn by_rows(entries: &[f32], columns: usize) -> Vec<Vec<f32>> {
    entries.chunks(columns).map(<[f32]>::to_vec).collect()
}

/// What a binary table says.
fn of_table(table: &Binary) -> String {
    let (head, certificate) = (table.head(), &table.head().certificate);
    let rates = head.limits.body_rates_max_rad_s();
    let (one, all) = (&certificate.one_channel, &certificate.all_channels);
    let mut out = format!(
        "{}: {} table for {} at {} Hz\n\
         \x20 thrust {} to {} m/s^2, body rates {} {} {} rad/s\n\
         \x20 design      {}\n\x20 certificate {}\n\n",
        head.name,
        table.kind(),
        head.vehicle,
        head.rate.hz(),
        head.limits.thrust_min_m_s2(),
        head.limits.thrust_max_m_s2(),
        rates.x,
        rates.y,
        rates.z,
        head.design_hash,
        certificate.hash,
    );
    let (rows, columns) = gains::signals(table.kind());
    let names = |signals: &[Signal]| signals.iter().map(|signal| signal.name.to_owned()).collect::<Vec<_>>();
    let (rows, columns) = (names(rows), names(columns));
    let entries = |entries: &[f32]| -> Vec<Vec<f64>> {
        entries.chunks(columns.len()).map(|row| row.iter().map(|k| f64::from(*k)).collect()).collect()
    };
    match table {
        Binary::Fixed(table) => out += &matrix(&rows, &columns, &entries(table.rows().entries())),
        Binary::OverTime { steps_per_knot, trajectory, gains, .. } => {
            let trajectory = format!("{trajectory:08x}").into();
            let _ = writeln!(out, "  {}", told_knots(gains.len(), &(*steps_per_knot).into(), &trajectory));
            let gains: Vec<_> = gains.iter().map(|gain| entries(gain.as_flattened())).collect();
            out += &over_time(&rows, &columns, &gains);
        }
    }
    let _ = write!(
        out,
        "\n  gain margin of one channel                     {:>16}\n\
         \x20 phase margin of one channel, deg               {:>16.3}\n\
         \x20 gain margin of all channels at once            {:>16}\n\
         \x20 phase margin of all channels at once, deg      {:>16.3}\n\
         \x20 largest delay, ms                              {:>16}\n\
         \x20 largest motor lag, ms                          {:>16}\n\
         \x20 distance from the f64 gains                    {:>16e}\n",
        one.gain_factor,
        one.phase_rad.to_degrees(),
        all.gain_factor,
        all.phase_rad.to_degrees(),
        certificate.delay_max_s * 1e3,
        certificate.motor_lag_max_s * 1e3,
        certificate.f32_distance,
    );
    out
}

fn table_json(table: &Binary) -> Value {
    let (head, certificate) = (table.head(), &table.head().certificate);
    let rates = head.limits.body_rates_max_rad_s();
    let columns = usize::from(table.kind().dimensions().1);
    let mut document = json!({
        "name": head.name.as_str(),
        "kind": table.kind().to_string(),
        "vehicle": head.vehicle.name.as_str(),
        "vehicle_id": format!("{:08x}", head.vehicle.id),
        "control_rate_hz": head.rate.hz(),
        "thrust_m_s2": [head.limits.thrust_min_m_s2(), head.limits.thrust_max_m_s2()],
        "body_rates_max_rad_s": [rates.x, rates.y, rates.z],
        "design_sha256": head.design_hash.to_string(),
        "certificate_sha256": certificate.hash.to_string(),
        "one_channel": {
            "gain_factor": certificate.one_channel.gain_factor, "phase_rad": certificate.one_channel.phase_rad,
        },
        "all_channels": {
            "gain_factor": certificate.all_channels.gain_factor, "phase_rad": certificate.all_channels.phase_rad,
        },
        "delay_max_s": certificate.delay_max_s,
        "motor_lag_max_s": certificate.motor_lag_max_s,
        "f32_distance": certificate.f32_distance,
    });
    document["k_f32"] = match table {
        Binary::Fixed(table) => json!(by_rows(table.rows().entries(), columns)),
        Binary::OverTime { steps_per_knot, trajectory, gains, .. } => {
            document["steps_per_knot"] = json!(steps_per_knot);
            document["trajectory"] = json!(format!("{trajectory:08x}"));
            gains.iter().map(|gain| json!(by_rows(gain.as_flattened(), columns))).collect()
        }
    };
    document
}

/// A matrix with a line for each row; zeros as dots, so that its structure shows.
fn matrix(rows: &[String], columns: &[String], entries: &[Vec<f64>]) -> String {
    let mut out = format!("  {:<8}", "");
    for column in columns {
        let _ = write!(out, "{column:>10}");
    }
    out.push('\n');
    for (name, row) in rows.iter().zip(entries) {
        let _ = write!(out, "  {name:<8}");
        for value in row {
            let cell = if *value == 0.0 { ".".to_owned() } else { format!("{value:.4}") };
            let _ = write!(out, "{cell:>10}");
        }
        out.push('\n');
    }
    out
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
    json.map_or(Ok(()), |path| output::write_json(path, &entries))
}
