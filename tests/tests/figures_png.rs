//! Figures as PNG: a file that a decoder written from the standards reads, with the picture in it.

use nalgebra::Vector3;
use quatrack_sim::figures::{Curve, TrackingFigure};

const WIDTH: usize = 2400;
const HEIGHT: usize = 1120;

fn figure(lag_s: f64) -> Vec<u8> {
    let time_s: Vec<f64> = (0..=600).map(|k| f64::from(k) * 0.01).collect();
    let at = |t: f64| Vector3::new((1.3 * t).sin(), t.cos() - 1.0, 0.2 * t.sqrt());
    let reference: Vec<_> = time_s.iter().map(|t| at(*t)).collect();
    let flight: Vec<_> = time_s.iter().map(|t| at((t - lag_s).max(0.0))).collect();
    let curve = |label, position_m| Curve { label, time_s: &time_s, position_m };
    let flights = vec![curve("flight", &flight)];
    TrackingFigure { title: "A title", reference: curve("reference", &reference), flights }.to_png().expect("a figure")
}

/// Bits of a DEFLATE stream, lowest first.
struct Bits<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Bits<'_> {
    fn take(&mut self, count: usize) -> usize {
        let bit = |at: usize| usize::from(self.bytes[at / 8] >> (at % 8) & 1);
        let value = (0..count).map(|i| bit(self.at + i) << i).sum();
        self.at += count;
        value
    }

    /// Code words come highest bit first.
    fn code(&mut self, count: usize) -> usize {
        (0..count).fold(0, |code, _| code << 1 | self.take(1))
    }

    /// RFC 1951, 3.2.6: the table there, from the shortest words up.
    fn symbol(&mut self) -> usize {
        let seven = self.code(7);
        if seven <= 0b001_0111 {
            return 256 + seven;
        }
        let eight = seven << 1 | self.take(1);
        match eight {
            0b0011_0000..=0b1011_1111 => eight - 0b0011_0000,
            0b1100_0000..=0b1100_0111 => 280 + eight - 0b1100_0000,
            _ => 144 + (eight << 1 | self.take(1)) - 0b1_1001_0000,
        }
    }
}

/// One block of the fixed code, by the tables of RFC 1951, 3.2.5.
fn inflate(bytes: &[u8]) -> (Vec<u8>, usize) {
    #[rustfmt::skip]
    const LENGTHS: [(usize, usize); 29] = [
        (3, 0), (4, 0), (5, 0), (6, 0), (7, 0), (8, 0), (9, 0), (10, 0), (11, 1), (13, 1), (15, 1), (17, 1), (19, 2),
        (23, 2), (27, 2), (31, 2), (35, 3), (43, 3), (51, 3), (59, 3), (67, 4), (83, 4), (99, 4), (115, 4), (131, 5),
        (163, 5), (195, 5), (227, 5), (258, 0),
    ];
    #[rustfmt::skip]
    const DISTANCES: [(usize, usize); 30] = [
        (1, 0), (2, 0), (3, 0), (4, 0), (5, 1), (7, 1), (9, 2), (13, 2), (17, 3), (25, 3), (33, 4), (49, 4), (65, 5),
        (97, 5), (129, 6), (193, 6), (257, 7), (385, 7), (513, 8), (769, 8), (1025, 9), (1537, 9), (2049, 10),
        (3073, 10), (4097, 11), (6145, 11), (8193, 12), (12289, 12), (16385, 13), (24577, 13),
    ];
    let mut bits = Bits { bytes, at: 0 };
    assert_eq!((bits.take(1), bits.take(2)), (1, 1), "the last block, of the fixed code");
    let mut data: Vec<u8> = Vec::new();
    loop {
        match bits.symbol() {
            256 => return (data, bits.at.div_ceil(8)),
            literal @ 0..=255 => data.push(literal as u8),
            length => {
                let (base, extra) = LENGTHS[length - 257];
                let length = base + bits.take(extra);
                let (base, extra) = DISTANCES[bits.code(5)];
                let distance = base + bits.take(extra);
                assert!(distance <= data.len(), "a repeat of what was not there");
                for _ in 0..length {
                    data.push(data[data.len() - distance]);
                }
            }
        }
    }
}

/// Bit by bit, as PNG's annex D defines it.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| if c & 1 == 1 { 0xedb8_8320 ^ (c >> 1) } else { c >> 1 })
    })
}

