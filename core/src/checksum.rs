//! CRC-32C (Castagnoli): bytes in, a checksum out, by a table of 16 entries.
//!
//! At the length of a frame every error of up to five bits is found, and every burst of up to 32. Half a byte at a time
//! keeps the table at 64 bytes of flash.

/// The polynomial, lowest power in the highest bit.
const POLYNOMIAL: u32 = 0x82F6_3B78;

const TABLE: [u32; 16] = {
    let mut table = [0; 16];
    let mut nibble = 0;
    while nibble < 16 {
        let mut remainder = nibble as u32;
        let mut bit = 0;
        while bit < 4 {
            remainder = if remainder & 1 == 1 { (remainder >> 1) ^ POLYNOMIAL } else { remainder >> 1 };
            bit += 1;
        }
        table[nibble] = remainder;
        nibble += 1;
    }
    table
};

/// A checksum in the making.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crc32c {
    register: u32,
}

impl Crc32c {
    /// The checksum of no bytes yet.
    pub const fn new() -> Self {
        Self { register: !0 }
    }

    /// Takes one more byte.
    #[inline]
    pub fn update(&mut self, byte: u8) {
        let mixed = self.register ^ u32::from(byte);
        let mixed = (mixed >> 4) ^ entry(mixed);
        self.register = (mixed >> 4) ^ entry(mixed);
    }

    /// The checksum of the bytes so far.
    pub const fn value(self) -> u32 {
        !self.register
    }

    /// Whether the last four bytes were the checksum, lowest byte first, of the bytes before them.
    #[cfg(any(feature = "link", test))]
    pub(crate) const fn ends_with_itself(self) -> bool {
        // The remainder of any bytes followed by their own checksum.
        const RESIDUE: u32 = 0xB798_B438;
        self.register == RESIDUE
    }
}

impl Default for Crc32c {
    fn default() -> Self {
        Self::new()
    }
}

/// The checksum of `bytes`.
#[inline(never)]
pub fn crc32c(bytes: &[u8]) -> u32 {
    let mut crc = Crc32c::new();
    bytes.iter().for_each(|byte| crc.update(*byte));
    crc.value()
}

#[inline]
fn entry(value: u32) -> u32 {
    // The mask keeps the index within the table.
    TABLE[(value & 15) as usize]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_check_values() {
        assert_eq!(crc32c(b"123456789"), 0xE306_9283);
        // RFC 3720, B.4: 32 bytes of zeros, of ones.
        assert_eq!(crc32c(&[0; 32]), 0x8A91_36AA);
        assert_eq!(crc32c(&[0xFF; 32]), 0x62A8_AB43);
    }

    #[test]
    fn bytes_with_their_checksum_are_told_from_all_with_one_wrong_bit() {
        let mut framed = *b"any bytes\0\0\0\0";
        let checksum = crc32c(b"any bytes").to_le_bytes();
        framed[9..].copy_from_slice(&checksum);
        let sound = |bytes: &[u8]| {
            let mut crc = Crc32c::new();
            bytes.iter().for_each(|byte| crc.update(*byte));
            crc.ends_with_itself()
        };
        assert!(sound(&framed));
        for bit in 0..framed.len() * 8 {
            let mut broken = framed;
            broken[bit / 8] ^= 1 << (bit % 8);
            assert!(!sound(&broken), "bit {bit}");
        }
    }
}
