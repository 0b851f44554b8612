//! Named pipes to an emulated board.

use std::fs::{File, OpenOptions};
use std::io::{self, Read as _, Write as _};
use std::os::fd::AsFd as _;
use std::path::Path;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::no_bytes;
use crate::pil::PilError;

/// Two open ends.
pub(super) struct Pipes {
    input: File,
    output: File,
}

impl Pipes {
    /// Makes two named pipes and opens them for reading and writing both: that way no open waits for the other side,
    /// and a partner that dies is noticed by its process, not by a pipe that hangs.
    pub(super) fn create(to_board: &Path, from_board: &Path) -> Result<Self, PilError> {
        for path in [to_board, from_board] {
            make(path).map_err(PilError::io(format!("making the pipe {}", path.display())))?;
        }
        Ok(Self { input: open(from_board)?, output: open(to_board)? })
    }

    pub(super) fn send(&mut self, bytes: &[u8], patience: Duration) -> Result<(), PilError> {
        let start = Instant::now();
        let mut left = bytes;
        while !left.is_empty() {
            match self.output.write(left) {
                Ok(count) => left = left.get(count..).unwrap_or_default(),
                Err(error) if error.kind() == io::ErrorKind::WouldBlock && start.elapsed() < patience => {
                    wait_for(&self.output, PollFlags::OUT, patience)?;
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(PilError::io("writing to the board")(error)),
            }
        }
        Ok(())
    }

    pub(super) fn receive(&mut self, buffer: &mut [u8], limit: Duration) -> Result<usize, PilError> {
        if !wait_for(&self.input, PollFlags::IN, limit)? {
            return Ok(0);
        }
        match self.input.read(buffer) {
            Ok(count) => Ok(count),
            Err(error) if no_bytes(error.kind()) => Ok(0),
            Err(error) => Err(PilError::io("reading from the board")(error)),
        }
    }
}

#[cfg(not(target_vendor = "apple"))]
fn make(path: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, FileType, Mode, mknodat};
    Ok(mknodat(CWD, path, FileType::Fifo, Mode::RUSR | Mode::WUSR, 0)?)
}

/// macOS makes no pipes by `mknod`, and its own call is in none of our libraries: POSIX's program makes them everywhere.
#[cfg(target_vendor = "apple")]
fn make(path: &Path) -> io::Result<()> {
    let made = std::process::Command::new("mkfifo").args(["-m", "600"]).arg(path).status()?;
    if made.success() { Ok(()) } else { Err(io::Error::other("mkfifo made none")) }
}

fn open(path: &Path) -> Result<File, PilError> {
    let opened = OpenOptions::new().read(true).write(true).open(path);
    opened.map_err(PilError::io(format!("opening {}", path.display())))
}

/// Whether a file is ready within a time. A signal ends the wait early.
fn wait_for(file: &File, flags: PollFlags, limit: Duration) -> Result<bool, PilError> {
    let limit = Timespec { tv_sec: limit.as_secs().cast_signed(), tv_nsec: i64::from(limit.subsec_nanos()) };
    match poll(&mut [PollFd::from_borrowed_fd(file.as_fd(), flags)], Some(&limit)) {
        Ok(ready) => Ok(ready > 0),
        Err(rustix::io::Errno::INTR) => Ok(false),
        Err(error) => Err(PilError::io("waiting for the board")(error.into())),
    }
}
