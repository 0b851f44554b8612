//! The line over two named pipes of the machine that emulates this one: `to-board` and `from-board`.
//!
//! The log goes to a third file, `log.defmt`.
//!
//! A read waits for the host and stops the emulated processor with all its clocks; the pipes are for lock-step, not for
//! flying by the board's clock.

use super::Line;
use crate::log;
use crate::semihosting::{File, Mode, exit};

/// An end of each pipe.
pub struct Pipes {
    input: File,
    output: File,
    log: File,
}

impl Pipes {
    /// Opens both, in the folder in which the emulator runs.
    pub fn open() -> Option<Self> {
        Some(Self {
            log: File::open(c"log.defmt", Mode::Write)?,
            input: File::open(c"to-board", Mode::Read)?,
            output: File::open(c"from-board", Mode::Write)?,
        })
    }
}

impl Line for Pipes {
    fn receive(&mut self, buffer: &mut [u8]) -> usize {
        let mut bytes = [0; 64];
        loop {
            let count = log::take(&mut bytes);
            match bytes.get(..count) {
                Some(bytes) if count > 0 => _ = self.log.write(bytes),
                _ => break,
            }
        }
        let count = self.input.read(buffer);
        if count == 0 {
            // The host has gone.
            exit(true);
        }
        count
    }

    fn send(&mut self, frame: &[u8]) {
        if !self.output.write(frame) {
            exit(false);
        }
    }

    fn wait(&mut self) {}
}
