//! Signed gain tables: a table and its key in, the signed one out; a blob in, its table out, if it is signed.
//!
//! A signed table is the table's bytes ([`crate::gains::table`]), then `QTSG`, then a tag of 16 bytes ([`Key::tables`]). The key is
//! one of its own, which hosts of the link need not have. It is shared: a reader of the board's flash can sign as well.

use super::seal::{Key, TAG_BYTES};

/// The bytes in front of a tag.
const MAGIC: [u8; 4] = *b"QTSG";

/// Bytes behind a signed table.
pub const SIGNATURE_BYTES: usize = MAGIC.len() + TAG_BYTES;

/// The bytes behind a table that is signed with a key.
pub fn signature(key: &Key, table: &[u8]) -> [u8; SIGNATURE_BYTES] {
    let tag = key.tables().tag(table);
    let mut bytes = [0; SIGNATURE_BYTES];
    bytes.iter_mut().zip(MAGIC.iter().chain(&tag)).for_each(|(to, from)| *to = *from);
    bytes
}

/// A blob's table, whether it is signed or not.
pub fn unsigned(blob: &[u8]) -> &[u8] {
    split(blob).map_or(blob, |(table, _)| table)
}

/// A blob's table, if it is signed with this key.
pub fn signed_with<'b>(key: &Key, blob: &'b [u8]) -> Option<&'b [u8]> {
    let (table, tag) = split(blob)?;
    key.tables().is_of(table, tag).then_some(table)
}

fn split(blob: &[u8]) -> Option<(&[u8], &[u8; TAG_BYTES])> {
    let (rest, tag) = blob.split_last_chunk()?;
    Some((rest.strip_suffix(&MAGIC)?, tag))
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;

    #[test]
    fn only_the_whole_table_signed_with_the_key_comes_out() {
        let (key, other) = (Key::new(&[1; 32]), Key::new(&[2; 32]));
        let table: Vec<u8> = (0..200).collect();
        let mut blob = [&table[..], &signature(&key, &table)].concat();
        assert_eq!((signed_with(&key, &blob), unsigned(&blob)), (Some(&table[..]), &table[..]));
        assert_eq!(signed_with(&other, &blob), None);
        assert_eq!((signed_with(&key, &table), unsigned(&table)), (None, &table[..]));
        for bytes in 0..blob.len() {
            assert_eq!(signed_with(&key, &blob[..bytes]), None);
        }
        for bit in 0..8 * blob.len() {
            blob[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(signed_with(&key, &blob), None, "bit {bit}");
            blob[bit / 8] ^= 1 << (bit % 8);
        }
    }
}
