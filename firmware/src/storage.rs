//! A blob that survives a loss of power at any moment: bytes in; the newest whole ones out, after a restart too.
//!
//! Two slots, each a whole number of the flash's erase blocks. The newest blob lies in one; the next one goes to the other, first its
//! bytes, then, in the last write, the header that makes them count:
//!
//! ```text
//! magic     u32 LE   marks a slot that was written on purpose
//! sequence  u32 LE   one more than that of the slot before; the later of two whole slots is the newest
//! length    u32 LE   bytes of the blob
//! checksum  u32 LE   CRC-32C of sequence, length and blob
//! blob      from HEADER_BYTES on, filled up with 0xFF to the flash's write size
//! ```
//!
//! Power lost before the header is whole leaves the slot before; a torn header or blob fails its checksum.

use core::fmt;

use embedded_storage::nor_flash::NorFlash;
use quatrack::checksum::Crc32c;

/// Bytes of the header: a multiple of any flash's write size up to 16.
pub const HEADER_BYTES: u32 = 16;
const MAGIC: u32 = 0x5174_5331;
/// Most bytes that are written or read at once; a multiple of the write sizes.
const CHUNK_BYTES: usize = 64;

/// Where the two slots begin, and how long each is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Offsets into the flash, multiples of its erase size.
    pub slots: [u32; 2],
    /// Bytes of each, a multiple of the erase size.
    pub slot_bytes: u32,
}

/// Why a blob is not stored or read; the blob stored before is unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StorageError<E> {
    /// It does not fit.
    TooLong {
        /// Bytes of the blob.
        bytes: usize,
        /// Bytes that fit.
        capacity: usize,
    },
    /// The flash itself.
    Flash(E),
}

impl<E> From<E> for StorageError<E> {
    fn from(error: E) -> Self {
        Self::Flash(error)
    }
}

impl<E: fmt::Debug> fmt::Display for StorageError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLong { bytes, capacity } => write!(f, "storage: {bytes} bytes, room for {capacity}; store less"),
            Self::Flash(error) => write!(f, "storage: the flash failed ({error:?}); try again"),
        }
    }
}

/// A whole slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Whole {
    at: u32,
    sequence: u32,
    length: u32,
}

/// The two slots in a flash.
#[derive(Debug)]
pub struct Storage<F> {
    flash: F,
    layout: Layout,
}

impl<F: NorFlash> Storage<F> {
    /// In a flash; nothing where the layout is none of it.
    pub fn new(flash: F, layout: Layout) -> Option<Self> {
        let Layout { slots: [a, b], slot_bytes } = layout;
        let erase = u32::try_from(F::ERASE_SIZE).ok()?;
        let is_whole = |bytes: u32| erase > 0 && bytes.is_multiple_of(erase);
        let capacity = u32::try_from(flash.capacity()).unwrap_or(u32::MAX);
        let fits = |at: u32| at.checked_add(slot_bytes).is_some_and(|end| end <= capacity);
        let are_apart = a.checked_add(slot_bytes)? <= b || b.checked_add(slot_bytes)? <= a;
        let is_sound = is_whole(a)
            && is_whole(b)
            && is_whole(slot_bytes)
            && slot_bytes > HEADER_BYTES
            && fits(a)
            && fits(b)
            && are_apart
            && F::WRITE_SIZE > 0
            && F::READ_SIZE > 0
            && CHUNK_BYTES.is_multiple_of(F::READ_SIZE)
            && HEADER_BYTES.is_multiple_of(F::WRITE_SIZE as u32)
            && CHUNK_BYTES.is_multiple_of(F::WRITE_SIZE);
        is_sound.then_some(Self { flash, layout })
    }

    /// Gives the flash back.
    pub fn free(self) -> F {
        self.flash
    }

    /// Bytes of the longest blob.
    pub const fn capacity(&self) -> usize {
        (self.layout.slot_bytes - HEADER_BYTES) as usize
    }

