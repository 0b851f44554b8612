//! Authentication: a key that both ends were given in; tags of frames, made and checked, out.
//!
//! A tag is HMAC-SHA-256 (RFC 2104) of a label, the bytes in front of the frame, and the frame from its version to its message, cut
//! to [`TAG_BYTES`]. No two kinds of tag share a label, so that none passes for another:
//!
//! ```text
//! label  key          in front of the frame     tags
//! 1      the key      -                         a hello
//! 2      the key      the host's nonce          its answer: its maker has the key, and made it for this hello
//! 4      the session  -                         frames to the board
//! 5      the session  -                         frames from the board
//! 6      tables' own  -                         gain tables, in the place of a frame
//! ```
//!
//! The session's key is the same function, uncut, of label 3, the session's number and both nonces: the frames of one session are worth
//! nothing in any other, even with the same numbers. Tags are compared in constant time.

use core::fmt;

use hmac::{Hmac, KeyInit as _, Mac as _};
use serde::{Deserialize, Serialize};
use sha2::Sha256;
use subtle::ConstantTimeEq as _;

/// Bytes of a key.
pub const KEY_BYTES: usize = 32;

/// Bytes of a tag on the wire.
pub const TAG_BYTES: usize = 16;

/// Bytes that the hash takes at once; a key is filled up with zeros to this length.
const BLOCK_BYTES: usize = 64;

/// A number that one side uses once, so that nothing which was recorded before is worth anything.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Nonce(pub [u8; 16]);

impl Nonce {
    /// The nonce of a side that has no key.
    pub const NONE: Self = Self([0; 16]);
}

/// The frames that carry a tag.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Protection {
    /// None: anybody on the line can fly. For a cable.
    #[default]
    CableOnly,
    /// All but states, references and their answers: anybody on the line can mislead the craft, but not arm it, disarm
    /// it or set it up.
    Orders,
    /// All of them.
    Everything,
}

/// The rule by which a message carries a tag.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tagging {
    /// Opens a session: by the key itself.
    Greeting,
    /// Under any protection.
    Always,
    /// A state or its answer, many times a second: under [`Protection::Everything`].
    Motion,
}

impl Protection {
    /// Whether a message is to carry a tag of its session.
    pub const fn covers(self, tagging: Tagging) -> bool {
        match (self, tagging) {
            (Self::CableOnly, _) | (_, Tagging::Greeting) => false,
            (Self::Orders, Tagging::Motion) => false,
            (Self::Orders, Tagging::Always) | (Self::Everything, _) => true,
        }
    }
}

impl fmt::Display for Protection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::CableOnly => "for a cable only: no frame is authenticated",
            Self::Orders => "authenticated but for states and references",
            Self::Everything => "authenticated, every frame",
        })
    }
}

/// The secret that host and board share. Printed nowhere.
#[derive(Clone)]
pub struct Key(Hmac<Sha256>);

impl fmt::Debug for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Key(..)")
    }
}

impl Key {
    /// A key of random bytes.
    pub fn new(bytes: &[u8; KEY_BYTES]) -> Self {
        let mut block = [0; BLOCK_BYTES];
        if let Some(start) = block.first_chunk_mut() {
            *start = *bytes;
        }
        Self(Hmac::new(&block.into()))
    }

    /// Tags hellos.
    pub fn hello(&self) -> Seal {
        self.seal(1)
    }

    /// Tags answers to the hello that brought this nonce.
    pub fn answer(&self, host: &Nonce) -> Seal {
        let mut seal = self.seal(2);
        seal.0.update(&host.0);
        seal
    }

    /// Tags the frames of a session.
    pub fn session(&self, session: u32, host: &Nonce, board: &Nonce) -> SessionSeals {
        let Seal(mut fed) = self.seal(3);
        fed.update(&session.to_le_bytes());
        fed.update(&host.0);
        fed.update(&board.0);
        let key = Self::new(&fed.finalize().into_bytes().into());
        SessionSeals { to_board: key.seal(4), from_board: key.seal(5) }
    }

    /// Tags gain tables, by a key of their own.
    pub fn tables(&self) -> Seal {
        self.seal(6)
    }

