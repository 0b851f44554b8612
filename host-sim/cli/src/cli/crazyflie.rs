//! `quatrack crazyflie`: the controller as the Crazyflie's firmware calls it, flown and counted.

use std::path::PathBuf;

use quatrack_cli::pil::crazyflie::count;
use quatrack_cli::pil::image;
use quatrack_simulation::crazyflie::CrazyflieReport;
use quatrack_simulation::vehicles;

use super::{Failure, output};

/// Flies the Crazyflie controller through its C interface on the rigid plant, with the firmware's setpoints, rates and
/// power distribution: position errors of every course and case.
///
/// With --count, builds the object for the firmware inside a checkout, runs it on the emulated Cortex-M4, counts the
/// instructions of every call and compares every bit of what it puts out with the host's.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The craft: crazyflie-2.1, crazyflie-2.1-upgrade-kit or crazyflie-2.1-brushless.
    #[arg(long, value_name = "NAME", default_value = "crazyflie-2.1")]
    vehicle: String,
    /// Count instructions instead of flying.
    #[arg(long, conflicts_with = "vehicle")]
    count: bool,
    /// Write the figures as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    if args.count {
        let counts = image::checkout().and_then(|checkout| count(&checkout)).map_err(Failure::input)?;
        return report(args, &counts);
    }
    let vehicle = vehicles::by_name(&args.vehicle).map_err(Failure::input)?;
    report(args, &CrazyflieReport::of(&vehicle).map_err(Failure::input)?)
}

fn report(args: &Args, figures: &(impl std::fmt::Display + serde::Serialize)) -> Result<(), Failure> {
    output::print(&figures.to_string())?;
    if let Some(path) = &args.json {
        output::write_json(path, figures)?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    Ok(())
}
