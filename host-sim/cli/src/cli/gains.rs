//! `quatrack gains`: design files in; tables, their check and their figures out.

mod check;
mod design;
mod list;
mod show;
mod sign;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::Subcommand;
use quatrack_plan::bounded;
use quatrack_simulation::gains::GainsError;

use super::{Failure, output};
use check::{check, generate};
use design::{certified, craft, design, figures};
use list::list;

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
        json: Option<output::File>,
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
        json: Option<output::File>,
    },
    /// Prints a table and its certificate.
    Show {
        /// A design (TOML), or a file made of one (JSON or binary).
        #[arg(value_name = "FILE")]
        file: PathBuf,
        /// Write all of it as JSON.
        #[arg(long, value_name = "FILE")]
        json: Option<output::File>,
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
        out: output::File,
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
        json: Option<output::File>,
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

/// How an error of a design ends the command: 1 where the answer is no, 2 where the file cannot be used.
pub(super) fn failed(path: &Path, error: &GainsError) -> Failure {
    let line = format!("{}: {error}", path.display());
    if error.is_verdict() { Failure::verdict(line) } else { Failure::input(line) }
}

fn wrote(text: &mut String, path: &Path) {
    let _ = writeln!(text, "wrote {}", path.display());
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
