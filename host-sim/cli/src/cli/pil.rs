//! `quatrack pil`: an image in an emulator, or a board on a port, in; the flights that it commanded, and whether every
//! bit of its commands is the host's, out.

use std::path::PathBuf;

use clap::{ArgGroup, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use quatrack::link::Key;

use super::{Failure, key_file, output};
use crate::pil::client::Client;
use crate::pil::emulated::{self, Equipment, Transport};
use crate::pil::interrupt::Interrupt;
use crate::pil::line::Line;
use crate::pil::{PilError, image, lock_step};

/// Flies both of the paper's trajectories with all four controllers on the target, in lock-step with the plant on this
/// host, and compares every command with the same core's here.
///
/// Exit code 1 where a bit differs; the first differing step is shown.
///
/// Examples:
///   quatrack pil --emulator
///   quatrack pil --emulator --transport usart --steps 500
///   quatrack pil --port /dev/ttyUSB0
///   quatrack pil --port /dev/ttyUSB0 --key-file ~/keys/craft
#[derive(clap::Args)]
#[command(verbatim_doc_comment, group(ArgGroup::new("board").required(true).args(["emulator", "port"])))]
pub(crate) struct Args {
    /// Fly on an emulated STM32F405 (QEMU), with an image that is built first.
    #[arg(long)]
    emulator: bool,
    /// Fly on the board at this serial port, 1 Mbaud. Motors stay off.
    #[arg(long, value_name = "DEVICE")]
    port: Option<PathBuf>,
    /// How the emulated board is talked to: pipes are fast, usart is the real line.
    #[arg(long, value_enum, default_value_t = TransportName::Pipes, requires = "emulator")]
    transport: TransportName,
    /// Emulate this image, made for the same transport, instead of building one.
    #[arg(long, value_name = "FILE", requires = "emulator")]
    image: Option<PathBuf>,
    /// Fly only so many steps in all, spread evenly over the eight flights; there is no IAE then.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    steps: Option<u32>,
    /// Write the image's log over the pipes, for `defmt-print -e IMAGE < FILE`; a board's log is read by its probe.
    #[arg(long, value_name = "FILE", requires = "emulator")]
    log: Option<PathBuf>,
    /// The file of the key that the board was given (`quatrack keys`), 64 hexadecimal digits.
    #[arg(long, value_name = "FILE")]
    key_file: Option<PathBuf>,
    /// Keep uploads of the emulated board in this file, which is made where it is missing.
    #[arg(long, value_name = "FILE", requires = "emulator", conflicts_with = "port")]
    flash: Option<PathBuf>,
    /// Write the figures as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<output::File>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum TransportName {
    Pipes,
    Usart,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let key = args.key_file.as_deref().map(key_file::read).transpose()?.map(|bytes| Key::new(&bytes));
    let report = flown(args, key).map_err(Failure::input)?;
    output::print(&report.to_string())?;
    if let Some(path) = &args.json {
        output::write_json(path, &output::Named::new("pil", &report))?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    if report.bit_exact && report.motors.bit_exact {
        Ok(())
    } else {
        Err(Failure::verdict("the target's commands are not the host's"))
    }
}

fn flown(args: &Args, key: Option<Key>) -> Result<lock_step::LockStepReport, PilError> {
    let interrupt = Interrupt::listen()?;
    let mut client = match &args.port {
        Some(port) => Client::connect(Line::open_port(port)?, None, key, interrupt)?,
        None => emulated(args, key, interrupt)?,
    };
    let bar = ProgressBar::new(lock_step::step_count(args.steps));
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} steps, {per_sec}, {eta} left") {
        bar.set_style(style);
    }
    let report = lock_step::fly_all(&mut client, args.steps, &|| bar.inc(1));
    bar.finish_and_clear();
    report
}

/// A board in an emulator, on the image that is given or on one that is built.
fn emulated(args: &Args, key: Option<Key>, interrupt: Interrupt) -> Result<Client, PilError> {
    let transport = match args.transport {
        TransportName::Pipes => Transport::Pipes,
        TransportName::Usart => Transport::Usart,
    };
    let image = match &args.image {
        Some(path) => path.clone(),
        None => image::build(&image::checkout_for_image()?, transport.image())?,
    };
    if let Some(flash) = args.flash.as_deref().filter(|flash| !flash.exists()) {
        emulated::new_flash(flash)?;
    }
    let equipment = Equipment { log: args.log.as_deref(), flash: args.flash.as_deref(), key };
    emulated::connect(&image, transport, equipment, interrupt)
}
