//! Each reason to refuse a table, reached by hand: damage that the checksum covers, then damage under a checksum made
//! anew.

use quatrack::Rate;
use quatrack::command::LimitsError;
use quatrack::gain::GainError;
use quatrack::gains::table::{
    AcceptError, BODY_RATE_MAX_RAD_S, Figure, GainTable, Name, NameError, TableError, TableKind, Vehicle,
};

use super::fixture::{VEHICLE, bytes_of, dimensions, rate, sealed, table, tables};

/// The refusal of a table after some of its bytes have been replaced, checksum made anew.
fn refusal(name: &str, offset: usize, replacement: &[u8]) -> TableError {
    let mut bytes = bytes_of(&table(name));
    bytes[offset..offset + replacement.len()].copy_from_slice(replacement);
    GainTable::from_bytes(&sealed(bytes)).unwrap_err()
}

fn refusal_of_f32(offset: usize, value: f32) -> TableError {
    refusal("lqr-e", offset, &value.to_le_bytes())
}

#[test]
fn every_flipped_bit_is_found() {
    for (name, _) in tables() {
        let bytes = bytes_of(&table(name));
        for bit in 0..bytes.len() * 8 {
            let mut broken = bytes.clone();
            broken[bit / 8] ^= 1 << (bit % 8);
            let refused = GainTable::from_bytes(&broken).unwrap_err();
            let expected = match bit / 8 {
                0..4 => matches!(refused, TableError::Magic { .. }),
                6..8 => matches!(refused, TableError::Length { .. }),
                _ => matches!(refused, TableError::Checksum { .. }),
            };
            assert!(expected, "bit {bit} of {name}: {refused}");
        }
    }
}

#[test]
fn every_part_of_a_table_and_every_longer_one_is_refused_by_its_length() {
    let mut bytes = bytes_of(&table("lqr-e"));
    for length in 0..bytes.len() {
        let wanted = if length < 12 { 12 } else { 341 };
        let refused = Err(TableError::Length { bytes: length as u32, wanted });
        assert_eq!(GainTable::from_bytes(&bytes[..length]), refused);
    }
    bytes.push(0);
    assert_eq!(GainTable::from_bytes(&bytes), Err(TableError::Length { bytes: 342, wanted: 341 }));
}

#[test]
fn the_frame_is_looked_at_first() {
    assert_eq!(refusal("lqr-e", 0, b"QTTR"), TableError::Magic { found: *b"QTTR" });
    assert_eq!(refusal("lqr-e", 4, &[3, 1]), TableError::Version { found: 0x0103 });
    let mut bytes = bytes_of(&table("lqr-e"));
    let stated = u32::from_le_bytes(bytes[337..].try_into().unwrap());
    bytes[340] ^= 0x80;
    let refused = Err(TableError::Checksum { stated: stated ^ 0x8000_0000, found: stated });
    assert_eq!(GainTable::from_bytes(&bytes), refused);
}

#[test]
fn a_payload_of_another_kind_or_size_is_refused() {
    for found in [0, 7, 8, 255] {
        assert_eq!(refusal("lqr-e", 8, &[found]), TableError::Kind { found });
    }
    let transposed = TableError::Dimensions { kind: TableKind::Equilibrium, rows: 9, columns: 4 };
    assert_eq!(refusal("lqr-e", 9, &[9, 4]), transposed);
    let mislabelled = TableError::Dimensions { kind: TableKind::FlatOutput, rows: 4, columns: 9 };
    assert_eq!(refusal("lqr-e", 8, &[2]), mislabelled);
    let without_integrals = TableError::Dimensions { kind: TableKind::Integral, rows: 4, columns: 9 };
    assert_eq!(refusal("lqr-e", 8, &[3]), without_integrals);
    // Behind the head of one along a trajectory comes the number of its knots, here half of an entry that is 0.
    assert_eq!(refusal("lqr-e", 8, &[4]), TableError::Knots { found: 0 });
    let without_motors = TableError::Dimensions { kind: TableKind::ActuatorAware, rows: 4, columns: 9 };
    assert_eq!(refusal("lqr-e", 8, &[5]), without_motors);
    let without_chains = TableError::Dimensions { kind: TableKind::Cascade, rows: 4, columns: 9 };
    assert_eq!(refusal("lqr-e", 8, &[6]), without_chains);
    // Sound frames around payloads of other lengths: none, half a head, gains of the other kind.
    let cases = [(1, 0, 197), (1, 114, 197), (1, 465, 341), (1, 328, 341), (2, 329, 477), (3, 329, 389), (3, 378, 389)];
    for (kind, payload, wanted) in cases {
        let (m, n) = [(4, 9), (7, 10), (4, 12)][kind as usize - 1];
        let mut bytes = bytes_of(&table("lqr-f"));
        bytes.resize(payload + 12, 0);
        bytes[6..8].copy_from_slice(&(payload as u16).to_le_bytes());
        if payload > 3 {
            bytes[8..11].copy_from_slice(&[kind, m, n]);
        }
        let refused = Err(TableError::Length { bytes: payload as u32 + 12, wanted });
        assert_eq!(GainTable::from_bytes(&sealed(bytes)), refused, "payload of {payload} bytes");
    }
}

