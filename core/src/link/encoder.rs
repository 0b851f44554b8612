//! Messages in, frames out.

use core::fmt;

use postcard::ser_flavors::Flavor;

use super::seal::Seal;
use super::size::RAW_FRAME_BYTES;
use super::{DELIMITER, Message, PROTOCOL_VERSION};
use crate::checksum::Crc32c;

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
    /// The frames of a session, counted from 0.
    pub const fn new(session: u32) -> Self {
        Self { session, sequence: Some(0) }
    }

    /// Goes over to the session of a received frame, and on in it if it is the same. For the board, which is silent
    /// until the first one.
    pub fn follow(&mut self, session: u32) {
        if session != self.session {
            *self = Self::new(session);
        }
    }

    /// The session.
    pub const fn session(&self) -> u32 {
        self.session
    }

    /// The sequence number of the next frame, which its answer will name.
    pub const fn next_sequence(&self) -> Option<u32> {
        self.sequence
    }

    /// Writes a message as a frame without a tag, delimiter included, and returns the part of `buffer` that holds it.
    ///
    /// # Errors
    /// [`EncodeError`]; the sequence number is not used up then.
    pub fn encode<'b, M: Message>(&mut self, message: &M, buffer: &'b mut [u8]) -> Result<&'b [u8], EncodeError> {
        self.encode_sealed(message, None, buffer)
    }

    /// The same, with the tag of a seal where there is one.
    ///
    /// # Errors
    /// As [`Encoder::encode`].
    pub fn encode_sealed<'b, M: Message>(
        &mut self,
        message: &M,
        seal: Option<&Seal>,
        buffer: &'b mut [u8],
    ) -> Result<&'b [u8], EncodeError> {
        let sequence = self.sequence.ok_or(EncodeError::SessionOver)?;
        let too_short = EncodeError::BufferTooShort { bytes: buffer.len() };
        let header = (PROTOCOL_VERSION, self.session, sequence);
        let mut raw = [0; RAW_FRAME_BYTES];
        let raw = Raw { bytes: &mut raw, length: 0 };
        let frame = postcard::serialize_with_flavor(&(header, message), raw).map_err(|_| too_short)?;
        let tag = seal.map(|seal| seal.tag(frame));
        let framed = Framer::new(buffer).frame(frame, tag.as_ref().map_or(&[], |tag| tag)).ok_or(too_short)?;
        self.sequence = sequence.checked_add(1);
        Ok(framed)
    }
}

/// The bytes of a frame before they are framed.
struct Raw<'r> {
    bytes: &'r mut [u8; RAW_FRAME_BYTES],
    length: usize,
}

impl<'r> Flavor for Raw<'r> {
    type Output = &'r [u8];

    // Messages have a hundred fields: inlined into each, these two make the encoder several times as large.
    #[inline(never)]
    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        *self.bytes.get_mut(self.length).ok_or(postcard::Error::SerializeBufferFull)? = byte;
        self.length += 1;
        Ok(())
    }

    #[inline(never)]
    fn try_extend(&mut self, bytes: &[u8]) -> postcard::Result<()> {
        bytes.iter().try_for_each(|byte| self.try_push(*byte))
    }

    fn finalize(self) -> postcard::Result<&'r [u8]> {
        self.bytes.get(..self.length).ok_or(postcard::Error::SerializeBufferFull)
    }
}

/// Takes the bytes of a frame: checksum and COBS on the way into the buffer. No frame is long enough for a block that ends without
/// a zero.
struct Framer<'b> {
    buffer: &'b mut [u8],
    /// Where the block's code byte is.
    code_at: usize,
    /// The next byte's place.
    next: usize,
}

impl<'b> Framer<'b> {
    fn new(buffer: &'b mut [u8]) -> Self {
        Self { buffer, code_at: 0, next: 1 }
    }

