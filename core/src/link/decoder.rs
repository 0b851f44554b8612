//! Bytes in, in any chunks; messages out, and a count of everything that was none.
//!
//! A byte costs a bounded amount of work: one step of COBS and of the checksum, and at a 0x00 the decoding of at most
//! one message.

use core::marker::PhantomData;

use super::counters::{Counters, Rejected};
use super::guard::{Frame, Guard};
use super::seal::{Key, Protection, Seal};
use super::size::RAW_FRAME_BYTES;
use super::window::{Admission, Window};
use super::{DELIMITER, Message, PROTOCOL_VERSION, TAG_BYTES};
use crate::checksum::Crc32c;

/// A message and the numbers of its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Received<M> {
    /// The sender's session, to be echoed by the board.
    pub session: u32,
    /// The frame's sequence number, to be named in an answer.
    pub sequence: u32,
    /// The message.
    pub message: M,
}

/// Reads frames of one direction.
#[derive(Clone, Debug)]
pub struct Decoder<M> {
    frame: Unstuffer,
    window: Window,
    guard: Guard,
    admission: Admission,
    counters: Counters,
    message: PhantomData<fn() -> M>,
}

impl<M: Message> Decoder<M> {
    /// For the board: waits for a hello to open a session.
    pub const fn new() -> Self {
        Self::with(Window::closed(), Guard::CABLE)
    }

    /// For the host: takes answers to the session that it is opening.
    pub const fn for_session(session: u32) -> Self {
        Self::with(Window::open(session), Guard::CABLE)
    }

    /// For a board with a key: takes the hellos of other holders of the key, too. Sessions are [proposed](Self::propose)
    /// then.
    pub fn keyed(key: &Key, protection: Protection) -> Self {
        Self::with(Window::closed(), Guard::keyed(key.hello(), protection))
    }

    /// For a host with a key: takes the answer to its hello, and other frames once it [knows](Self::open) the key of
    /// their tags.
    pub fn for_keyed_session(session: u32, answer: Seal) -> Self {
        Self::with(Window::open(session), Guard::keyed(answer, Protection::Everything))
    }

    const fn with(window: Window, guard: Guard) -> Self {
        Self {
            frame: Unstuffer::new(),
            window,
            guard,
            admission: Admission::Later,
            counters: Counters::NONE,
            message: PhantomData,
        }
    }

    /// The open session.
    pub const fn session(&self) -> Option<u32> {
        self.window.session()
    }

    /// For the board: the seal of the frames of the session that a hello of this sequence number asks for. The first of
    /// them opens it; until then the open one goes on.
    pub fn propose(&mut self, session: u32, hello: u32, seal: Seal) {
        self.guard.propose(session, hello, seal);
    }

    /// For the host: the seal of the session's frames, and the messages that it covers.
    pub fn open(&mut self, seal: Seal, protection: Protection) {
        self.guard.open(seal, protection);
    }

    /// Says which hellos open another session from here on.
    pub const fn admit(&mut self, admission: Admission) {
        self.admission = admission;
    }

    /// The counts so far.
    pub const fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Takes one byte. At the end of a frame gives its message, or why it is rejected, which has been counted.
    pub fn push(&mut self, byte: u8) -> Option<Result<Received<M>, Rejected>> {
        if byte != DELIMITER {
            self.frame.push(byte);
            return None;
        }
        let result = match self.frame.end()? {
            Ok(bytes) => Self::read(bytes, &mut self.window, &mut self.guard, self.admission),
            Err(rejected) => Err(rejected),
        };
        self.frame.reset();
        Some(match result {
            Ok((received, skipped)) => {
                self.counters.count_accepted(skipped);
                Ok(received)
            }
            Err(rejected) => {
                self.counters.count_rejected(rejected);
                Err(rejected)
            }
        })
    }

