//! Any bytes into the gain table loader, as they are and with the checksum that belongs to them: what comes out writes
//! the same bytes again, and flies.
#![no_main]

use libfuzzer_sys::fuzz_target;
use quatrack::checksum::crc32c;
use quatrack::gains::table::{GainTable, MAGIC, TABLE_BYTES_MAX};
use quatrack::nalgebra::Vector3;
use quatrack::{ErrorForm, FeedForward, Reference, State, Tracker};

/// A sound frame around a payload, so that the search is not for a checksum.
fn framed(payload: &[u8]) -> Option<Vec<u8>> {
    let length = u16::try_from(payload.len()).ok()?;
    let mut bytes = [&MAGIC[..], &[1, 0], &length.to_le_bytes(), payload].concat();
    bytes.extend(crc32c(&bytes).to_le_bytes());
    Some(bytes)
}

fn load(bytes: &[u8]) {
    let Ok(table) = GainTable::from_bytes(bytes) else { return };
    assert_eq!(table.to_bytes(&mut [0; TABLE_BYTES_MAX]), Some(bytes), "one table has one encoding");
    let (vehicle, rate) = (table.head().vehicle, table.head().rate);
    let Ok(table) = table.accept_for(&vehicle, rate) else { panic!("refused by the board that it names") };
    let tracker = Tracker::new(table.law(FeedForward::With, ErrorForm::HeadingFrame), table.limits());
    let Ok(reference) = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0) else { panic!("hover is a reference") };
    let step = tracker.step(&State::at_rest(Vector3::new(0.0, 0.0, 1.0)), &reference);
    assert!(step.is_ok_and(|step| step.command == *reference.input()), "any sound table holds a hover");
}

fuzz_target!(|bytes: &[u8]| {
    load(bytes);
    if let Some(bytes) = framed(bytes) {
        load(&bytes);
    }
});
