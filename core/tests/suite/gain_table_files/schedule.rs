//! Tables of gains over time: the offset of every field, each reason for a refusal, any bytes.

use proptest::collection::vec;
use proptest::prelude::*;
use quatrack::gain::GainError;
use quatrack::gains::table::{
    AcceptError, GainTable, KNOTS_MAX, KnotFault, LoadError, ScheduleRows, TABLE_BYTES_MAX, TableError, TableKind,
    Vehicle,
};
use quatrack::link::{BLOB_BYTES_MAX, GainStore};
use quatrack::nalgebra::Vector3;
use quatrack::{
    Controller, FeedForward, Limits, Memory, Piece, Progress, Rate, Reference, Settings, State, Step, Target,
    Trajectory,
};
use quatrack_tests::core_step::step_on;

use super::fixture::{
    TRAJECTORY, VEHICLE, bytes_of, gains_over_time, head, rate, schedule_bytes, sealed, table, tables,
};

/// The error of a table of four knots after some of its bytes have been replaced, checksum made anew.
fn refusal(offset: usize, replacement: &[u8]) -> TableError {
    let mut bytes = schedule_bytes(&gains_over_time(4));
    bytes[offset..offset + replacement.len()].copy_from_slice(replacement);
    GainTable::from_bytes(&sealed(bytes)).unwrap_err()
}

#[test]
fn every_field_is_where_the_page_says_and_comes_back() {
    for knots in [2, 33, KNOTS_MAX] {
        let gains = gains_over_time(knots);
        let bytes = schedule_bytes(&gains);
        assert_eq!(bytes.len(), 205 + 144 * knots);
        assert_eq!(bytes[4..11], [2, 0, (193 + 144 * knots) as u8, ((193 + 144 * knots) >> 8) as u8, 4, 4, 9]);
        assert_eq!(bytes[193..201], [knots as u8, 0, 25, 0, 0x44, 0x33, 0x22, 0x11], "knots, spacing, trajectory");
        let of_file: Vec<f32> =
            bytes[201..bytes.len() - 4].chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
        assert_eq!(of_file, gains.as_flattened().as_flattened());

        let read = GainTable::from_bytes(&bytes).unwrap();
        assert_eq!((read.head(), bytes_of(&read)), (&head("along"), bytes.clone()));
        assert_eq!((read.rows(), read.owned()), (None, None), "its gains are where the bytes are");
        let schedule = read.schedule().unwrap();
        assert_eq!((schedule.knots(), schedule.steps_per_knot(), schedule.trajectory()), (knots, 25, TRAJECTORY));
        assert_eq!((0..).map_while(|knot| schedule.gain(knot)).collect::<Vec<_>>(), gains);
    }
    // A compile-time fact of two constants, in different modules of the core.
    const { assert!(TABLE_BYTES_MAX <= BLOB_BYTES_MAX, "a board has room for it") };
}

#[test]
fn a_kind_is_told_before_anything_is_read() {
    let bytes = schedule_bytes(&gains_over_time(4));
    assert_eq!(TableKind::of(&bytes), Ok(TableKind::AlongTrajectory));
    for (name, _) in tables() {
        assert_eq!(TableKind::of(&bytes_of(&table(name))), Ok(table(name).kind()));
    }
    assert!(matches!(TableKind::of(&bytes[1..]), Err(TableError::Magic { .. })));
}

#[test]
fn knots_and_their_spacing_are_possible_ones() {
    for found in [0, 1, 61, u16::MAX] {
        assert_eq!(refusal(193, &found.to_le_bytes()), TableError::Knots { found });
        let gains = gains_over_time(usize::from(found));
        let rows = ScheduleRows { trajectory: 0, steps_per_knot: 1, gains: &gains };
        let written = GainTable::along(&mut [0; TABLE_BYTES_MAX], &head("along"), &rows).map(|_| ());
        assert_eq!(written, Err(TableError::Knots { found }));
    }
    assert_eq!(refusal(195, &[0, 0]), TableError::KnotSpacing);
    // Four knots have 781 bytes.
    for found in [2_u16, 3, 5, 60] {
        let wanted = 205 + 144 * u32::from(found);
        assert_eq!(refusal(193, &found.to_le_bytes()), TableError::Length { bytes: 781, wanted });
    }
}

