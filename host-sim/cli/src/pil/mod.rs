//! The image on its processor, emulated or real: flights in; commands, instruction counts and verdicts out.
//!
//! ```text
//! faults           flights with something wrong, under an emulated board
//! lock_step        the paper's flights under the target's commands, compared with the host's
//!   motors         the same down to the motors, on a rigid craft
//! measure          instructions a step, flash, RAM
//! crazyflie        the same of the Crazyflie controller's object
//! estimator        the same of the estimator, and its stack
//! link             the same of the link's frames
//!   worst_case     inputs with which a step costs most, on the host
//!   flights        the paper's flights, flown by the core on the host
//!     bits         the compared bits, and their hash
//!     emulated     a board in an emulator
//!     client       a board behind its line
//!       emulator   the process that runs an image
//!       line       pipes or a serial port, with deadlines
//!       interrupt  Ctrl-C ends a wait
//!         image    built here, or given; its size in flash and RAM
//! ```

mod bits;
pub mod client;
pub mod crazyflie;
pub mod emulated;
pub mod emulator;
pub mod estimator;
pub mod faults;
pub mod flights;
pub mod image;
pub mod interrupt;
pub mod line;
pub mod link;
pub mod lock_step;
pub mod measure;
pub mod motors;
mod worst_case;

use std::io;
use std::path::PathBuf;

use thiserror::Error;

/// Why an image was not flown or counted.
#[derive(Debug, Error)]
pub enum PilError {
    /// Nothing to build the image from.
    #[error("not inside a checkout of quatrack, so there is nothing to build from: change to one")]
    NoCheckout,
    /// The same where an image may be given.
    #[error("not inside a checkout of quatrack, so there is no image to build: change to one, or give --image PATH")]
    NoImage,
    /// Cargo failed; it has said why.
    #[error("the image was not built: {command} ended with {status}; its own messages are above")]
    Build {
        /// The program that was run.
        command: String,
        /// The exit status.
        status: String,
    },
    /// No image.
    #[error("{}: {reason}", path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// Why it cannot be run.
        reason: String,
    },
    /// QEMU is not there.
    #[error("{} is not installed; on Debian and Ubuntu: apt-get install qemu-system-arm", emulator::PROGRAM)]
    NoEmulator,
    /// The emulator stopped by itself.
    #[error("the emulator ended with {status} before the image had answered{}", said(.output))]
    EmulatorEnded {
        /// The exit status.
        status: String,
        /// Its output.
        output: String,
    },
    /// The image does not get on.
    #[error("no answer within {seconds} s: {waiting_for}")]
    Silent {
        /// The time, s.
        seconds: u64,
        /// The answer that was waited for.
        waiting_for: String,
    },
    /// The emulator does not count as assumed.
    #[error(
        "the emulated timer counts {counted} for {instructions} instructions; it cannot measure with this emulator"
    )]
    Miscounts {
        /// Its count.
        counted: u32,
        /// Instructions that were executed.
        instructions: u32,
    },
    /// The board refuses a request.
    #[error("the board refuses {request}: {reason}")]
    Refused {
        /// The request.
        request: String,
        /// The board's words.
        reason: String,
    },
    /// A flight has no command.
    #[error("{flight}, step {step}: no command ({reason})")]
    NoCommand {
        /// The flight.
        flight: String,
        /// The step's number.
        step: u32,
        /// The board's words.
        reason: String,
    },
    /// A signal.
    #[error("interrupted")]
    Interrupted,
    /// The image wrote another answer than the one expected.
    #[error("the image's answer does not fit: {0}; build the image from this checkout")]
    Answer(String),
    /// The planner failed on the paper's own plans.
    #[error("{0}")]
    Plan(String),
    /// The machine.
    #[error("{doing}: {source}")]
    Io {
        /// The operation that failed.
        doing: String,
        /// The system's error.
        source: io::Error,
    },
}

impl PilError {
    /// Words for a failed system call.
    pub(crate) fn io(doing: impl Into<String>) -> impl FnOnce(io::Error) -> Self {
        let doing = doing.into();
        move |source| Self::Io { doing, source }
    }
}

fn said(output: &str) -> String {
    let text = output.trim();
    if text.is_empty() { String::new() } else { format!(": {}", text.replace('\n', " ")) }
}
