//! The host's end of a session: messages in, frames out; bytes in, messages out; with the tags that its key and the board's ask for.

use super::Message as _;
use super::counters::Counters;
use super::decoder::{Decoder, Received};
use super::encoder::{EncodeError, Encoder};
use super::from_board::FromBoard;
use super::seal::{Key, Nonce, Protection, Seal, Tagging};
use super::to_board::ToBoard;

/// A session that the host opens, or has opened.
#[derive(Clone, Debug)]
pub struct HostSession {
    key: Option<Key>,
    nonce: Nonce,
    encoder: Encoder,
    decoder: Decoder<FromBoard>,
    /// Once the board has answered.
    seal: Option<Seal>,
    protection: Protection,
    /// Whether the board has answered a frame of the session: until it has, all carry a tag, the first of which opens it there.
    is_open: bool,
}

impl HostSession {
    /// Over a cable, without a key.
    pub const fn new(session: u32) -> Self {
        Self {
            key: None,
            nonce: Nonce::NONE,
            encoder: Encoder::new(session),
            decoder: Decoder::for_session(session),
            seal: None,
            protection: Protection::CableOnly,
            is_open: false,
        }
    }

    /// With the board's key, and a nonce that was never used before. A board without this key is not listened to.
    pub fn keyed(session: u32, key: Key, nonce: Nonce) -> Self {
        let decoder = Decoder::for_keyed_session(session, key.answer(&nonce));
        Self { nonce, decoder, key: Some(key), ..Self::new(session) }
    }

    /// The message that opens it, to be sent until it is answered.
    pub const fn hello(&self) -> ToBoard {
        ToBoard::Hello(self.nonce)
    }

    /// The session's number.
    pub const fn session(&self) -> u32 {
        self.encoder.session()
    }

    /// The sequence number of the next frame, which its answer will name.
    pub const fn next_sequence(&self) -> Option<u32> {
        self.encoder.next_sequence()
    }

    /// The counts so far.
    pub const fn counters(&self) -> &Counters {
        self.decoder.counters()
    }

    /// Writes a message as a frame, with a tag where one is asked for.
    ///
    /// # Errors
    /// As [`Encoder::encode`].
    pub fn encode<'b>(&mut self, message: &ToBoard, buffer: &'b mut [u8]) -> Result<&'b [u8], EncodeError> {
        let tagging = message.tagging();
        let hello = self.key.as_ref().filter(|_| tagging == Tagging::Greeting).map(Key::hello);
        let seal = hello.as_ref().or(self.seal.as_ref().filter(|_| !self.is_open || self.protection.covers(tagging)));
        self.encoder.encode_sealed(message, seal, buffer)
    }

    /// Takes bytes up to the next message and returns it with the bytes after it, as [`Decoder::next`]. From the board's answer
    /// to the hello on frames carry the tags of the session.
    pub fn next<'b>(&mut self, bytes: &'b [u8]) -> Option<(Received<FromBoard>, &'b [u8])> {
        let (received, rest) = self.decoder.next(bytes)?;
        if let (FromBoard::Hello(identity), Some(key)) = (&received.message, &self.key) {
            let seals = key.session(self.encoder.session(), &self.nonce, &identity.nonce);
            // A board that has answered with a tag has a key.
            self.protection = identity.protection;
            self.seal = Some(seals.to_board);
            self.decoder.open(seals.from_board, identity.protection);
        } else {
            self.is_open = true;
        }
        Some((received, rest))
    }
}
