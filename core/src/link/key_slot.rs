//! The keys that an image is given after it was built: keys in, the bytes of its slot out, and back.
//!
//! The slot is in the image's flash; `quatrack keys provision` finds it in the file by its magic and writes over it. So
//! the keys are in no source and in no build.
//!
//! ```text
//! magic       16 bytes  [`KEY_SLOT_MAGIC`]
//! protection  u8        0xFF cable only, 1 orders, any other everything
//! tables      u8        0xFF any, any other signed ones alone
//! link        32 bytes  the key that host and board share
//! signing     32 bytes  the key that gain tables are signed with
//! ```
//!
//! Writing to flash only clears bits: only a whole erase takes a key away again.

use super::seal::{KEY_BYTES, Protection};

/// Finds the slot in an image's file.
pub const KEY_SLOT_MAGIC: [u8; 16] = *b"quatrack-keys-1\0";

/// Bytes of a slot.
pub const KEY_SLOT_BYTES: usize = 16 + 2 + 2 * KEY_BYTES;

/// Nothing was given.
const NOT_GIVEN: u8 = 0xFF;
const ORDERS: u8 = 1;
const EVERYTHING: u8 = 2;
const SIGNED: u8 = 1;

/// The keys of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GivenKeys {
    /// The link's, and the messages that it protects; nothing for a cable.
    pub link: Option<([u8; KEY_BYTES], Protection)>,
    /// The key that gain tables are signed with; nothing where any are taken.
    pub signing: Option<[u8; KEY_BYTES]>,
}

impl GivenKeys {
    /// None at all.
    pub const NONE: Self = Self { link: None, signing: None };

    /// The keys in a slot.
    pub fn read(slot: &[u8; KEY_SLOT_BYTES]) -> Self {
        let (_, rest) = slot.split_first_chunk::<16>().unwrap_or((&KEY_SLOT_MAGIC, &[]));
        let ([protection, tables], keys) = rest.split_first_chunk::<2>().unwrap_or((&[0; 2], &[]));
        let (keys, _) = keys.as_chunks::<KEY_BYTES>();
        let [link, signing] = keys else { return Self::NONE };
        let protection = match *protection {
            NOT_GIVEN => None,
            ORDERS => Some(Protection::Orders),
            _ => Some(Protection::Everything),
        };
        Self {
            link: protection.map(|protection| (*link, protection)),
            signing: (*tables != NOT_GIVEN).then_some(*signing),
        }
    }

    /// A slot that holds them.
    pub const fn write(&self) -> [u8; KEY_SLOT_BYTES] {
        let mut slot = [NOT_GIVEN; KEY_SLOT_BYTES];
        let mut at = 0;
        while at < 16 {
            slot[at] = KEY_SLOT_MAGIC[at];
            at += 1;
        }
        let (protection, link) = match &self.link {
            None | Some((_, Protection::CableOnly)) => (NOT_GIVEN, [NOT_GIVEN; KEY_BYTES]),
            Some((key, Protection::Orders)) => (ORDERS, *key),
            Some((key, Protection::Everything)) => (EVERYTHING, *key),
        };
        let (tables, signing) = match &self.signing {
            None => (NOT_GIVEN, [NOT_GIVEN; KEY_BYTES]),
            Some(key) => (SIGNED, *key),
        };
        slot[16] = protection;
        slot[17] = tables;
        let mut at = 0;
        while at < KEY_BYTES {
            slot[18 + at] = link[at];
            slot[18 + KEY_BYTES + at] = signing[at];
            at += 1;
        }
        slot
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn written_keys_are_read() {
        let (a, b) = ([3; KEY_BYTES], [0xFF; KEY_BYTES]);
        let links = [None, Some((a, Protection::Orders)), Some((b, Protection::Everything))];
        for link in links {
            for signing in [None, Some(a), Some(b)] {
                let keys = GivenKeys { link, signing };
                assert_eq!(GivenKeys::read(&keys.write()), keys);
            }
        }
        assert_eq!(GivenKeys::NONE.write()[16..], [0xFF; 66], "as the flash is when it is erased");
    }

    #[test]
    fn no_cleared_bit_opens_a_closed_board() {
        let keys = GivenKeys { link: Some(([3; KEY_BYTES], Protection::Everything)), signing: Some([4; KEY_BYTES]) };
        for byte in [16, 17] {
            for bit in 0..8 {
                let mut slot = keys.write();
                slot[byte] &= !(1 << bit);
                let GivenKeys { link, signing } = GivenKeys::read(&slot);
                assert!(link.is_some_and(|(_, protection)| protection == Protection::Everything) && signing.is_some());
            }
        }
    }
}
