//! The offsets that docs/gain-tables.md states, and that the same table has the same bytes.

use quatrack::gains::table::{FORMAT_VERSION, GainTable, Name, TABLE_BYTES_MAX};
use quatrack::link::crc32c;

use super::fixture::{VEHICLE, bytes_of, head, table, tables};

fn f32_at(bytes: &[u8], offset: usize) -> f32 {
    f32::from_le_bytes(bytes[offset..offset + 4].try_into().unwrap())
}

#[test]
fn every_field_is_where_the_page_says() {
    assert_eq!(FORMAT_VERSION, 2, "a new version has offsets of its own: write them down");
    for (name, rows) in tables() {
        let table = table(name);
        let bytes = bytes_of(&table);
        let (kind, m, n, length) = match name {
            "lyap-e" | "lqr-e" => (1, 4, 9, 341),
            "lyap-f" | "lqr-f" => (2, 7, 10, 477),
            _ => (3, 4, 12, 389),
        };
        assert_eq!(bytes.len(), length, "{name}");
        assert_eq!(bytes[..8], [b'Q', b'T', b'G', b'T', 2, 0, (length - 12) as u8, ((length - 12) >> 8) as u8]);
        assert_eq!(bytes[8..11], [kind, m, n]);
        assert_eq!(bytes[11..42], Name::new(name).unwrap().padded());
        assert_eq!(bytes[42..73], VEHICLE.name.padded());
        assert_eq!(bytes[73..77], [4, 3, 2, 1], "vehicle's id");
        assert_eq!(bytes[77..81], 500_u32.to_le_bytes());
        assert_eq!([81, 85, 89, 93, 97].map(|at| f32_at(&bytes, at)), [1.75, 16.5, 20.0, 20.0, 5.0], "limits");
        assert_eq!((&bytes[101..133], &bytes[133..165]), (&[0xD5; 32][..], &[0xCE; 32][..]), "hashes");
        let figures = [165, 169, 173, 177, 181, 185, 189].map(|at| f32_at(&bytes, at));
        assert_eq!(figures, [3.0, 1.0, 2.0, 0.75, 0.0625, 0.03125, 2.5e-8]);
        let gains: Vec<f32> = (193..length - 4).step_by(4).map(|at| f32_at(&bytes, at)).collect();
        assert_eq!(gains, rows.entries());
        assert_eq!(bytes[length - 4..], crc32c(&bytes[..length - 4]).to_le_bytes());
    }
}

#[test]
fn a_table_read_back_is_the_table_and_writes_the_same_bytes() {
    for (name, rows) in tables() {
        let table = table(name);
        let bytes = bytes_of(&table);
        let read = GainTable::from_bytes(&bytes).unwrap();
        assert_eq!((read, read.rows(), *read.head()), (table, Some(rows), head(name)));
        assert_eq!(bytes_of(&read), bytes);
    }
}

#[test]
fn a_buffer_that_is_too_short_gets_no_table() {
    let table = table("lqr-f");
    let bytes = bytes_of(&table).len();
    for length in 0..bytes {
        assert_eq!(table.to_bytes(&mut vec![0; length]), None, "{length} bytes");
    }
    let mut longer = [0xAA; TABLE_BYTES_MAX];
    assert_eq!(table.to_bytes(&mut longer).map(<[u8]>::len), Some(bytes));
    assert_eq!(longer[bytes..bytes + 3], [0xAA; 3], "bytes behind the table are not written");
}
