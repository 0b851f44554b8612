//! Lines to a board: two pipes, a USART's pipes, or a serial port in; bytes with a deadline out.

use std::fs::{File, OpenOptions};
use std::io::{self, Read as _, Write as _};
use std::os::fd::AsFd as _;
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::Path;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{CWD, FileType, Mode, OFlags, mknodat};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use super::PilError;

/// Bits a second of the board's USART.
pub const BAUD: u32 = 1_000_000;

/// Two open ends, neither of which ever blocks for good.
pub struct Line {
    input: File,
    output: File,
}

impl Line {
    /// Makes two named pipes and opens them for reading and writing both: that way no open waits for the other side,
    /// and a partner that dies is noticed by its process, not by a pipe that hangs.
    ///
    /// # Errors
    /// [`PilError::Io`].
    pub fn create_pipes(to_board: &Path, from_board: &Path) -> Result<Self, PilError> {
        for path in [to_board, from_board] {
            mknodat(CWD, path, FileType::Fifo, Mode::RUSR | Mode::WUSR, 0)
                .map_err(|error| PilError::io(format!("making the pipe {}", path.display()))(error.into()))?;
        }
        Ok(Self { input: open(from_board, OFlags::empty())?, output: open(to_board, OFlags::empty())? })
    }

    /// Opens a serial port: 1 Mbaud, 8 bits, no parity, nothing translated.
    ///
    /// # Errors
    /// [`PilError::Io`] where it cannot be opened or is no serial port.
    pub fn open_port(path: &Path) -> Result<Self, PilError> {
        let port = open(path, OFlags::NOCTTY | OFlags::NONBLOCK)?;
        let failed = |error: rustix::io::Errno| {
            PilError::io(format!("setting {} to {BAUD} baud (is it a serial port?)", path.display()))(error.into())
        };
        let mut settings = tcgetattr(&port).map_err(failed)?;
        settings.make_raw();
        settings.set_speed(BAUD).map_err(failed)?;
        tcsetattr(&port, OptionalActions::Flush, &settings).map_err(failed)?;
        let input = port.try_clone().map_err(PilError::io("opening the port for reading"))?;
        Ok(Self { input, output: port })
    }

    /// Sends all bytes.
    ///
    /// # Errors
    /// [`PilError::Io`], also where the other side has not read for a second.
    pub fn send(&mut self, bytes: &[u8]) -> Result<(), PilError> {
        const PATIENCE: Duration = Duration::from_secs(1);
        let start = Instant::now();
        let mut left = bytes;
        while !left.is_empty() {
            match self.output.write(left) {
                Ok(count) => left = left.get(count..).unwrap_or_default(),
                Err(error) if error.kind() == io::ErrorKind::WouldBlock && start.elapsed() < PATIENCE => {
                    wait_for(&self.output, PollFlags::OUT, PATIENCE)?;
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(PilError::io("writing to the board")(error)),
            }
        }
        Ok(())
    }

    /// Reads the bytes that come within a time; 0 if none do.
    ///
    /// # Errors
    /// [`PilError::Io`].
    pub fn receive(&mut self, buffer: &mut [u8], limit: Duration) -> Result<usize, PilError> {
        if !wait_for(&self.input, PollFlags::IN, limit)? {
            return Ok(0);
        }
        match self.input.read(buffer) {
            Ok(count) => Ok(count),
            Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted) => Ok(0),
            Err(error) => Err(PilError::io("reading from the board")(error)),
        }
    }
}

fn open(path: &Path, flags: OFlags) -> Result<File, PilError> {
    OpenOptions::new()
        .read(true)
        .write(true)
        .custom_flags(flags.bits().cast_signed())
        .open(path)
        .map_err(PilError::io(format!("opening {}", path.display())))
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
