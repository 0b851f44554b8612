//! Tables of the law before the cascade: refused by name, however sound they are.

use quatrack::gains::table::{
    CONSTANT_TABLE_BYTES_MAX, FORMAT_VERSION, GainTable, MAGIC, TableError, TableKind, Vehicle,
};
use quatrack::link::GainStore;

use super::fixture::{VEHICLE, bytes_of, head, rate, table};

/// One that was designed while there were any: a head, the motor lag, four rows of nineteen entries.
const TABLE: &[u8] = include_bytes!("../../../../tests/data/actuator-aware.bin");

#[test]
fn a_sound_one_is_refused_by_name_with_the_remedy() {
    assert_eq!((&TABLE[..4], &TABLE[4..6]), (&MAGIC[..], &FORMAT_VERSION.to_le_bytes()[..]));
    // A receiver of tables has room for it, so that it comes whole.
    assert_eq!((TABLE.len(), CONSTANT_TABLE_BYTES_MAX), (505, 505));
    assert_eq!(TableKind::of(TABLE), Ok(TableKind::ActuatorAware));
    let refused = GainTable::from_bytes(TABLE).unwrap_err();
    assert_eq!(refused, TableError::ActuatorAware);
    assert_eq!(
        refused.to_string(),
        "gain table: of the actuator-aware law, which is not flown any more; design one of the cascade: `quatrack gains design` \
         with method = \"cascade\""
    );
}

#[test]
fn it_leaves_the_loaded_table_of_a_board() {
    let mut store = GainStore::<2>::new(VEHICLE, rate());
    store.commit(&bytes_of(&table("lqr-e"))).unwrap();
    assert_eq!(store.commit(TABLE), Err(TableError::ActuatorAware.into()));
    assert_eq!(store.active().map(|table| *table.head()), Some(head("lqr-e")));
    // Its vehicle does not count.
    let other = Vehicle { id: 1, ..VEHICLE };
    assert_eq!(GainStore::<2>::new(other, rate()).commit(TABLE), Err(TableError::ActuatorAware.into()));
}

#[test]
fn damage_is_told_first() {
    let mut bytes = TABLE.to_vec();
    bytes[300] ^= 1;
    assert!(matches!(GainTable::from_bytes(&bytes), Err(TableError::Checksum { .. })));
    assert!(matches!(GainTable::from_bytes(&TABLE[..400]), Err(TableError::Length { .. })));
}
