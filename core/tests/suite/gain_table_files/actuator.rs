//! Tables for the law that commands motor forces: where every field stands, each reason for a refusal, any bytes.

use proptest::collection::vec;
use proptest::prelude::*;
use quatrack::gain::GainError;
use quatrack::gains::table::{
    ACTUATOR_TABLE_BYTES, AcceptError, AcceptedActuatorTable, ActuatorTable, GainTable, LoadError, ScheduleTable,
    TableError, TableKind, Vehicle,
};
use quatrack::nalgebra::Vector3;
use quatrack::{ActuatorMemory, Airframe, MotorLaw, MotorReference, MotorTracker, Rate, RigidState, State};

use super::fixture::{VEHICLE, bytes_of, head, rate, sealed, table, tables};

const LAG_S: f32 = 0.025;

/// A gain without any zero or symmetry, so that a field out of place shows.
fn rows() -> [[f32; 19]; 4] {
    std::array::from_fn(|row| std::array::from_fn(|column| 0.01 * (19 * row + column + 1) as f32))
}

fn actuator_bytes() -> Vec<u8> {
    let table = ActuatorTable::new(head("motors"), LAG_S, &rows()).unwrap();
    table.to_bytes(&mut [0; ACTUATOR_TABLE_BYTES]).unwrap().to_vec()
}

/// What the table is refused for after some of its bytes have been replaced, checksum made anew.
fn refusal(offset: usize, replacement: &[u8]) -> TableError {
    let mut bytes = actuator_bytes();
    bytes[offset..offset + replacement.len()].copy_from_slice(replacement);
    ActuatorTable::from_bytes(&sealed(bytes)).unwrap_err()
}

#[test]
fn every_field_stands_where_the_page_says_and_comes_back() {
    let bytes = actuator_bytes();
    assert_eq!((bytes.len(), ACTUATOR_TABLE_BYTES), (491, 491));
    assert_eq!(bytes[8..11], [5, 4, 19]);
    assert_eq!(bytes[179..183], LAG_S.to_le_bytes());
    let entries: Vec<f32> = bytes[183..487].chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
    assert_eq!(entries, rows().as_flattened());
    let read = ActuatorTable::from_bytes(&bytes).unwrap();
    assert_eq!((read.head(), read.lag().lag_s(), read.gain().gain().rows()), (&head("motors"), LAG_S, &rows()));
    assert_eq!(read.lag().period_s(), 0.002);
    assert_eq!(read.to_bytes(&mut [0; ACTUATOR_TABLE_BYTES - 1]), None);
}

#[test]
fn a_kind_is_read_by_its_own_reader_alone() {
    let (bytes, kind) = (actuator_bytes(), TableKind::ActuatorAware);
    assert_eq!(TableKind::of(&bytes), Ok(kind));
    assert_eq!(GainTable::from_bytes(&bytes), Err(TableError::OtherKind { kind }));
    assert_eq!(ScheduleTable::from_bytes(&bytes), Err(TableError::OtherKind { kind }));
    for (name, _) in tables() {
        let table = table(name);
        let refused = Err(TableError::OtherKind { kind: table.kind() });
        assert_eq!(ActuatorTable::from_bytes(&bytes_of(&table)), refused, "{name}");
    }
}

#[test]
fn the_lag_is_one_that_can_be_followed_and_is_certified() {
    // Two periods of 500 Hz; the certificate's largest lag is 31.25 ms.
    for lag_s in [0.0_f32, -0.025, 0.0039, 0.0313, f32::INFINITY] {
        assert_eq!(refusal(179, &lag_s.to_le_bytes()), TableError::MotorLag { lag_s });
        assert_eq!(ActuatorTable::new(head("motors"), lag_s, &rows()), Err(TableError::MotorLag { lag_s }));
    }
    assert!(matches!(refusal(179, &f32::NAN.to_le_bytes()), TableError::MotorLag { .. }));
    assert_eq!(
        TableError::MotorLag { lag_s: 0.5 }.to_string(),
        "gain table: designed for a motor lag of 0.5 s; must be from two control periods to the largest that is certified"
    );
}

#[test]
fn every_entry_is_looked_at() {
    for (row, column) in (0..4).flat_map(|row| (0..19).map(move |column| (row, column))) {
        let at = 183 + 4 * (19 * row + column);
        let not_finite = TableError::Gain(GainError::NonFinite { row, column });
        assert_eq!(refusal(at, &f32::NAN.to_le_bytes()), not_finite);
        for value in [-1.1e4_f32, 0.9e-9] {
            let refused = TableError::Entry { row: row as u8, column: column as u8, value };
            assert_eq!(refusal(at, &value.to_le_bytes()), refused);
        }
    }
    let mut unused = rows();
    unused.iter_mut().for_each(|row| row[13] = 0.0);
    let refused = Err(TableError::Gain(GainError::UnusedError { column: 13 }));
    assert_eq!(ActuatorTable::new(head("motors"), LAG_S, &unused), refused);
}

#[test]
fn an_accepted_table_flies_its_vehicle_with_its_lag() {
    let bytes = actuator_bytes();
    let table = AcceptedActuatorTable::from_bytes(&bytes, &VEHICLE, rate()).unwrap();
    let airframe = table.airframe(&Airframe::CRAZYFLIE_2_1);
    assert_eq!(airframe.figures().motor_lag_s, LAG_S);
    assert_eq!(airframe, Airframe::CRAZYFLIE_2_1.with_motor_lag(LAG_S).unwrap().commanded_at(rate()));
    let tracker = MotorTracker::new(MotorLaw::ActuatorAware(table.law(&airframe)), &airframe);
    let at = Vector3::new(0.0, 0.0, 1.0);
    let reference = MotorReference::hover(at, 0.0, &airframe).unwrap();
    let state = RigidState { state: State::at_rest(at), body_rates_rad_s: Vector3::zeros() };
    let step = tracker.step(&mut ActuatorMemory::hovering(&airframe), &state, &reference).unwrap();
    assert_eq!(step.forces_n, [airframe.hover_force_n(); 4]);

    let other = Vehicle { id: 1, ..VEHICLE };
    let refused = AcceptedActuatorTable::from_bytes(&bytes, &other, rate());
    assert_eq!(refused, Err(LoadError::Accept(AcceptError::Vehicle { table: VEHICLE })));
    let refused = AcceptedActuatorTable::from_bytes(&bytes, &VEHICLE, Rate::from_hz(1000).unwrap());
    assert_eq!(refused, Err(LoadError::Accept(AcceptError::Rate { table_hz: 500, loop_hz: 1000 })));
}

proptest! {
    #[test]
    fn any_cut_or_flipped_bit_is_refused(at in 0_usize..491, bit in 0_u32..8) {
        let mut bytes = actuator_bytes();
        prop_assert!(ActuatorTable::from_bytes(&bytes[..at]).is_err());
        bytes[at] ^= 1 << bit;
        prop_assert!(ActuatorTable::from_bytes(&bytes).is_err());
    }

    #[test]
    fn any_payload_is_refused_or_comes_back(noise in vec(any::<u8>(), 0..308), at in 8_usize..480) {
        let mut bytes = actuator_bytes();
        for (byte, noise) in bytes[at..487].iter_mut().zip(noise) {
            *byte = noise;
        }
        let bytes = sealed(bytes);
        if let Ok(table) = ActuatorTable::from_bytes(&bytes) {
            let mut again = [0; ACTUATOR_TABLE_BYTES];
            prop_assert_eq!(table.to_bytes(&mut again), Some(&bytes[..]));
        }
    }
}
