//! The end of the microcontroller's flash, sectors 8 to 11 of 128 kB each: bytes in and out by `embedded-storage`.
//!
//! Reference manual RM0090, section 3.6. While a sector is erased, one to two seconds, the processor waits for its next instruction:
//! nothing here is called while a motor may turn. The linker is not given these sectors (`memory.x`).

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use stm32f4::stm32f405::FLASH;

/// The first address.
const START: u32 = 0x0808_0000;
/// Bytes of a sector.
pub const SECTOR_BYTES: u32 = 128 * 1024;
const SECTORS: u32 = 4;
const FIRST_SECTOR: u32 = 8;
const WORD_BYTES: usize = 4;

/// Opens the registers for writing.
const KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];

/// The sectors.
#[derive(Debug)]
pub struct Sectors(FLASH);

/// Why a sector was not written, erased or read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashError {
    /// Beyond the sectors.
    OutOfBounds,
    /// Between two words, or two sectors.
    NotAligned,
    /// The hardware refused: the place is not erased, or protected.
    Hardware,
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::OutOfBounds => NorFlashErrorKind::OutOfBounds,
            Self::NotAligned => NorFlashErrorKind::NotAligned,
            Self::Hardware => NorFlashErrorKind::Other,
        }
    }
}

impl ErrorType for Sectors {
    type Error = FlashError;
}

/// The address of so many bytes, which are all there.
fn address(offset: u32, bytes: usize) -> Result<u32, FlashError> {
    let bytes = u32::try_from(bytes).map_err(|_| FlashError::OutOfBounds)?;
    let end = offset.checked_add(bytes).ok_or(FlashError::OutOfBounds)?;
    if end <= SECTORS * SECTOR_BYTES { Ok(START + offset) } else { Err(FlashError::OutOfBounds) }
}

impl Sectors {
    pub(super) const fn new(flash: FLASH) -> Self {
        Self(flash)
    }

    /// Does something with the registers open and closes them, whether it succeeded or not.
    fn unlocked(&mut self, work: impl FnOnce(&FLASH) -> Result<(), FlashError>) -> Result<(), FlashError> {
        let flash = &self.0;
        for key in KEYS {
            flash.keyr().write(|w| w.key().set(key));
        }
        finish(flash);
        let done = work(flash);
        flash.cr().write(|w| w.lock().locked());
        // The cache still holds the old contents of these places.
        flash.acr().modify(|_, w| w.dcen().disabled());
        flash.acr().modify(|_, w| w.dcrst().reset());
        flash.acr().modify(|_, w| w.dcrst().clear_bit().dcen().enabled());
        done
    }
}

/// Waits for the end of the operation; whether the hardware did it.
fn finish(flash: &FLASH) -> bool {
    while flash.sr().read().bsy().is_busy() {}
    let status = flash.sr().read();
    let is_done = !(status.wrperr().bit_is_set()
        || status.pgaerr().bit_is_set()
        || status.pgperr().bit_is_set()
        || status.pgserr().bit_is_set());
    flash
        .sr()
        .write(|w| w.eop().clear().operr().clear().wrperr().clear().pgaerr().clear().pgperr().clear().pgserr().clear());
    is_done
}

impl ReadNorFlash for Sectors {
    const READ_SIZE: usize = 1;

    #[allow(unsafe_code, reason = "reads flash that is no variable of the image")]
    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        let from = address(offset, bytes.len())? as *const u8;
        for (at, byte) in bytes.iter_mut().enumerate() {
            // SAFETY: within the sectors, which are always mapped.
            *byte = unsafe { from.add(at).read_volatile() };
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        (SECTORS * SECTOR_BYTES) as usize
    }
}

impl NorFlash for Sectors {
    const WRITE_SIZE: usize = WORD_BYTES;
    const ERASE_SIZE: usize = SECTOR_BYTES as usize;

    #[allow(unsafe_code, reason = "the register's description does not know which sectors there are")]
    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        address(0, to as usize)?;
        if !(from.is_multiple_of(SECTOR_BYTES) && to.is_multiple_of(SECTOR_BYTES)) {
            return Err(FlashError::NotAligned);
        }
        self.unlocked(|flash| {
            for sector in FIRST_SECTOR + from / SECTOR_BYTES..FIRST_SECTOR + to / SECTOR_BYTES {
                // SAFETY: sectors 8 to 11 are there.
                flash.cr().write(|w| unsafe { w.psize().psize32().ser().sector_erase().snb().bits(sector as u8) });
                flash.cr().modify(|_, w| w.strt().start());
                if !finish(flash) {
                    return Err(FlashError::Hardware);
                }
            }
            Ok(())
        })
    }

    #[allow(unsafe_code, reason = "writes flash that is no variable of the image")]
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        let start = address(offset, bytes.len())?;
        let (words, rest) = bytes.as_chunks::<WORD_BYTES>();
        if !(rest.is_empty() && start.is_multiple_of(WORD_BYTES as u32)) {
            return Err(FlashError::NotAligned);
        }
        self.unlocked(|flash| {
            flash.cr().write(|w| w.psize().psize32().pg().program());
            for (at, word) in (start..).step_by(WORD_BYTES).zip(words) {
                // SAFETY: an aligned word within the sectors, which the controller takes as an order to program it.
                unsafe { (at as *mut u32).write_volatile(u32::from_le_bytes(*word)) };
                if !finish(flash) {
                    return Err(FlashError::Hardware);
                }
            }
            Ok(())
        })
    }
}