/// Checks the file's frame and returns its pixels.
fn decode(png: &[u8]) -> Vec<[u8; 3]> {
    let mut rest = png.strip_prefix(b"\x89PNG\r\n\x1a\n").expect("the signature");
    let mut chunks = Vec::new();
    while !rest.is_empty() {
        let word = |at: usize| u32::from_be_bytes(rest[at..at + 4].try_into().expect("four bytes"));
        let length = word(0) as usize;
        let (kind, data) = (&rest[4..8], &rest[8..8 + length]);
        assert_eq!(word(8 + length), crc32(&rest[4..8 + length]), "check sum of {kind:?}");
        chunks.push((kind, data));
        rest = &rest[12 + length..];
    }
    let [(b"IHDR", header), (b"IDAT", zlib), (b"IEND", [])] = chunks[..] else { panic!("chunks: {}", chunks.len()) };
    let expected = [&(WIDTH as u32).to_be_bytes()[..], &(HEIGHT as u32).to_be_bytes(), &[8, 2, 0, 0, 0]].concat();
    assert_eq!(header, expected, "2400 x 1120, 8-bit RGB");
    assert_eq!(zlib[0] & 0x0f, 8, "deflate");
    assert_eq!((usize::from(zlib[0]) * 256 + usize::from(zlib[1])) % 31, 0, "check of the zlib header");
    let (rows, used) = inflate(&zlib[2..]);
    let (a, b) = rows.iter().fold((1_u64, 0_u64), |(a, b), byte| {
        let a = (a + u64::from(*byte)) % 65_521;
        (a, (b + a) % 65_521)
    });
    assert_eq!(zlib[2 + used..], ((b << 16 | a) as u32).to_be_bytes(), "Adler-32, and nothing after it");
    assert_eq!(rows.len(), HEIGHT * (3 * WIDTH + 1));
    let rows = rows.chunks(3 * WIDTH + 1).inspect(|row| assert_eq!(row[0], 0, "rows are not filtered"));
    rows.flat_map(|row| row[1..].chunks(3)).map(|p| [p[0], p[1], p[2]]).collect()
}

#[test]
fn the_picture_is_in_the_file() {
    let pixels = decode(&figure(0.4));
    let count = |colour: [u8; 3]| pixels.iter().filter(|p| **p == colour).count();
    // White paper; and both curves in four views of some 1000 pixels across, 2 to 6 pixels wide: thousands.
    assert!(count([255; 3]) > WIDTH * HEIGHT / 2);
    assert!(count([0, 114, 178]) > 5_000, "the flight in blue: {}", count([0, 114, 178]));
    assert!(count([0; 3]) > 1_000, "the reference in black: {}", count([0; 3]));
    assert!(count([34; 3]) > 1_000, "type: {}", count([34; 3]));
    // Half-covered pixels at the edges of the blue line make it smooth: there is at least one at either side of it.
    let (line, paper) = ([0_u8, 114, 178], [255_u8; 3]);
    let between = |p: &[u8; 3]| (0..3).all(|i| p[i] > line[i] && p[i] < paper[i]) && p[2] > p[1] && p[1] > p[0];
    assert!(pixels.iter().filter(|p| between(p)).count() > 5_000);
}

#[test]
fn nothing_touches_the_edge_of_the_sheet() {
    let pixels = decode(&figure(0.4));
    let margin = 10;
    let inside = |k: usize| {
        let (row, column) = (k / WIDTH, k % WIDTH);
        (margin..HEIGHT - margin).contains(&row) && (margin..WIDTH - margin).contains(&column)
    };
    assert!(pixels.iter().enumerate().all(|(k, p)| inside(k) || *p == [255; 3]));
}

#[test]
fn the_same_data_give_the_same_file_and_others_another() {
    let png = figure(0.4);
    assert_eq!(png, figure(0.4));
    assert_ne!(decode(&png), decode(&figure(0.0)));
    assert!(png.len() < 1_000_000, "{} bytes", png.len());
}

#[test]
fn any_title_and_label_can_be_drawn() {
    let time_s = [0.0, 1.0];
    let position_m = [Vector3::zeros(), Vector3::new(1.0, 2.0, 3.0)];
    let long = "very long ".repeat(400);
    for text in ["", " ", "\u{3bc} = 2 \u{b0} \u{2212}1", "\u{1f681}\u{0}\n", &long] {
        let curve = Curve { label: text, time_s: &time_s, position_m: &position_m };
        let figure = TrackingFigure { title: text, reference: curve, flights: vec![curve; 4] };
        assert!(figure.to_png().is_ok_and(|png| decode(&png).contains(&[0, 114, 178])), "{text:.20}");
    }
}
