//! The files of a certified design: JSON with the f64 gains and every figure, Rust with the f32 table, and the binary
//! table.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use nalgebra::DMatrix;
use quatrack::cascade::Air;
use quatrack::gains::table::{CascadeTable, TableKind};
use quatrack_design::certify::{Judged, judge};
use serde_json::{Value, json};

use super::certified::Certified;
use super::kinds::Gains;
use super::names::signals;
use super::rounding::{rounded, without_dust};
use super::table::Table;

/// A file to be written or compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Artifact {
    /// Its path.
    pub path: PathBuf,
    /// Its bytes.
    pub contents: Vec<u8>,
}

/// Keys of the document whose numbers are figures of the certificate.
pub(super) const FIGURES: [&str; 3] = ["figures", "certificate", "region"];

/// The folder beside a design that its files are written to.
pub fn default_folder(design: &Path) -> PathBuf {
    design.parent().unwrap_or(Path::new("")).join("generated")
}

/// Every file of a design, for a folder: NAME.json, NAME.rs and NAME.bin; the JSON alone where no law on board flies it.
pub fn artifacts(certified: &Certified, folder: &Path) -> Vec<Artifact> {
    let file = |extension: &str, contents: Vec<u8>| Artifact {
        path: folder.join(format!("{}.{extension}", certified.design.name)),
        contents,
    };
    let mut files = vec![file("json", format!("{:#}\n", json_document(certified)).into_bytes())];
    if let Some(bytes) = certified.to_bytes() {
        files.push(file("rs", rust_source(certified).into_bytes()));
        files.push(file("bin", bytes));
    }
    files
}

/// The document with every figure in full.
pub(super) fn document(certified: &Certified) -> Value {
    let Certified { design, designed, .. } = certified;
    let past: Vec<Value> = designed.past_command_gains.iter().map(by_rows).collect();
    let (rows, columns) = match designed.gains {
        Gains::Cascade(_) => signals(TableKind::Cascade),
        _ => (designed.model.inputs, designed.model.states),
    };
    let mut gain = json!({
        "rows": rows,
        "columns": columns,
        "k": by_rows(&designed.gains.dense()),
        "past_command_gains": past,
        "relative_residual_of_p_below": residual_bound(designed.relative_residual),
    });
    if let (Gains::Along(along), Some((trajectory, steps_per_knot))) = (&designed.gains, design.problem.schedule()) {
        gain["k"] =
            along.gains.iter().map(|gain| by_rows(&DMatrix::from_column_slice(4, 9, gain.as_slice()))).collect();
        gain["knots"] = json!({
            "count": along.gains.len(),
            "steps_per_knot": steps_per_knot,
            "spacing_s": along.spacing_s,
            "trajectory": format!("{trajectory:08x}"),
        });
    }
    let mut document = json!({
        "name": design.name.as_str(),
        "description": design.description,
        "design": design.essence(),
        "design_sha256": certified.design_hash.to_string(),
        "gain": gain,
        "figures": figures(certified),
        "certificate": without_dust(json!(certified.certificate)),
        "statement": certified.statement,
        "certificate_sha256": certified.statement.hash().to_string(),
    });
    if let Some(region) = &certified.cascade_region {
        document["region"] = json!(region);
    }
    if let Some(region) = &certified.region {
        document["region"] = json!(region);
    }
    document
}

/// Every figure that a design can ask for, in the design's units, beside the minimum of this one. No limit is null.
fn figures(certified: &Certified) -> Value {
    let judged = judge(&certified.certificate, &certified.design.minimum).into_iter();
    let figure = |Judged { figure, quantity, found, asked }: Judged| {
        let (found, unit) = quantity.in_unit(found);
        json!({ "figure": figure, "unit": unit, "found": found, "asked": asked.map(|asked| quantity.in_unit(asked).0) })
    };
    judged.map(figure).collect()
}

/// The document as it is written: figures to six digits.
pub fn json_document(certified: &Certified) -> Value {
    let mut document = document(certified);
    for key in FIGURES {
        if let Some(figures) = document.get_mut(key) {
            *figures = rounded(figures.take());
        }
    }
    document
}