#[test]
fn every_entry_is_looked_at() {
    for name in ["lqr-e", "lqr-f", "lqi-e"] {
        let (m, n) = dimensions(table(name).kind());
        for (row, column) in (0..m).flat_map(|row| (0..n).map(move |column| (row, column))) {
            let at = 193 + 4 * (row * n + column);
            for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                let refused = TableError::Gain(GainError::NonFinite { row, column });
                assert_eq!(refusal(name, at, &bad.to_le_bytes()), refused);
            }
            for value in [1.1e4_f32, -1.1e4, f32::MAX, 0.9e-9, -1e-20, f32::from_bits(1)] {
                let refused = refusal(name, at, &value.to_le_bytes());
                // A dust-sized entry may leave its column alone with it: still not unused, still out of proportion.
                assert_eq!(refused, TableError::Entry { row: row as u8, column: column as u8, value });
            }
        }
        let unused = (0..n).map(|column| {
            let mut bytes = bytes_of(&table(name));
            for row in 0..m {
                let at = 193 + 4 * (row * n + column);
                bytes[at..at + 4].copy_from_slice(&(-0.0_f32).to_le_bytes());
            }
            (column, GainTable::from_bytes(&sealed(bytes)).err())
        });
        for (column, refused) in unused {
            assert_eq!(refused, Some(TableError::Gain(GainError::UnusedError { column })), "{name}");
        }
    }
}

#[test]
fn entries_on_the_bounds_pass() {
    for value in [1e4_f32, -1e4, 1e-9, -1e-9] {
        let mut bytes = bytes_of(&table("lqr-e"));
        bytes[193..197].copy_from_slice(&value.to_le_bytes());
        assert!(GainTable::from_bytes(&sealed(bytes)).is_ok(), "{value:e}");
    }
}

#[test]
fn names_are_names() {
    assert_eq!(refusal("lqr-e", 11, &[0; 31]), TableError::TableName(NameError::Length { bytes: 0 }));
    let space = NameError::Character { position: 3, byte: b' ' };
    assert_eq!(refusal("lqr-e", 11, b"lqr e"), TableError::TableName(space));
    let behind = NameError::Character { position: 30, byte: b'x' };
    assert_eq!(refusal("lqr-e", 72, b"x"), TableError::VehicleName(behind));
}

#[test]
fn rate_and_limits_are_possible_ones() {
    for hz in [0, 10_001, u32::MAX] {
        assert_eq!(refusal("lqr-e", 77, &u32::to_le_bytes(hz)), TableError::Rate { hz });
    }
    let thrust = |min_m_s2, max_m_s2| TableError::Thrust { min_m_s2, max_m_s2 };
    let empty = LimitsError::Thrust { min_m_s2: 17.0, max_m_s2: 16.5 };
    assert_eq!(refusal_of_f32(81, 17.0), TableError::Limits(empty));
    assert_eq!(refusal_of_f32(81, -1.0), thrust(-1.0, 16.5), "propellers do not pull down");
    assert_eq!(refusal_of_f32(81, 9.9), thrust(9.9, 16.5), "cannot hover");
    assert_eq!(refusal_of_f32(85, 9.5), thrust(1.75, 9.5), "cannot hover");
    assert_eq!(refusal_of_f32(85, 200.1), thrust(1.75, 200.1));
    assert!(matches!(refusal_of_f32(85, f32::NAN), TableError::Limits(LimitsError::Thrust { .. })));
    assert_eq!(refusal_of_f32(93, 0.0), TableError::Limits(LimitsError::BodyRate { max_rad_s: 0.0 }));
    for offset in [89, 93, 97] {
        let beyond = 1.01 * BODY_RATE_MAX_RAD_S;
        assert_eq!(refusal_of_f32(offset, beyond), TableError::BodyRate { max_rad_s: beyond });
    }
}

