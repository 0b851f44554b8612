//! Tables that travel over the link and are swapped under a flight.

use quatrack::gains::table::{AcceptError, LoadError, TableError, Vehicle};
use quatrack::link::{
    BlobError, BlobKind, BlobReceiver, FRAME_BYTES, FromBoard, GainStore, MESSAGE_BYTES, Refusal, UploadBegin,
};
use quatrack::nalgebra::Vector3;
use quatrack::{Handover, Limits, Memory, Rate, Reference, Settings, State};
use quatrack_tests::core_step::command;

use super::fixture::{VEHICLE, bytes_of, gains_over_time, rate, schedule_bytes, table};

fn in_use(store: &GainStore) -> Option<&str> {
    store.active().map(|table| table.head().name.as_str())
}

#[test]
fn an_upload_becomes_the_table_in_use() {
    let blob = bytes_of(&table("lqr-f"));
    let mut receiver = BlobReceiver::<512>::new();
    let mut progress = receiver.begin(&UploadBegin::of(BlobKind::GainTable, 7, &blob).unwrap()).unwrap();
    let mut store: GainStore = GainStore::new(VEHICLE, rate());
    while let Some(chunk) = progress.next_chunk(&blob) {
        assert_eq!(in_use(&store), None, "before the commit");
        progress = receiver.chunk(&chunk).unwrap();
    }
    let (begin, whole) = receiver.finish(7).unwrap();
    assert_eq!(begin.kind, BlobKind::GainTable);
    store.commit(whole).unwrap();
    let expected = table("lqr-f");
    assert_eq!(store.active(), Some(expected.accept_for(&VEHICLE, rate()).unwrap()));
}

#[test]
fn a_refused_blob_leaves_both_tables() {
    let mut store: GainStore = GainStore::new(VEHICLE, rate());
    store.commit(&bytes_of(&table("lyap-e"))).unwrap();
    store.commit(&bytes_of(&table("lqr-e"))).unwrap();
    let mut damaged = bytes_of(&table("lyap-f"));
    damaged[200] ^= 1;
    assert!(matches!(store.commit(&damaged), Err(LoadError::Table(TableError::Checksum { .. }))));
    let mut elsewhere: GainStore = GainStore::new(Vehicle { id: 9, ..VEHICLE }, Rate::from_hz(100).unwrap());
    let other = AcceptError::Vehicle { table: VEHICLE };
    assert_eq!(elsewhere.commit(&bytes_of(&table("lqr-e"))), Err(LoadError::Accept(other)));
    let lqr_e = table("lqr-e");
    let accepted_here = lqr_e.accept_for(&VEHICLE, rate()).unwrap();
    assert_eq!(elsewhere.activate(&accepted_here), Err(other), "accepted, but for another board");
    assert_eq!(elsewhere.active(), None);

    assert_eq!(in_use(&store), Some("lqr-e"));
    assert!(store.revert());
    assert_eq!(in_use(&store), Some("lyap-e"));
}

#[test]
fn the_table_before_is_kept_and_gone_back_to() {
    let mut store: GainStore = GainStore::new(VEHICLE, rate());
    assert!(!store.revert(), "nothing to go back to");
    store.commit(&bytes_of(&table("lyap-e"))).unwrap();
    assert!(!store.revert(), "one table has none before it");
    assert_eq!(in_use(&store), Some("lyap-e"));
    for (next, before) in [("lqr-e", "lyap-e"), ("lyap-f", "lqr-e"), ("lqr-f", "lyap-f")] {
        store.activate(&table(next).accept_for(&VEHICLE, rate()).unwrap()).unwrap();
        assert_eq!(in_use(&store), Some(next));
        assert_eq!(store.previous().map(|table| table.head().name.as_str()), Some(before));
    }
    assert!(store.revert() && store.revert());
    assert_eq!(in_use(&store), Some("lqr-f"), "back and forth");
}

#[test]
fn slots_are_numbered_from_the_one_in_use() {
    let mut store = GainStore::<0>::new(VEHICLE, rate());
    let is_there = |store: &GainStore<0>, slot| store.table(slot).is_some();
    assert!(!is_there(&store, 0));
    store.commit(&bytes_of(&table("lyap-e"))).unwrap();
    assert!(is_there(&store, 0) && !is_there(&store, 1));
    store.commit(&bytes_of(&table("lqr-e"))).unwrap();
    assert!(is_there(&store, 1) && !is_there(&store, 2));
    // Without room for gains along a trajectory these are refused, and nothing else changes.
    let along = schedule_bytes(&gains_over_time(4));
    assert_eq!(store.commit(&along), Err(LoadError::Accept(AcceptError::Knots { knots: 4, room: 0 })));
    assert_eq!(store.active().map(|table| table.head().name), Some(table("lqr-e").head().name));
}

#[test]
fn a_flight_goes_on_over_a_swap() {
    let mut store: GainStore = GainStore::new(VEHICLE, rate());
    store.commit(&bytes_of(&table("lyap-e"))).unwrap();
    let reference = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0).unwrap();
    // A point mass under the commanded thrust, 10 cm low at the start.
    let (mut z, mut vz, mut last) = (0.9_f32, 0.0_f32, None);
    let (mut memory, mut way) = (Memory::at_rest(), Handover::OVER);
    for tick in 0..1000 {
        if tick == 50 {
            store.commit(&bytes_of(&table("lqr-e"))).unwrap();
            way = Handover::of_commands(50);
        }
        let state = State { velocity_m_s: Vector3::new(0.0, 0.0, vz), ..State::at_rest(Vector3::new(0.0, 0.0, z)) };
        let settings = Settings::new(Limits::NONE, rate());
        let controller = |slot| store.table(slot).map(|table| table.controller(&settings).unwrap());
        let new = controller(0).unwrap();
        let (measured, target) = ((&state).into(), (&reference).into());
        let output = match controller(1) {
            Some(old) if !way.is_over() => way.step((&old, &new), &mut memory, measured, target),
            _ => new.step(&mut memory, measured, target),
        };
        let thrust = command(output.unwrap()).command.thrust_m_s2;
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
