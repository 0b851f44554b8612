//! `quatrack measure`: images in; instructions a step, flash, RAM and stack out, for a person and as JSON.

use std::path::PathBuf;

use super::{Failure, output};
use crate::pil::PilError;
use crate::pil::image::{self, Image};
use crate::pil::measure::{self, Images, InstructionReport};

/// Counts instructions on the emulated target, over both of the paper's flights with all four controllers: each law's
/// step, the reference, the whole tick; and the firmware's flash and RAM.
///
/// Every state is counted as it was flown and at its worst: errors in the heading frame of a turning reference, with and
/// without feed-forward, nothing limited and everything, either sign of the quaternion; and with a gain without a zero.
/// Every command is compared with the host's. The estimator is counted by an image of its own, prediction and update.
///
/// Builds its six images inside a checkout. An instruction is not a cycle: the counts compare programs, not clocks.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folder with the six images (quatrack-measure, quatrack-control-path, quatrack-motor-path, quatrack-measure-estimator,
    /// quatrack-measure-link, quatrack-firmware-pipes), or one of them in it, instead of building them.
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
    /// Write the figures as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<output::File>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    // Every reason why an image does not run is for the user to mend.
    let report = counted(args).map_err(Failure::input)?;
    output::print(&report.to_string())?;
    if let Some(path) = &args.json {
        output::write_json(path, &output::Named::new("measure", &report))?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    Ok(())
}

fn counted(args: &Args) -> Result<InstructionReport, PilError> {
    let images = match &args.image {
        Some(path) => {
            let folder = if path.is_dir() { path.as_path() } else { path.parent().unwrap_or(path) };
            let [counting, control_path, motor_path, estimator, link, flying] = [
                Image::Measure,
                Image::ControlPath,
                Image::MotorPath,
                Image::MeasureEstimator,
                Image::MeasureLink,
                Image::Pipes,
            ]
            .map(|image| folder.join(image.binary()));
            Images { counting, control_path, motor_path, estimator, link, flying }
        }
        None => {
            let checkout = image::checkout_for_image()?;
            let build = |image| image::build(&checkout, image);
            Images {
                control_path: build(Image::ControlPath)?,
                motor_path: build(Image::MotorPath)?,
                counting: build(Image::Measure)?,
                estimator: build(Image::MeasureEstimator)?,
                link: build(Image::MeasureLink)?,
                flying: build(Image::Pipes)?,
            }
        }
    };
    measure::count(&images, None)
}
