//! Tables that travel over the link and are swapped under a flight.

use quatrack::gains::table::{AcceptError, AcceptedTable, LoadError, TableError, Vehicle};
use quatrack::link::{
    BlobError, BlobKind, BlobReceiver, FRAME_BYTES, FromBoard, GainStore, LawChoice, MESSAGE_BYTES, Refusal, Table,
    UploadBegin,
};
use quatrack::nalgebra::Vector3;
use quatrack::{Crossfade, Limits, Rate, Reference, State, Tracker};

use super::fixture::{VEHICLE, bytes_of, rate, table};

fn in_use(store: &GainStore) -> Option<&str> {
    store.active().map(|table| table.head().name.as_str())
}

#[test]
fn an_upload_becomes_the_table_in_use() {
    let blob = bytes_of(&table("lqr-f"));
    let mut receiver = BlobReceiver::<512>::new();
    let mut progress = receiver.begin(&UploadBegin::of(BlobKind::GainTable, 7, &blob).unwrap()).unwrap();
    let mut store = GainStore::new(VEHICLE, rate());
    while let Some(chunk) = progress.next_chunk(&blob) {
        assert_eq!(in_use(&store), None, "before the commit");
        progress = receiver.chunk(&chunk).unwrap();
    }
    let (begin, whole) = receiver.finish(7).unwrap();
    assert_eq!(begin.kind, BlobKind::GainTable);
    store.commit(whole).unwrap();
    assert_eq!(store.active().map(|accepted| *accepted.table()), Some(table("lqr-f")));
}

#[test]
fn a_refused_blob_leaves_both_tables() {
    let mut store = GainStore::new(VEHICLE, rate());
    store.commit(&bytes_of(&table("lyap-e"))).unwrap();
    store.commit(&bytes_of(&table("lqr-e"))).unwrap();
    let mut damaged = bytes_of(&table("lyap-f"));
    damaged[200] ^= 1;
    assert!(matches!(store.commit(&damaged), Err(LoadError::Table(TableError::Checksum { .. }))));
    let mut elsewhere = GainStore::new(Vehicle { id: 9, ..VEHICLE }, Rate::from_hz(100).unwrap());
    let other = AcceptError::Vehicle { table: VEHICLE };
    assert_eq!(elsewhere.commit(&bytes_of(&table("lqr-e"))), Err(LoadError::Accept(other)));
    let accepted_here = table("lqr-e").accept_for(&VEHICLE, rate()).unwrap();
    assert_eq!(elsewhere.activate(&accepted_here), Err(other), "accepted, but for another board");
    assert_eq!(elsewhere.active(), None);

    assert_eq!(in_use(&store), Some("lqr-e"));
    assert!(store.revert());
    assert_eq!(in_use(&store), Some("lyap-e"));
}

#[test]
fn the_table_before_is_kept_and_gone_back_to() {
    let mut store = GainStore::new(VEHICLE, rate());
    assert!(!store.revert(), "nothing to go back to");
    store.commit(&bytes_of(&table("lyap-e"))).unwrap();
    assert!(!store.revert(), "one table has none before it");
    assert_eq!(in_use(&store), Some("lyap-e"));
    for (next, before) in [("lqr-e", "lyap-e"), ("lyap-f", "lqr-e"), ("lqr-f", "lyap-f")] {
        let table = AcceptedTable::from_bytes(&bytes_of(&table(next)), &VEHICLE, rate()).unwrap();
        store.activate(&table).unwrap();
        assert_eq!(in_use(&store), Some(next));
        assert_eq!(store.previous().map(|table| table.head().name.as_str()), Some(before));
    }
    assert!(store.revert() && store.revert());
    assert_eq!(in_use(&store), Some("lqr-f"), "back and forth");
}

#[test]
fn a_choice_names_built_in_tables_and_loaded_ones() {
    let mut store = GainStore::new(VEHICLE, rate());
    let law = |store: &GainStore, table| store.law(&LawChoice::new(table)).is_some();
    assert!(law(&store, Table::LyapF) && !law(&store, Table::Loaded(0)));
    store.commit(&bytes_of(&table("lyap-e"))).unwrap();
    assert!(law(&store, Table::Loaded(0)) && !law(&store, Table::Loaded(1)));
    store.commit(&bytes_of(&table("lqr-e"))).unwrap();
    assert!(law(&store, Table::Loaded(1)) && !law(&store, Table::Loaded(2)));
}

#[test]
fn a_flight_goes_on_over_a_swap() {
    let mut store = GainStore::new(VEHICLE, rate());
    store.commit(&bytes_of(&table("lyap-e"))).unwrap();
    let reference = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0).unwrap();
    let choice = |slot| LawChoice::new(Table::Loaded(slot));
    let limits = store.active().map_or(Limits::NONE, AcceptedTable::limits);
    // A point mass under the commanded thrust, 10 cm low at the start.
    let (mut z, mut vz, mut last) = (0.9_f32, 0.0_f32, None);
    let mut fade = Crossfade::over(0);
    for tick in 0..1000 {
        if tick == 50 {
            store.commit(&bytes_of(&table("lqr-e"))).unwrap();
            fade = Crossfade::over(50);
        }
        let state = State { velocity_m_s: Vector3::new(0.0, 0.0, vz), ..State::at_rest(Vector3::new(0.0, 0.0, z)) };
        let new = Tracker::new(store.law(&choice(0)).unwrap(), limits);
        let step = match store.law(&choice(1)) {
            Some(old) if !fade.is_over() => fade.step(&Tracker::new(old, limits), &new, &state, &reference),
            _ => new.step(&state, &reference),
        };
        let thrust = step.unwrap().command.thrust_m_s2;
        let jump = thrust - last.unwrap_or(thrust);
        // At the swap LQR-E asks for 6 m/s^2 more than LYAP-E at once; over 50 steps, for less than 0.15 more a step.
        assert!(jump.abs() < 0.15, "tick {tick}: the thrust jumps by {jump} m/s^2");
        last = Some(thrust);
        vz += (thrust - 9.81) * 0.002;
        z += vz * 0.002;
    }
    // LQR-E's slow pole, at -1.41 1/s, leaves 0.1 m * exp(-1.41 * 1.9) = 7 mm.
    assert!((z - 1.0).abs() < 0.008, "at {z} m after two seconds");
}

#[test]
fn a_refusal_fits_a_frame() {
    let reason = Refusal::Blob(BlobError::from(LoadError::Accept(AcceptError::Vehicle { table: VEHICLE })));
    let message = FromBoard::Nack { sequence: u32::MAX, reason };
    let mut buffer = [0; FRAME_BYTES];
    let frame = quatrack::link::Encoder::new(u32::MAX).encode(&message, &mut buffer).unwrap();
    assert!(frame.len() < MESSAGE_BYTES, "{} bytes", frame.len());
    let mut decoder = quatrack::link::Decoder::<FromBoard>::for_session(u32::MAX);
    assert_eq!(decoder.next(frame).map(|(received, _)| received.message), Some(message));
}