#[test]
fn every_entry_of_every_knot_is_looked_at() {
    for (knot, row, column) in (0..4).flat_map(|k| (0..4).flat_map(move |row| (0..9).map(move |c| (k, row, c)))) {
        let at = 201 + 4 * (36 * knot + 9 * row + column);
        let knot = knot as u16;
        for bad in [f32::NAN, f32::INFINITY] {
            let fault = KnotFault::Gain(GainError::NonFinite { row, column });
            assert_eq!(refusal(at, &bad.to_le_bytes()), TableError::Knot { knot, fault });
        }
        for value in [-1.1e4_f32, 0.9e-9] {
            let fault = KnotFault::Entry { row: row as u8, column: column as u8, value };
            assert_eq!(refusal(at, &value.to_le_bytes()), TableError::Knot { knot, fault });
        }
    }
    let mut unused = gains_over_time(4);
    unused[2][2][4] = 0.0;
    let rows = ScheduleRows { trajectory: 0, steps_per_knot: 1, gains: &unused };
    let written = GainTable::along(&mut [0; TABLE_BYTES_MAX], &head("along"), &rows).map(|_| ());
    let fault = KnotFault::Gain(GainError::UnusedError { column: 4 });
    assert_eq!(written, Err(TableError::Knot { knot: 2, fault }));
    assert_eq!(
        TableError::Knot { knot: 2, fault }.to_string(),
        "gain table: knot 2: gain: column 4 is zero; every error must have an answer; design it again"
    );
}

#[test]
fn head_and_frame_are_looked_at_as_in_every_table() {
    assert_eq!(refusal(101, &[0; 32]), TableError::NoDesign);
    assert_eq!(refusal(133, &[0; 32]), TableError::NoCertificate);
    assert_eq!(refusal(77, &[0; 4]), TableError::Rate { hz: 0 });
    let bytes = schedule_bytes(&gains_over_time(4));
    for length in 0..bytes.len() {
        let refused = GainTable::from_bytes(&bytes[..length]);
        assert!(matches!(refused, Err(TableError::Length { .. })), "{length} bytes: {refused:?}");
        let gains = gains_over_time(4);
        let rows = ScheduleRows { trajectory: 0, steps_per_knot: 1, gains: &gains };
        let written = GainTable::along(&mut vec![0; length], &head("along"), &rows).map(|_| ());
        assert_eq!(written, Err(TableError::Length { bytes: length as u32, wanted: 781 }));
    }
    for bit in 0..bytes.len() * 8 {
        let mut broken = bytes.clone();
        broken[bit / 8] ^= 1 << (bit % 8);
        assert!(GainTable::from_bytes(&broken).is_err(), "bit {bit}");
    }
}

#[test]
fn a_table_for_another_board_or_trajectory_is_told() {
    let hover = |duration_ns| [Piece { duration_ns, x: [0.0; 8], y: [0.0; 8], z: [0.0; 8], heading: [0.0; 8] }];
    let (flown, other) = (hover(1_000_000_000), hover(1_000_000_001));
    let (flown, other) = (Trajectory::new(&flown).unwrap(), Trajectory::new(&other).unwrap());
    let gains = gains_over_time(4);
    let rows = ScheduleRows { trajectory: flown.checksum(), steps_per_knot: 25, gains: &gains };
    let mut buffer = [0; TABLE_BYTES_MAX];
    let table = GainTable::along(&mut buffer, &head("along"), &rows).unwrap();
    let accepted = table.accept_for(&VEHICLE, rate()).unwrap();
    assert!(accepted.is_for(&flown) && !accepted.is_for(&other));

    let heavier = Vehicle { id: 1, ..VEHICLE };
    assert_eq!(table.accept_for(&heavier, rate()), Err(AcceptError::Vehicle { table: VEHICLE }));
    let refused = table.accept_for(&VEHICLE, Rate::from_hz(100).unwrap());
    assert_eq!(refused, Err(AcceptError::Rate { table_hz: 500, loop_hz: 100 }));
}

fn command(controller: &Controller<'_>, tick: u32) -> Step {
    let hover = Reference::hover(Vector3::zeros(), 0.0).unwrap();
    let state = State::at_rest(Vector3::new(0.1, -0.2, 0.3));
    let target = Target::new(&hover).at(Some(Progress { trajectory: TRAJECTORY, tick }));
    step_on(controller, &mut Memory::at_rest(), &state, target).unwrap()
}

