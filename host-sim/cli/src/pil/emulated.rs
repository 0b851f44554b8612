//! A board in an emulator: an image and how to talk to it in; a connected board out.

use std::path::{Path, absolute};

use super::PilError;
use super::client::Client;
use super::emulator::{Emulator, Folder};
use super::image::{self, Image};
use super::interrupt::Interrupt;
use super::line::Line;

/// How the emulated board is talked to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// Files of the host, opened by the image: fast.
    Pipes,
    /// The emulated USART2: the real line's code.
    Usart,
}

impl Transport {
    /// The image that talks this way.
    pub fn image(self) -> Image {
        match self {
            Self::Pipes => Image::Pipes,
            Self::Usart => Image::Usart,
        }
    }
}

/// Starts an image and opens a session with it. The folder of the pipes is gone once both sides have opened them. What an
/// image on pipes logs goes to `log`, as defmt writes it.
///
/// # Errors
/// [`PilError`] where there is no emulator, no such image, or no answer.
pub fn connect(
    image: &Path,
    transport: Transport,
    log: Option<&Path>,
    interrupt: Interrupt,
) -> Result<Client, PilError> {
    image::size(image)?;
    let folder = Folder::create()?;
    if let Some(log) = log {
        // The image opens its log in the folder; the link that it finds there leads out of it.
        let log = absolute(log).map_err(PilError::io(format!("finding {}", log.display())))?;
        link(&log, &folder.path().join("log.defmt")).map_err(PilError::io("placing the log"))?;
    }
    let (line, arguments): (Line, &[&str]) = match transport {
        Transport::Pipes => {
            let [to_board, from_board] = ["to-board", "from-board"].map(|name| folder.path().join(name));
            (Line::create_pipes(&to_board, &from_board)?, &["-serial", "none"])
        }
        Transport::Usart => {
            // QEMU reads the file that ends in `.in` and writes the one that ends in `.out`; USART2 is its second
            // serial line.
            let [to_board, from_board] = ["usart.in", "usart.out"].map(|name| folder.path().join(name));
            let line = Line::create_pipes(&to_board, &from_board)?;
            (line, &["-serial", "null", "-chardev", "pipe,id=usart2,path=usart", "-serial", "chardev:usart2"])
        }
    };
    let emulator = Emulator::start(image, folder.path(), arguments)?;
    Client::connect(line, Some(emulator), interrupt)
}

#[cfg(unix)]
fn link(to: &Path, at: &Path) -> std::io::Result<()> {
    std::os::unix::fs::symlink(to, at)
}

#[cfg(not(unix))]
fn link(_to: &Path, _at: &Path) -> std::io::Result<()> {
    Err(std::io::Error::new(std::io::ErrorKind::Unsupported, "an emulated board needs Linux or macOS"))
}
