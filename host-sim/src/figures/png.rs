//! Pixels in, a PNG file's bytes out.
//!
//! PNG (ISO/IEC 15948) with unfiltered rows in one DEFLATE block (RFC 1951) of the fixed code: figures are flat colour
//! and repeat themselves along and across rows, so that finding repeats is what makes them small.

use super::raster::Pixels;

/// Longest and shortest repeat that DEFLATE can name.
const LONGEST: usize = 258;
const SHORTEST: usize = 3;
/// How far back a repeat may lie.
const REACH: usize = 32_768;
const HASH_BITS: u32 = 15;

/// A complete PNG file: 8-bit RGB, `width` by `height`.
pub(super) fn encode(pixels: &Pixels) -> Vec<u8> {
    let stride = 3 * pixels.width + 1;
    let mut rows = Vec::with_capacity(stride * pixels.height);
    for row in pixels.rgb.chunks_exact(3 * pixels.width) {
        rows.push(0); // filter type: none
        rows.extend_from_slice(row);
    }
    let mut header = Vec::with_capacity(13);
    header.extend_from_slice(&(pixels.width as u32).to_be_bytes());
    header.extend_from_slice(&(pixels.height as u32).to_be_bytes());
    header.extend_from_slice(&[8, 2, 0, 0, 0]); // 8 bits, RGB, deflate, adaptive filtering, not interlaced

    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    chunk(&mut file, *b"IHDR", &header);
    chunk(&mut file, *b"IDAT", &zlib(&rows, stride));
    chunk(&mut file, *b"IEND", &[]);
    file
}

fn chunk(file: &mut Vec<u8>, kind: [u8; 4], data: &[u8]) {
    file.extend_from_slice(&(data.len() as u32).to_be_bytes());
    let from = file.len();
    file.extend_from_slice(&kind);
    file.extend_from_slice(data);
    let check = crc32(&file[from..]);
    file.extend_from_slice(&check.to_be_bytes());
}

/// CRC-32 of PNG's annex D.
fn crc32(bytes: &[u8]) -> u32 {
    const TABLE: [u32; 256] = {
        let mut table = [0; 256];
        let mut n = 0;
        while n < 256 {
            let (mut value, mut bit) = (n as u32, 0);
            while bit < 8 {
                value = if value & 1 == 1 { 0xedb8_8320 ^ (value >> 1) } else { value >> 1 };
                bit += 1;
            }
            table[n] = value;
            n += 1;
        }
        table
    };
    !bytes.iter().fold(!0, |crc, byte| TABLE[((crc ^ u32::from(*byte)) & 0xff) as usize] ^ (crc >> 8))
}

/// Adler-32 of RFC 1950.
fn adler32(bytes: &[u8]) -> u32 {
    let (mut a, mut b) = (1_u32, 0_u32);
    // 5552 bytes are the most whose sums fit 32 bits without a remainder between.
    for part in bytes.chunks(5552) {
        for byte in part {
            a += u32::from(*byte);
            b += a;
        }
        (a, b) = (a % 65_521, b % 65_521);
    }
    b << 16 | a
}

fn zlib(data: &[u8], stride: usize) -> Vec<u8> {
    let mut out = Bits { bytes: vec![0x78, 0x01], pending: 0, count: 0 };
    out.push(0b011, 3); // last block, fixed code
    let mut latest = vec![usize::MAX; 1 << HASH_BITS];
    let mut at = 0;
    while at < data.len() {
        let repeat = longest_repeat(data, at, stride, &latest);
        let step = match repeat {
            Some((length, distance)) => {
                out.repeat(length, distance);
                length
            }
            None => {
                out.symbol(u32::from(data[at]));
                1
            }
        };
        for passed in at..at + step {
            if let Some(slot) = hash(data, passed) {
                latest[slot] = passed;
            }
        }
        at += step;
    }
    out.symbol(256);
    let mut bytes = out.finish();
    bytes.extend_from_slice(&adler32(data).to_be_bytes());
    bytes
}

fn hash(data: &[u8], at: usize) -> Option<usize> {
    let &[a, b, c] = data.get(at..at + 3)?.first_chunk()?;
    Some((u32::from_le_bytes([a, b, c, 0]).wrapping_mul(0x9e37_79b1) >> (32 - HASH_BITS)) as usize)
}

/// The longest of three likely repeats: the pixel before, the row above, the last place with the same three bytes.
fn longest_repeat(data: &[u8], at: usize, stride: usize, latest: &[usize]) -> Option<(usize, usize)> {
    let last_seen = latest[hash(data, at)?];
    let most = LONGEST.min(data.len() - at);
    [at.checked_sub(3), at.checked_sub(stride), (last_seen < at).then_some(last_seen)]
        .into_iter()
        .flatten()
        .filter(|from| at - from <= REACH)
        .map(|from| ((0..most).take_while(|i| data[from + i] == data[at + i]).count(), at - from))
        .max_by_key(|&(length, distance)| (length, std::cmp::Reverse(distance)))
        .filter(|&(length, _)| length >= SHORTEST)
}

/// Bits from the lowest of each byte up, as DEFLATE packs them.
struct Bits {
    bytes: Vec<u8>,
    pending: u64,
    count: u32,
}

impl Bits {
    fn push(&mut self, value: u32, count: u32) {
        self.pending |= u64::from(value) << self.count;
        self.count += count;
        while self.count >= 8 {
            self.bytes.push(self.pending as u8);
            self.pending >>= 8;
            self.count -= 8;
        }
    }

    /// A code word: Huffman codes go highest bit first.
    fn code(&mut self, value: u32, count: u32) {
        self.push(value.reverse_bits() >> (32 - count), count);
    }

    /// A literal, the end of the block or a length, in the fixed code (RFC 1951, 3.2.6).
    fn symbol(&mut self, symbol: u32) {
        match symbol {
            0..=143 => self.code(0x30 + symbol, 8),
            144..=255 => self.code(0x190 + symbol - 144, 9),
            256..=279 => self.code(symbol - 256, 7),
            _ => self.code(0xc0 + symbol - 280, 8),
        }
    }

    fn repeat(&mut self, length: usize, distance: usize) {
        if length == LONGEST {
            self.symbol(285);
        } else {
            let (class, extra, bits) = class(length - SHORTEST, 2);
            self.symbol(257 + class);
            self.push(extra, bits);
        }
        let (class, extra, bits) = class(distance - 1, 1);
        self.code(class, 5);
        self.push(extra, bits);
    }

    fn finish(mut self) -> Vec<u8> {
        let padding = (8 - self.count) % 8;
        self.push(0, padding);
        self.bytes
    }
}

/// DEFLATE's classes of lengths and distances: `2^fine_bits` classes to each doubling; the class, and the offset in it
/// with its number of bits (the tables of RFC 1951, 3.2.5, as a formula).
fn class(value: usize, fine_bits: u32) -> (u32, u32, u32) {
    let value = value as u32;
    let bits = (31 - (value | 1).leading_zeros()).saturating_sub(fine_bits);
    (value.checked_shr(bits).unwrap_or(0) + (bits << fine_bits), value & ((1 << bits) - 1), bits)
}