    fn seal(&self, label: u8) -> Seal {
        let mut fed = self.0.clone();
        fed.update(&[label]);
        Seal(fed)
    }
}

/// Both directions of a session.
#[derive(Clone, Debug)]
pub struct SessionSeals {
    /// Seal of the host's frames.
    pub to_board: Seal,
    /// Seal of the board's frames.
    pub from_board: Seal,
}

/// Makes and checks the tags of one kind: the hash, fed with all but the frame.
#[derive(Clone)]
pub struct Seal(Hmac<Sha256>);

impl fmt::Debug for Seal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Seal(..)")
    }
}

impl Seal {
    /// The tag of a frame.
    #[inline(never)]
    pub fn tag(&self, frame: &[u8]) -> [u8; TAG_BYTES] {
        let mut fed = self.0.clone();
        fed.update(frame);
        let whole: [u8; 32] = fed.finalize().into_bytes().into();
        let [tag, _] = whole.as_chunks().0 else { return [0; TAG_BYTES] };
        *tag
    }

    /// Whether this is the frame's tag; takes as long for every tag.
    pub fn is_of(&self, frame: &[u8], tag: &[u8; TAG_BYTES]) -> bool {
        self.tag(frame).ct_eq(tag).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes that no test is about.
    fn key(seed: u8) -> Key {
        Key::new(&core::array::from_fn(|i| seed.wrapping_mul(31).wrapping_add(i as u8)))
    }

    #[test]
    fn a_key_makes_the_tags_of_the_standard() {
        // RFC 4231, test case 1 has a key of 20 bytes 0x0b; filled up with zeros it is the same key.
        let mut bytes = [0; KEY_BYTES];
        bytes[..20].fill(0x0b);
        let seal = Seal(Key::new(&bytes).0);
        let expected = [0xb0, 0x34, 0x4c, 0x61, 0xd8, 0xdb, 0x38, 0x53, 0x5c, 0xa8, 0xaf, 0xce, 0xaf, 0x0b, 0xf1, 0x2b];
        assert_eq!(seal.tag(b"Hi There"), expected);
    }

    #[test]
    fn no_tag_passes_for_one_of_another_kind_key_session_or_nonce() {
        let (one, two) = (Nonce([1; 16]), Nonce([2; 16]));
        let seals = |key: Key| {
            let sessions = [(7, one, two), (8, one, two), (7, two, two), (7, one, one)];
            let both = sessions.map(|(session, host, board)| key.session(session, &host, &board));
            let both = both.into_iter().flat_map(|SessionSeals { to_board, from_board }| [to_board, from_board]);
            both.chain([key.hello(), key.answer(&one), key.answer(&two), key.tables()]).collect::<std::vec::Vec<_>>()
        };
        let all = [seals(key(1)), seals(key(2))].concat();
        for (i, a) in all.iter().enumerate() {
            for (j, b) in all.iter().enumerate() {
                assert_eq!(b.is_of(b"frame", &a.tag(b"frame")), i == j, "{i} {j}");
            }
        }
    }

    #[test]
    fn any_bit_of_frame_or_tag_counts() {
        let seal = key(1).hello();
        let mut frame = *b"a frame of the link";
        let mut tag = seal.tag(&frame);
        for bit in 0..8 * TAG_BYTES {
            tag[bit / 8] ^= 1 << (bit % 8);
            assert!(!seal.is_of(&frame, &tag), "bit {bit} of the tag");
            tag[bit / 8] ^= 1 << (bit % 8);
        }
        for bit in 0..8 * frame.len() {
            frame[bit / 8] ^= 1 << (bit % 8);
            assert!(!seal.is_of(&frame, &tag), "bit {bit} of the frame");
            frame[bit / 8] ^= 1 << (bit % 8);
        }
        assert!(seal.is_of(&frame, &tag));
    }

    #[test]
    fn protections_cover_their_messages() {
        use Tagging::{Always, Greeting, Motion};
        let covered = |protection: Protection| [Greeting, Always, Motion].map(|tagging| protection.covers(tagging));
        assert_eq!(covered(Protection::CableOnly), [false; 3]);
        assert_eq!(covered(Protection::Orders), [false, true, false]);
        assert_eq!(covered(Protection::Everything), [false, true, true]);
    }
}
