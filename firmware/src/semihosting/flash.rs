//! A flash in a file of the host, `flash.bin`: as the board's own, a write only clears bits, and an erase sets those of a sector.
//!
//! The emulated board's own flash cannot be written. Where there is no such file, or one of another length, nothing is kept.

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};

use super::{File, Mode};

/// Bytes of a sector, which is also a blob's slot.
pub const SLOT_BYTES: u32 = 16 * 1024;
/// Two for each of two kinds.
const SLOTS: u32 = 4;
/// Bytes that are read and written at once.
const CHUNK_BYTES: usize = 64;

/// The file, if there is one.
#[derive(Debug)]
pub struct FileFlash(Option<File>);

/// The host did not do it, or the place is beyond the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileError;

impl NorFlashError for FileError {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl ErrorType for FileFlash {
    type Error = FileError;
}

impl FileFlash {
    /// In the folder in which the emulator runs.
    pub fn open() -> Self {
        Self(File::open(c"flash.bin", Mode::Update))
    }

    fn at(&mut self, offset: u32, bytes: usize) -> Result<&mut File, FileError> {
        let fits = u32::try_from(bytes)
            .ok()
            .and_then(|bytes| offset.checked_add(bytes))
            .is_some_and(|end| end <= SLOTS * SLOT_BYTES);
        let file = self.0.as_mut().filter(|_| fits).ok_or(FileError)?;
        if file.seek(offset as usize) { Ok(file) } else { Err(FileError) }
    }

    fn put(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FileError> {
        if self.at(offset, bytes.len())?.write(bytes) { Ok(()) } else { Err(FileError) }
    }
}

impl ReadNorFlash for FileFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FileError> {
        if self.at(offset, bytes.len())?.read(bytes) == bytes.len() { Ok(()) } else { Err(FileError) }
    }

    fn capacity(&self) -> usize {
        if self.0.is_some() { (SLOTS * SLOT_BYTES) as usize } else { 0 }
    }
}

impl NorFlash for FileFlash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SLOT_BYTES as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FileError> {
        (from..to).step_by(CHUNK_BYTES).try_for_each(|at| self.put(at, &[0xFF; CHUNK_BYTES]))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FileError> {
        let mut at = offset;
        for part in bytes.chunks(CHUNK_BYTES) {
            let mut there = [0; CHUNK_BYTES];
            let there = there.get_mut(..part.len()).ok_or(FileError)?;
            self.read(at, there)?;
            there.iter_mut().zip(part).for_each(|(there, byte)| *there &= *byte);
            self.put(at, there)?;
            at += part.len() as u32;
        }
        Ok(())
    }
}