    /// Takes bytes up to the next message and returns it with the bytes after it; rejected frames are counted and
    /// passed over. To be called until no message comes.
    pub fn next<'a>(&mut self, bytes: &'a [u8]) -> Option<(Received<M>, &'a [u8])> {
        let mut rest = bytes.iter();
        while let Some(byte) = rest.next() {
            if let Some(Ok(received)) = self.push(*byte) {
                return Some((received, rest.as_slice()));
            }
        }
        None
    }

    /// Reads a frame whose checksum is right and which has been cut off.
    fn read(
        bytes: &[u8],
        window: &mut Window,
        guard: &mut Guard,
        admission: Admission,
    ) -> Result<(Received<M>, u32), Rejected> {
        let (version, rest) = bytes.split_first().ok_or(Rejected::Malformed)?;
        if *version != PROTOCOL_VERSION {
            return Err(Rejected::Version { version: *version });
        }
        let ((session, sequence), body) =
            postcard::take_from_bytes::<(u32, u32)>(rest).map_err(|_| Rejected::Malformed)?;
        let kind = *body.first().ok_or(Rejected::Malformed)?;
        if kind >= M::KINDS {
            return Err(Rejected::UnknownMessage { kind });
        }
        let (message, left) = postcard::take_from_bytes::<M>(body).map_err(|_| Rejected::Malformed)?;
        let (signed, tag) = match left.len() {
            0 => (bytes, None),
            TAG_BYTES => {
                bytes.split_last_chunk().map(|(signed, tag)| (signed, Some(tag))).ok_or(Rejected::Malformed)?
            }
            _ => return Err(Rejected::Malformed),
        };
        let frame =
            Frame { session, sequence, opens: message.opens_session(), tagging: message.tagging(), signed, tag };
        let skipped = guard.take(&frame, window, admission)?;
        Ok((Received { session, sequence, message }, skipped))
    }
}

impl<M: Message> Default for Decoder<M> {
    fn default() -> Self {
        Self::new()
    }
}

/// Undoes COBS while the bytes come.
#[derive(Clone, Debug)]
struct Unstuffer {
    bytes: [u8; RAW_FRAME_BYTES],
    length: usize,
    /// Bytes of the block still to come; 0 where a code byte is next.
    block_left: u8,
    /// Whether a block has begun; a zero is between it and the next one. A block of 254 bytes, which COBS would
    /// not follow by a zero, is longer than any frame.
    begun: bool,
    overlong: bool,
    checksum: Crc32c,
}

impl Unstuffer {
    const fn new() -> Self {
        Self {
            bytes: [0; RAW_FRAME_BYTES],
            length: 0,
            block_left: 0,
            begun: false,
            overlong: false,
            checksum: Crc32c::new(),
        }
    }

    /// Forgets the frame; the buffer is overwritten by the next one.
    fn reset(&mut self) {
        self.length = 0;
        self.block_left = 0;
        self.begun = false;
        self.overlong = false;
        self.checksum = Crc32c::new();
    }

    /// Takes a byte that is not zero.
    fn push(&mut self, byte: u8) {
        if self.block_left > 0 {
            self.block_left -= 1;
            self.store(byte);
            return;
        }
        if self.begun {
            self.store(0);
        }
        self.begun = true;
        self.block_left = byte.wrapping_sub(1);
    }

    fn store(&mut self, byte: u8) {
        match self.bytes.get_mut(self.length) {
            Some(place) => {
                *place = byte;
                self.length += 1;
                self.checksum.update(byte);
            }
            None => self.overlong = true,
        }
    }

    /// The frame without its checksum, which is right, or why it is none; nothing if no byte has come since the last.
    fn end(&self) -> Option<Result<&[u8], Rejected>> {
        if !self.begun {
            return None;
        }
        Some(if self.overlong {
            Err(Rejected::Overlong)
        } else if self.block_left > 0 {
            Err(Rejected::Truncated)
        } else {
            let frame = self.bytes.get(..self.length).and_then(|bytes| bytes.split_last_chunk::<4>());
            match frame {
                Some((frame, _)) if self.checksum.ends_with_itself() => Ok(frame),
                _ => Err(Rejected::Checksum),
            }
        })
    }
}
