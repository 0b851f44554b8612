//! Messages in, frames out.

use core::fmt;

use postcard::ser_flavors::Flavor;

use super::checksum::Crc32c;
use super::{DELIMITER, Message, PROTOCOL_VERSION};

/// Numbers and frames the messages of one session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Encoder {
    session: u32,
    /// Of the next frame; none when the last number has been used.
    sequence: Option<u32>,
}

/// Why there is no frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum EncodeError {
    /// The frame does not fit.
    BufferTooShort {
        /// Bytes of the buffer; [`super::FRAME_BYTES`] hold any frame.
        bytes: usize,
    },
    /// The session has used all its sequence numbers.
    SessionOver,
}

impl fmt::Display for EncodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BufferTooShort { bytes } => {
                write!(f, "frame: does not fit in {bytes} bytes; give it {}", super::FRAME_BYTES)
            }
            Self::SessionOver => f.write_str("frame: no sequence number left; open a new session with a hello"),
        }
    }
}

impl core::error::Error for EncodeError {}

impl Encoder {
    /// The frames of a session, counted from 0. The board takes the session of the hello that it answers.
    pub const fn new(session: u32) -> Self {
        Self { session, sequence: Some(0) }
    }

    /// The session.
    pub const fn session(&self) -> u32 {
        self.session
    }

    /// The sequence number of the next frame, which its answer will name.
    pub const fn next_sequence(&self) -> Option<u32> {
        self.sequence
    }

    /// Writes a message as a frame, delimiter included, and returns the part of `buffer` that holds it.
    ///
    /// # Errors
    /// [`EncodeError`]; the sequence number is not used up then.
    pub fn encode<'b, M: Message>(&mut self, message: &M, buffer: &'b mut [u8]) -> Result<&'b [u8], EncodeError> {
        let sequence = self.sequence.ok_or(EncodeError::SessionOver)?;
        let bytes = buffer.len();
        let header = (PROTOCOL_VERSION, self.session, sequence);
        let frame = postcard::serialize_with_flavor(&(header, message), Framer::new(buffer))
            .map_err(|_| EncodeError::BufferTooShort { bytes })?;
        self.sequence = sequence.checked_add(1);
        Ok(frame)
    }
}

/// Takes the bytes of a frame one by one: checksum and COBS on the way into the buffer.
struct Framer<'b> {
    buffer: &'b mut [u8],
    /// Where the block's code byte stands.
    code_at: usize,
    /// Where the next byte goes.
    next: usize,
    checksum: Crc32c,
}

/// A code byte and 254 others: the longest block, after which no zero follows.
const FULL_BLOCK: usize = 255;

impl<'b> Framer<'b> {
    fn new(buffer: &'b mut [u8]) -> Self {
        Self { buffer, code_at: 0, next: 1, checksum: Crc32c::new() }
    }

    fn put(&mut self, at: usize, byte: u8) -> postcard::Result<()> {
        *self.buffer.get_mut(at).ok_or(postcard::Error::SerializeBufferFull)? = byte;
        Ok(())
    }

    fn end_block(&mut self) -> postcard::Result<()> {
        let code = self.next.wrapping_sub(self.code_at) as u8;
        self.put(self.code_at, code)?;
        self.code_at = self.next;
        self.next += 1;
        Ok(())
    }

    fn stuff(&mut self, byte: u8) -> postcard::Result<()> {
        // A full block ends only when something follows it.
        if self.next.wrapping_sub(self.code_at) == FULL_BLOCK {
            self.end_block()?;
        }
        if byte == 0 {
            return self.end_block();
        }
        self.put(self.next, byte)?;
        self.next += 1;
        Ok(())
    }
}

impl<'b> Flavor for Framer<'b> {
    type Output = &'b [u8];

    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        self.checksum.update(byte);
        self.stuff(byte)
    }

    fn finalize(mut self) -> postcard::Result<&'b [u8]> {
        for byte in self.checksum.value().to_le_bytes() {
            self.stuff(byte)?;
        }
        self.end_block()?;
        self.put(self.code_at, DELIMITER)?;
        self.buffer.get(..self.next).ok_or(postcard::Error::SerializeBufferFull)
    }
}
