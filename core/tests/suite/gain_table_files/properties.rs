//! Any bytes: the loader never panics, and a table that it takes writes the same bytes again.

use proptest::collection::vec;
use proptest::prelude::*;
use quatrack::gains::table::{ENTRY_MAX, GainTable, Hash};

use super::fixture::{bytes_of, sealed, table, tables};

/// The properties of every table that comes out of any bytes.
fn holds_for_a_table(bytes: &[u8]) -> Result<bool, TestCaseError> {
    let Ok(table) = GainTable::from_bytes(bytes) else { return Ok(false) };
    prop_assert_eq!(&bytes_of(&table)[..], bytes, "one table has one encoding");
    let is_in_proportion = |entry: &f32| entry.is_finite() && entry.abs() <= ENTRY_MAX;
    let sound = table.rows().is_none_or(|rows| rows.entries().iter().all(is_in_proportion));
    prop_assert!(sound);
    let (head, certificate) = (table.head(), &table.head().certificate);
    prop_assert!(head.design_hash != Hash::NONE && certificate.hash != Hash::NONE);
    prop_assert!(certificate.all_channels.gain_factor > 1.0 && certificate.delay_max_s > 0.0);
    Ok(true)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn noise_is_refused(bytes in vec(any::<u8>(), 0..600)) {
        prop_assert!(GainTable::from_bytes(&bytes).is_err());
    }

    #[test]
    fn noise_in_a_sound_frame_is_refused(payload in vec(any::<u8>(), 0..600)) {
        let mut bytes = b"QTGT\x01\x00".to_vec();
        bytes.extend((payload.len() as u16).to_le_bytes());
        bytes.extend(&payload);
        bytes.extend([0; 4]);
        prop_assert!(GainTable::from_bytes(&sealed(bytes)).is_err());
    }

    #[test]
    fn damage_under_a_good_checksum_gives_a_sound_table_or_none(
        which in 0..5_usize, changes in vec((any::<prop::sample::Index>(), any::<u8>()), 1..4)
    ) {
        let mut bytes = bytes_of(&table(tables()[which].0));
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        holds_for_a_table(&sealed(bytes.clone()))?;
        holds_for_a_table(&bytes)?;
    }

    #[test]
    fn any_entries_give_a_sound_table_or_none(
        which in 0..5_usize, patterns in vec(any::<u32>(), 70), small in vec(1e-3_f32..50.0, 70)
    ) {
        let mut bytes = bytes_of(&table(tables()[which].0));
        let end = bytes.len() - 4;
        for (at, pattern) in (193..end).step_by(4).zip(patterns) {
            bytes[at..at + 4].copy_from_slice(&pattern.to_le_bytes());
        }
        holds_for_a_table(&sealed(bytes.clone()))?;
        for (at, entry) in (193..end).step_by(4).zip(small) {
            bytes[at..at + 4].copy_from_slice(&entry.to_le_bytes());
        }
        prop_assert!(holds_for_a_table(&sealed(bytes))?, "gains of a usual size are a table");
    }

    #[test]
    fn two_tables_after_each_other_are_not_one(first in 0..5_usize, second in 0..5_usize) {
        let both = [first, second].map(|which| bytes_of(&table(tables()[which].0))).concat();
        prop_assert!(GainTable::from_bytes(&both).is_err());
    }
}