    /// Two parts and their checksum; nothing where the buffer is too short.
    fn frame(mut self, first: &[u8], second: &[u8]) -> Option<&'b [u8]> {
        let mut checksum = Crc32c::new();
        for byte in first.iter().chain(second) {
            checksum.update(*byte);
            self.stuff(*byte)?;
        }
        for byte in checksum.value().to_le_bytes() {
            self.stuff(byte)?;
        }
        self.end_block()?;
        self.put(self.code_at, DELIMITER)?;
        self.buffer.get(..self.next)
    }

    fn put(&mut self, at: usize, byte: u8) -> Option<()> {
        *self.buffer.get_mut(at)? = byte;
        Some(())
    }

    fn end_block(&mut self) -> Option<()> {
        let code = self.next.wrapping_sub(self.code_at) as u8;
        self.put(self.code_at, code)?;
        self.code_at = self.next;
        self.next += 1;
        Some(())
    }

    fn stuff(&mut self, byte: u8) -> Option<()> {
        if byte == 0 {
            return self.end_block();
        }
        self.put(self.next, byte)?;
        self.next += 1;
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{FRAME_BYTES, FromBoard, ToBoard};

    #[test]
    fn a_frame_is_these_bytes() {
        let mut buffer = [0xAA; FRAME_BYTES];
        let mut encoder = Encoder::new(0x81);
        // Version, session 0x81 as a varint, sequence 0, kind 6; then the checksum of these.
        let checksum = crate::link::crc32c(&[PROTOCOL_VERSION, 0x81, 0x01, 0, 6]).to_le_bytes();
        assert!(checksum.iter().all(|byte| *byte != 0), "the frame below takes the checksum to be one block");
        let [a, b, c, d] = checksum;
        let frame = encoder.encode(&ToBoard::Disarm, &mut buffer);
        assert_eq!(frame, Ok(&[4, PROTOCOL_VERSION, 0x81, 0x01, 6, 6, a, b, c, d, DELIMITER][..]));
    }

    #[test]
    fn a_buffer_too_short_uses_up_no_number() {
        let mut encoder = Encoder::new(1);
        let mut buffer = [0; FRAME_BYTES];
        let needed = Encoder::new(1).encode(&ToBoard::Arm, &mut buffer).unwrap().len();
        for bytes in 0..needed {
            let short = &mut buffer[..bytes];
            assert_eq!(encoder.encode(&ToBoard::Arm, short), Err(EncodeError::BufferTooShort { bytes }));
        }
        assert_eq!(encoder.next_sequence(), Some(0));
        assert_eq!(encoder.encode(&ToBoard::Arm, &mut buffer[..needed]).map(<[u8]>::len), Ok(needed));
        assert_eq!(encoder.next_sequence(), Some(1));
    }

    #[test]
    fn no_number_is_used_twice() {
        let mut encoder = Encoder { session: 1, sequence: Some(u32::MAX) };
        let mut buffer = [0; FRAME_BYTES];
        assert!(encoder.encode(&ToBoard::Arm, &mut buffer).is_ok());
        assert_eq!(encoder.encode(&ToBoard::Arm, &mut buffer), Err(EncodeError::SessionOver));
        encoder.follow(1);
        assert_eq!(encoder.next_sequence(), None, "the same session is no new one");
        encoder.follow(2);
        assert_eq!((encoder.session(), encoder.next_sequence()), (2, Some(0)));
    }

    #[test]
    fn the_longest_message_with_the_longest_numbers_fills_a_frame() {
        let chunk = crate::link::Chunk::new(u32::MAX, u32::MAX, &[0xFF; crate::link::CHUNK_BYTES]).unwrap();
        let mut encoder = Encoder { session: u32::MAX, sequence: Some(u32::MAX) };
        let mut buffer = [0; FRAME_BYTES];
        let seal = crate::link::Key::new(&[0; crate::link::KEY_BYTES]).hello();
        let frame = encoder.encode_sealed(&ToBoard::UploadChunk(chunk), Some(&seal), &mut buffer);
        assert_eq!(frame.map(<[u8]>::len), Ok(FRAME_BYTES));
        let mut encoder = Encoder { session: u32::MAX, sequence: Some(u32::MAX) };
        let short = encoder.encode(&FromBoard::Ack { sequence: u32::MAX }, &mut buffer).unwrap().len();
        assert!(short < FRAME_BYTES, "{short}");
    }
}
