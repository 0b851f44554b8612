//! `quatrack export`: a design in; its matrices for other tools out, as JSON or CSV.

use std::path::Path;

use clap::ValueEnum;
use quatrack_simulation::gains::{Design, Export};

use super::names::did_you_mean;
use super::{Failure, gains, output};

/// Writes A, B, Q, R, K, P, the poles and T_e of a design, with the names and units of every row and column.
///
/// Examples:
///   quatrack export --format json --design lqr-e --out lqr-e.json
///   quatrack export --format csv --design gains/sampled-lqr-e.toml
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Args {
    /// One of the paper's designs (lyap-f, lyap-e, lqr-f, lqr-e) or the file of any design (TOML).
    #[arg(long, value_name = "NAME|FILE", default_value = "lqr-e")]
    design: String,
    /// JSON, a matrix by its rows; or CSV, an entry a line.
    #[arg(long, value_enum)]
    format: Format,
    /// Write to this file instead of standard output.
    #[arg(long, value_name = "FILE")]
    out: Option<output::File>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    Json,
    Csv,
}

/// The paper's designs, built in.
const PAPER: [(&str, &str); 4] = [
    ("lyap-f", include_str!("../../../../gains/lyap-f.toml")),
    ("lyap-e", include_str!("../../../../gains/lyap-e.toml")),
    ("lqr-f", include_str!("../../../../gains/lqr-f.toml")),
    ("lqr-e", include_str!("../../../../gains/lqr-e.toml")),
];

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let lower = args.design.to_lowercase();
    let path = Path::new(&args.design);
    let design = match PAPER.iter().find(|(name, _)| *name == lower) {
        Some((name, text)) => Design::from_toml(name, text, Path::new("")),
        None if path.extension().is_some_and(|extension| extension == "toml") => Design::from_file(path),
        None => {
            let names = PAPER.map(|(name, _)| name).join(", ");
            return Err(Failure::input(format!(
                "--design {}: neither one of {names} nor a design, a file ending in .toml{}",
                args.design,
                did_you_mean(&args.design, PAPER.map(|(name, _)| name))
            )));
        }
    };
    let export = design.and_then(|design| Export::of(&design)).map_err(|error| gains::failed(path, &error))?;
    let text = match args.format {
        Format::Csv => export.to_csv(),
        Format::Json => format!("{:#}\n", export.to_json()),
    };
    match &args.out {
        None => output::print(&text),
        Some(path) => {
            output::write(path, text.as_bytes())?;
            output::print(&format!("wrote {}\n", path.display()))
        }
    }
}
