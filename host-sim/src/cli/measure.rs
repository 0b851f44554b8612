//! `quatrack measure`: an image in; instructions a step, flash and RAM out, for a person and as JSON.

use std::path::PathBuf;

use quatrack_sim::pil::image::{self, Image};
use quatrack_sim::pil::{PilError, measure};

use super::{Failure, output};

/// Counts instructions on the emulated target, over both of the paper's flights with all four controllers: each law's
/// step, the reference, the whole tick; and what the control path takes in flash and RAM.
///
/// Builds its images inside a checkout. An instruction is not a cycle: the counts compare programs, not clocks.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// An image that counts, instead of building one; flash and RAM are then that image's own.
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
    /// Write the figures as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let report = counted(args).map_err(failed)?;
    output::print(&report.to_string())?;
    if let Some(path) = &args.json {
        output::write_json(path, &report)?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    Ok(())
}

fn counted(args: &Args) -> Result<measure::Report, PilError> {
    if let Some(path) = &args.image {
        return measure::count(path, image::size(path)?);
    }
    let checkout = image::checkout()?;
    let control_path = image::build(&checkout, Image::ControlPath)?;
    let counting = image::build(&checkout, Image::Measure)?;
    measure::count(&counting, image::size(&control_path)?)
}

/// Whatever keeps an image from being run is for the user to mend: exit code 2.
fn failed(error: PilError) -> Failure {
    Failure::input(error)
}
