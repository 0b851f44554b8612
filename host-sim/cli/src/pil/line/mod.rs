//! Lines to a board: two pipes, a USART's pipes, or a serial port in; bytes with a deadline out.

#[cfg(unix)]
mod pipes;

use std::io::{self, Read as _, Write as _};
use std::path::Path;
use std::time::Duration;

use serialport::{ClearBuffer, DataBits, FlowControl, Parity, SerialPort, StopBits};

use super::PilError;

/// Bits a second of the board's USART.
pub const BAUD: u32 = 1_000_000;

/// How long the other side may take to read, or to write the next byte.
const PATIENCE: Duration = Duration::from_secs(1);

/// An open line that never blocks for good.
pub struct Line(Kind);

enum Kind {
    /// Named pipes, of an emulated board.
    #[cfg(unix)]
    Pipes(pipes::Pipes),
    /// A serial port, of a real one.
    Port(Box<dyn SerialPort>),
}

impl Line {
    /// Makes two named pipes and opens both.
    ///
    /// # Errors
    /// [`PilError::Io`], and always where the system has no named pipes in folders.
    pub fn create_pipes(to_board: &Path, from_board: &Path) -> Result<Self, PilError> {
        #[cfg(unix)]
        return pipes::Pipes::create(to_board, from_board).map(|pipes| Self(Kind::Pipes(pipes)));
        #[cfg(not(unix))]
        {
            let _ = from_board;
            let none = "named pipes in folders are there on Linux and macOS only; fly a board by --port";
            let error = io::Error::new(io::ErrorKind::Unsupported, none);
            Err(PilError::io(format!("making the pipe {}", to_board.display()))(error))
        }
    }

    /// Opens a serial port: 1 Mbaud, 8 bits, no parity, nothing translated.
    ///
    /// # Errors
    /// [`PilError::Io`] where it cannot be opened or is no serial port.
    pub fn open_port(path: &Path) -> Result<Self, PilError> {
        let doing = || format!("setting {} to {BAUD} baud (is it a serial port?)", path.display());
        let port = serialport::new(path.to_string_lossy(), BAUD)
            .data_bits(DataBits::Eight)
            .parity(Parity::None)
            .stop_bits(StopBits::One)
            .flow_control(FlowControl::None)
            .timeout(PATIENCE)
            .open()
            .map_err(|error| PilError::io(doing())(error.into()))?;
        // Bytes that an earlier session left behind are of no use; that they cannot be dropped is no reason to stop.
        let _ = port.clear(ClearBuffer::All);
        Ok(Self(Kind::Port(port)))
    }

    /// Sends all bytes.
    ///
    /// # Errors
    /// [`PilError::Io`], also where the other side has not read for a second.
    pub fn send(&mut self, bytes: &[u8]) -> Result<(), PilError> {
        match &mut self.0 {
            #[cfg(unix)]
            Kind::Pipes(pipes) => pipes.send(bytes, PATIENCE),
            Kind::Port(port) => {
                port.set_timeout(PATIENCE).map_err(|error| PilError::io("writing to the board")(error.into()))?;
                port.write_all(bytes).map_err(PilError::io("writing to the board"))
            }
        }
    }

    /// Reads the bytes that come within a time; 0 if nothing does.
    ///
    /// # Errors
    /// [`PilError::Io`].
    pub fn receive(&mut self, buffer: &mut [u8], limit: Duration) -> Result<usize, PilError> {
        match &mut self.0 {
            #[cfg(unix)]
            Kind::Pipes(pipes) => pipes.receive(buffer, limit),
            Kind::Port(port) => {
                port.set_timeout(limit).map_err(|error| PilError::io("reading from the board")(error.into()))?;
                match port.read(buffer) {
                    Ok(count) => Ok(count),
                    Err(error) if no_bytes(error.kind()) => Ok(0),
                    Err(error) => Err(PilError::io("reading from the board")(error)),
                }
            }
        }
    }
}

/// Nothing has come yet.
fn no_bytes(kind: io::ErrorKind) -> bool {
    matches!(kind, io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted)
}