#[test]
fn an_uploaded_table_is_put_to_use_as_a_whole_and_gone_back_from() {
    let mut store: GainStore = GainStore::new(VEHICLE, rate());
    let player_rate = Rate::from_hz(1000).unwrap();
    let settings = Settings { feed_forward: FeedForward::With, ..Settings::new(Limits::NONE, player_rate) };
    assert!(store.active().is_none() && !store.revert());
    let blobs = [4, 60].map(|knots| schedule_bytes(&gains_over_time(knots)));
    for (blob, last_gain) in blobs.iter().zip([3.0_f32, 59.0]) {
        store.commit(blob).unwrap();
        let direct = GainTable::from_bytes(blob).unwrap();
        let direct = direct.accept_for(&VEHICLE, rate()).unwrap().controller(&settings).unwrap();
        // Within the tighter limits of the two, which are the table's; its gain alone is looked at here.
        let stored = Controller::new(store.active().unwrap().law(&settings).unwrap(), Limits::NONE);
        for tick in [0, 17, 50, 1_000_000] {
            let unlimited = Controller::new(*direct.law(), Limits::NONE);
            assert_eq!(command(&stored, tick), command(&unlimited, tick), "tick {tick}");
        }
        // Of the last knot, k / 64 stiffer than LQR-E, with k / 64 from x besides.
        let thrust = 9.81 - 0.3 * 100.0 * (1.0 + last_gain / 64.0) - 0.1 * last_gain / 64.0;
        assert!((command(&stored, u32::MAX).command.thrust_m_s2 - thrust).abs() < 1e-4);
        assert_eq!(command(&direct, u32::MAX).command.thrust_m_s2, 1.75, "the table's least thrust");
    }
    let mut damaged = blobs[0].clone();
    damaged[300] ^= 1;
    assert!(matches!(store.commit(&damaged), Err(LoadError::Table(TableError::Checksum { .. }))));
    assert_eq!(store.active().map(|table| table.head().name), Some(head("along").name), "the table in use stays");
    let sixty = store.active().map(|table| last_thrust(&table));
    assert!(store.revert());
    assert_ne!(store.active().map(|table| last_thrust(&table)), sixty, "the table before");
    assert!(store.revert());
    assert_eq!(store.active().map(|table| last_thrust(&table)), sixty, "and back");
    // One of another kind takes its place as any other does.
    store.commit(&bytes_of(&table("lqr-e"))).unwrap();
    assert_eq!(store.active().map(|table| table.kind()), Some(TableKind::Equilibrium));
}

/// The difference between two tables in a store: the thrust of their last gain.
fn last_thrust(table: &quatrack::gains::table::AcceptedTable<'_>) -> u32 {
    let settings = Settings::new(Limits::NONE, rate());
    let controller = Controller::new(table.law(&settings).unwrap(), Limits::NONE);
    command(&controller, u32::MAX).command.thrust_m_s2.to_bits()
}

/// The properties of every table that comes out of any bytes.
fn holds_for_a_table(bytes: &[u8]) -> Result<bool, TestCaseError> {
    let Ok(read) = GainTable::from_bytes(bytes) else { return Ok(false) };
    let Some(schedule) = read.schedule() else { return Ok(false) };
    let gains: Vec<_> = (0..).map_while(|knot| schedule.gain(knot)).collect();
    let rows =
        ScheduleRows { trajectory: schedule.trajectory(), steps_per_knot: schedule.steps_per_knot(), gains: &gains };
    let mut buffer = [0; TABLE_BYTES_MAX];
    let again = GainTable::along(&mut buffer, read.head(), &rows).unwrap();
    prop_assert_eq!(bytes_of(&again), bytes, "one table has one encoding");
    prop_assert_eq!(bytes_of(&read), bytes, "read or written");
    Ok(true)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn damage_under_a_good_checksum_gives_a_sound_table_or_none(
        knots in 2..8_usize, changes in vec((any::<prop::sample::Index>(), any::<u8>()), 1..4)
    ) {
        let mut bytes = schedule_bytes(&gains_over_time(knots));
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        holds_for_a_table(&sealed(bytes.clone()))?;
        holds_for_a_table(&bytes)?;
    }

    #[test]
    fn gains_of_a_usual_size_are_a_table(entries in vec(1e-3_f32..50.0, 36 * 3)) {
        let mut bytes = schedule_bytes(&gains_over_time(3));
        for (at, entry) in (201..).step_by(4).zip(entries) {
            bytes[at..at + 4].copy_from_slice(&entry.to_le_bytes());
        }
        prop_assert!(holds_for_a_table(&sealed(bytes))?);
    }
}