/// The table as a Rust constant with the name of the design.
pub fn rust_source(certified: &Certified) -> String {
    let design = &certified.design;
    let mut text = format!(
        "// {} for {} at {} Hz: made by `quatrack gains design` and not edited by hand.\n\
         // Design {}\n// Certificate {}\n\n",
        design.name,
        design.vehicle.name(),
        design.rate.hz(),
        certified.design_hash,
        certified.statement.hash(),
    );
    let description = if design.description.is_empty() { "A gain table." } else { &design.description };
    for line in description.lines() {
        let _ = writeln!(text, "/// {}", line.trim());
    }
    let name = constant_name(design.name.as_str());
    let rows = certified.designed.gains.by_rows();
    let kind = match &certified.designed.gains {
        Gains::Equilibrium(_) => "EquilibriumGain",
        Gains::FlatOutput(_) => "FlatOutputGain",
        Gains::Integral(_) => "IntegralGain",
        Gains::ActuatorAware(_) => "ActuatorAwareGain",
        Gains::Cascade(_) => {
            let table = certified.table.as_ref().and_then(Table::cascade);
            text += &table.map_or_else(String::new, |table| {
                let kind = "quatrack::gains::table::CascadeTable";
                format!("#[rustfmt::skip]\npub static {name}: {kind} = {};\n", cascade_source(table, "quatrack"))
            });
            return text;
        }
        Gains::Along(_) => {
            let (trajectory, steps_per_knot) = design.problem.schedule().unwrap_or_default();
            let kind = "quatrack::gains::table::ScheduleRows";
            let _ = write!(
                text,
                "#[rustfmt::skip]\npub static {name}: {kind}<'static> = {kind} {{\n    trajectory: 0x{trajectory:08x},\n\
                 \x20   steps_per_knot: {steps_per_knot},\n    gains: &[\n"
            );
            for knot in rows.chunks(4) {
                text.push_str("        [\n");
                for row in knot {
                    let _ = writeln!(text, "            {row:?},");
                }
                text.push_str("        ],\n");
            }
            text.push_str("    ],\n};\n");
            return text;
        }
    };
    let _ =
        write!(text, "#[rustfmt::skip]\npub static {name}: quatrack::law::{kind} = quatrack::law::{kind}::table([\n");
    for row in rows {
        let _ = writeln!(text, "    {row:?},");
    }
    text.push_str("]);\n");
    text
}

/// A table of the cascade as Rust writes it, with the paths of the crate that is called so, or of the items in scope.
pub(super) fn cascade_source(table: &CascadeTable, of: &str) -> String {
    let (tables, cascade) = match of {
        "" => (String::new(), String::new()),
        of => (format!("{of}::gains::table::"), format!("{of}::cascade::")),
    };
    let CascadeTable { gains, motor_lag_s, air, certified } = table;
    let Air { drag_per_s, drag_along_share, moment_n_s, gust, learn } = air;
    let range = certified;
    format!(
        "{tables}CascadeTable {{\n    \
             gains: {cascade}CascadeGains::table({:?}),\n    \
             motor_lag_s: {motor_lag_s:?},\n    \
             air: {cascade}Air {{\n        \
                 drag_per_s: {drag_per_s:?},\n        \
                 drag_along_share: {drag_along_share:?},\n        \
                 moment_n_s: {moment_n_s:?},\n        \
                 gust: {gust:?},\n        \
                 learn: {learn:?},\n    \
             }},\n    \
             certified: {tables}CascadeRange {{\n        \
                 motor_lag_s: {:?},\n        \
                 mass_share: {:?},\n        \
                 inertia_share: {:?},\n        \
                 force_share: {:?},\n        \
                 delay_s: {:?},\n        \
                 drag_per_s: {:?},\n        \
                 moment_n_s: {:?},\n    \
             }},\n}}",
        gains.numbers(),
        range.motor_lag_s,
        range.mass_share,
        range.inertia_share,
        range.force_share,
        range.delay_s,
        range.drag_per_s,
        range.moment_n_s,
    )
}

/// `lqr-e` as `LQR_E`.
fn constant_name(name: &str) -> String {
    let upper: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' }).collect();
    if upper.starts_with(|c: char| c.is_ascii_digit()) { format!("TABLE_{upper}") } else { upper }
}

/// A matrix as its rows.
pub(super) fn by_rows(m: &DMatrix<f64>) -> Value {
    Value::from(m.row_iter().map(|row| Value::from(row.iter().copied().collect::<Vec<f64>>())).collect::<Vec<_>>())
}

/// A residual is rounding and differs between processors: it is told as the power of ten that it is below.
fn residual_bound(residual: f64) -> f64 {
    // A decade above the smallest that f64 can mean.
    if residual < 1e-14 { 1e-14 } else { format!("1e{}", residual.log10().floor() as i32 + 1).parse().unwrap_or(1.0) }
}