    /// The newest whole blob, in a buffer that holds it; nothing where there is none.
    ///
    /// # Errors
    /// [`StorageError`]; a blob that is longer than the buffer is too long.
    pub fn load<'b>(&mut self, buffer: &'b mut [u8]) -> Result<Option<&'b [u8]>, StorageError<F::Error>> {
        let Some(newest) = self.newest()? else { return Ok(None) };
        let (bytes, capacity) = (newest.length as usize, buffer.len());
        let Some(place) = buffer.get_mut(..bytes) else { return Err(StorageError::TooLong { bytes, capacity }) };
        let mut at = newest.at + HEADER_BYTES;
        for part in place.chunks_mut(CHUNK_BYTES) {
            let chunk = self.chunk(at, part.len())?;
            for (to, from) in part.iter_mut().zip(chunk) {
                *to = from;
            }
            at += CHUNK_BYTES as u32;
        }
        Ok(Some(place))
    }

    /// Stores a blob in the place of the one before the newest.
    ///
    /// # Errors
    /// [`StorageError`]; the newest is then as it was.
    pub fn store(&mut self, blob: &[u8]) -> Result<(), StorageError<F::Error>> {
        let (bytes, capacity) = (blob.len(), self.capacity());
        let Some(length) = u32::try_from(bytes).ok().filter(|_| bytes <= capacity) else {
            return Err(StorageError::TooLong { bytes, capacity });
        };
        let newest = self.newest()?;
        let [a, b] = self.layout.slots;
        let (to, sequence) = match newest {
            Some(Whole { at, sequence, .. }) => (if at == a { b } else { a }, sequence.wrapping_add(1)),
            None => (a, 0),
        };
        self.flash.erase(to, to + self.layout.slot_bytes)?;
        let mut at = to + HEADER_BYTES;
        for part in blob.chunks(CHUNK_BYTES) {
            let mut chunk = [0xFF; CHUNK_BYTES];
            for (to, from) in chunk.iter_mut().zip(part) {
                *to = *from;
            }
            let whole = part.len().next_multiple_of(F::WRITE_SIZE);
            self.flash.write(at, chunk.get(..whole).unwrap_or(&chunk))?;
            at += whole as u32;
        }
        let checksum = checksum(sequence, length, &mut blob.iter().copied());
        self.flash.write(to, header([MAGIC, sequence, length, checksum]).as_flattened())?;
        Ok(())
    }

    /// So many bytes, or as many as fit, filled up to the flash's read size.
    fn chunk(&mut self, at: u32, bytes: usize) -> Result<[u8; CHUNK_BYTES], StorageError<F::Error>> {
        let mut chunk = [0; CHUNK_BYTES];
        let whole = bytes.next_multiple_of(F::READ_SIZE);
        if let Some(part) = chunk.get_mut(..whole) {
            self.flash.read(at, part)?;
        } else {
            self.flash.read(at, &mut chunk)?;
        }
        Ok(chunk)
    }

    /// The later of the whole slots.
    fn newest(&mut self) -> Result<Option<Whole>, StorageError<F::Error>> {
        let [a, b] = self.layout.slots;
        let (a, b) = (self.whole(a)?, self.whole(b)?);
        Ok(match (a, b) {
            // Numbers that wrap: ahead by less than half of them.
            (Some(a), Some(b)) if a.sequence.wrapping_sub(b.sequence) < 1 << 31 => Some(a),
            (a, b) => b.or(a),
        })
    }

    /// A slot, if it is whole.
    fn whole(&mut self, at: u32) -> Result<Option<Whole>, StorageError<F::Error>> {
        let mut bytes = [[0; 4]; 4];
        self.flash.read(at, bytes.as_flattened_mut())?;
        let [magic, sequence, length, expected] = bytes.map(u32::from_le_bytes);
        if magic != MAGIC || length as usize > self.capacity() {
            return Ok(None);
        }
        let mut crc = begun(sequence, length);
        let (mut left, mut from) = (length as usize, at + HEADER_BYTES);
        while left > 0 {
            let chunk = self.chunk(from, left)?;
            chunk.iter().take(left).for_each(|byte| crc.update(*byte));
            left = left.saturating_sub(CHUNK_BYTES);
            from += CHUNK_BYTES as u32;
        }
        Ok((crc.value() == expected).then_some(Whole { at, sequence, length }))
    }
}

fn header(words: [u32; 4]) -> [[u8; 4]; 4] {
    words.map(u32::to_le_bytes)
}

fn begun(sequence: u32, length: u32) -> Crc32c {
    let mut crc = Crc32c::new();
    for word in [sequence, length] {
        word.to_le_bytes().into_iter().for_each(|byte| crc.update(byte));
    }
    crc
}

fn checksum(sequence: u32, length: u32, blob: &mut dyn Iterator<Item = u8>) -> u32 {
    let mut crc = begun(sequence, length);
    blob.for_each(|byte| crc.update(byte));
    crc.value()
}

#[cfg(test)]
mod tests;
