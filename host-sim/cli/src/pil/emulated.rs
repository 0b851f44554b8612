//! A board in an emulator: an image and how to talk to it in; a connected board out.

use std::fs;
use std::io::Write as _;
use std::path::{Path, absolute};

use quatrack::link::Key;

use super::PilError;
use super::client::Client;
use super::emulator::{Emulator, Folder};
use super::image::{self, Image};
use super::interrupt::Interrupt;
use super::line::Line;

/// Bytes of an emulated flash: two slots of 16 kB for each of two kinds of upload.
const FLASH_BYTES: usize = 4 * 16 * 1024;

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

/// Settings of an emulated board beside its image.
#[derive(Clone, Debug, Default)]
pub struct Equipment<'a> {
    /// Where an image on pipes logs to, as defmt writes it.
    pub log: Option<&'a Path>,
    /// The file in which an image on pipes keeps uploads, as [`new_flash`] makes one.
    pub flash: Option<&'a Path>,
    /// The key that the image was given.
    pub key: Option<Key>,
}

/// Makes the file of a flash that nothing was kept in yet.
///
/// # Errors
/// [`PilError::Io`], also where the file is there already.
pub fn new_flash(path: &Path) -> Result<(), PilError> {
    let file = fs::File::create_new(path).and_then(|mut file| file.write_all(&[0xFF; FLASH_BYTES]));
    file.map_err(PilError::io(format!("making the flash {}", path.display())))
}

/// Starts an image and opens a session with it. The folder of the pipes is gone once both sides have opened them.
///
/// # Errors
/// [`PilError`] where there is no emulator, no such image, or no answer.
pub fn connect(
    image: &Path,
    transport: Transport,
    equipment: Equipment<'_>,
    interrupt: Interrupt,
) -> Result<Client, PilError> {
    image::size(image)?;
    let folder = Folder::create()?;
    for (file, name) in [(equipment.log, "log.defmt"), (equipment.flash, "flash.bin")] {
        if let Some(file) = file {
            // The image opens it in the folder; the link that it finds there leads out of it.
            let file = absolute(file).map_err(PilError::io(format!("finding {}", file.display())))?;
            link(&file, &folder.path().join(name)).map_err(PilError::io(format!("placing {name}")))?;
        }
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
    Client::connect(line, Some(emulator), equipment.key, interrupt)
}

#[cfg(unix)]
fn link(to: &Path, at: &Path) -> std::io::Result<()> {
    std::os::unix::fs::symlink(to, at)
}

#[cfg(not(unix))]
fn link(_to: &Path, _at: &Path) -> std::io::Result<()> {
    Err(std::io::Error::new(std::io::ErrorKind::Unsupported, "an emulated board needs Linux or macOS"))
}