#[test]
fn a_table_without_design_or_certificate_is_refused() {
    assert_eq!(refusal("lqr-e", 101, &[0; 32]), TableError::NoDesign);
    assert_eq!(refusal("lqr-e", 133, &[0; 32]), TableError::NoCertificate);
    // Offset of the figure; values that certify nothing, and one beyond belief.
    let cases = [
        (165, Figure::OneChannelGain, [0.0, 1.0, -2.0], 1001.0),
        (169, Figure::OneChannelPhase, [0.0, -0.0, -1.0], 3.2),
        (173, Figure::AllChannelsGain, [0.0, 0.5, 1.0], f32::INFINITY),
        (177, Figure::AllChannelsPhase, [0.0, -1.0, -3.0], 3.2),
        (181, Figure::DelayMax, [0.0, -0.0, -1.0], 10.1),
        (185, Figure::MotorLagMax, [0.0, -0.0, -1.0], f32::INFINITY),
        (189, Figure::F32Distance, [-1e-9, -1.0, f32::NEG_INFINITY], 1.1e-6),
    ];
    for (offset, figure, nothing, beyond) in cases {
        for value in nothing.into_iter().chain([beyond]) {
            assert_eq!(refusal_of_f32(offset, value), TableError::Uncertified { figure, value });
        }
        let refused = refusal_of_f32(offset, f32::NAN);
        assert!(matches!(refused, TableError::Uncertified { figure: f, value } if f == figure && value.is_nan()));
    }
}

#[test]
fn a_table_for_another_board_is_refused() {
    let sound = table("lqr-e");
    assert_eq!(sound.accept_for(&VEHICLE, rate()).map(|accepted| *accepted.head()), Ok(*sound.head()));
    let renamed = Vehicle { name: Name::new("crazyflie-2.0").unwrap(), ..VEHICLE };
    let heavier = Vehicle { id: 0x0102_0305, ..VEHICLE };
    for other in [renamed, heavier] {
        assert_eq!(sound.accept_for(&other, rate()), Err(AcceptError::Vehicle { table: VEHICLE }));
    }
    let slower = Rate::from_hz(499).unwrap();
    assert_eq!(sound.accept_for(&VEHICLE, slower), Err(AcceptError::Rate { table_hz: 500, loop_hz: 499 }));
}

#[test]
fn a_refusal_names_the_fault_and_the_remedy() {
    let texts = [
        (
            refusal("lqr-e", 0, b"QTTR"),
            "gain table: starts with [51, 54, 54, 52], not [51, 54, 47, 54]; give a binary gain table",
        ),
        (
            refusal("lqr-e", 4, &[1]),
            "gain table: format version 1, not 2; write it again with `quatrack gains design`, with the program of the firmware's \
             release",
        ),
        (refusal_of_f32(197, 2e4), "gain table: entry (0, 1) is 2e4; must be 0 or of a size from 1e-9 to 1e4"),
        (refusal_of_f32(197, f32::NAN), "gain table: gain: entry (0, 1) is not finite; design it again"),
        (refusal("lqr-e", 133, &[0; 32]), "gain table: no certificate; certify the design"),
        (
            refusal_of_f32(181, 0.0),
            "gain table: certified largest delay (s) is 0, which certifies nothing; change the design",
        ),
    ];
    for (error, text) in texts {
        assert_eq!(error.to_string(), text);
    }
    let other = table("lqr-e").accept_for(&Vehicle { id: 1, ..VEHICLE }, rate()).unwrap_err();
    assert_eq!(
        other.to_string(),
        "gain table: designed for crazyflie-2.1 (id 01020304), which this board does not fly; design it for this one"
    );
}
