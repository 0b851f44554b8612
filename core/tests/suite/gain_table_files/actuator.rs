//! Tables for the law that commands motor forces: the offset of every field, each reason for a refusal, any bytes.

use proptest::collection::vec;
use proptest::prelude::*;
use quatrack::gain::GainError;
use quatrack::gains::table::{AcceptError, CONSTANT_TABLE_BYTES_MAX, GainTable, Rows, TableError, TableKind, Vehicle};
use quatrack::nalgebra::Vector3;
use quatrack::{
    Actuation, Airframe, ControllerError, Limits, Memory, MotorReference, Rate, RigidState, Settings, State,
};

use super::fixture::{VEHICLE, bytes_of, head, rate, sealed};

const LAG_S: f32 = 0.025;

/// A gain without any zero or symmetry, so that a field out of place shows.
fn rows() -> [[f32; 19]; 4] {
    std::array::from_fn(|row| std::array::from_fn(|column| 0.01 * (19 * row + column + 1) as f32))
}

fn actuator_bytes() -> Vec<u8> {
    bytes_of(&written(LAG_S, rows()).unwrap())
}

fn written(motor_lag_s: f32, rows: [[f32; 19]; 4]) -> Result<GainTable<'static>, TableError> {
    GainTable::new(head("motors"), &Rows::ActuatorAware { motor_lag_s, rows })
}

/// The error of the table after some of its bytes have been replaced, checksum made anew.
fn refusal(offset: usize, replacement: &[u8]) -> TableError {
    let mut bytes = actuator_bytes();
    bytes[offset..offset + replacement.len()].copy_from_slice(replacement);
    GainTable::from_bytes(&sealed(bytes)).unwrap_err()
}

#[test]
fn every_field_is_where_the_page_says_and_comes_back() {
    let bytes = actuator_bytes();
    assert_eq!((bytes.len(), CONSTANT_TABLE_BYTES_MAX), (505, 505));
    assert_eq!(bytes[8..11], [5, 4, 19]);
    assert_eq!(bytes[193..197], LAG_S.to_le_bytes());
    let entries: Vec<f32> = bytes[197..501].chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
    assert_eq!(entries, rows().as_flattened());
    let read = GainTable::from_bytes(&bytes).unwrap();
    assert_eq!((read.head(), read.kind()), (&head("motors"), TableKind::ActuatorAware));
    assert_eq!(read.rows(), Some(Rows::ActuatorAware { motor_lag_s: LAG_S, rows: rows() }));
    assert_eq!(read.lag().unwrap().period_s(), 0.002);
    assert_eq!(read.to_bytes(&mut [0; CONSTANT_TABLE_BYTES_MAX - 1]), None);
}

#[test]
fn the_lag_is_one_that_can_be_followed_and_is_certified() {
    // Two periods of 500 Hz; the certificate's largest lag is 31.25 ms.
    for lag_s in [0.0_f32, -0.025, 0.0039, 0.0313, f32::INFINITY] {
        assert_eq!(refusal(193, &lag_s.to_le_bytes()), TableError::MotorLag { lag_s });
        assert_eq!(written(lag_s, rows()), Err(TableError::MotorLag { lag_s }));
    }
    assert!(matches!(refusal(193, &f32::NAN.to_le_bytes()), TableError::MotorLag { .. }));
    assert_eq!(
        TableError::MotorLag { lag_s: 0.5 }.to_string(),
        "gain table: designed for a motor lag of 0.5 s; must be from two control periods to the largest that is certified"
    );
}

#[test]
fn every_entry_is_looked_at() {
    for (row, column) in (0..4).flat_map(|row| (0..19).map(move |column| (row, column))) {
        let at = 197 + 4 * (19 * row + column);
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
    assert_eq!(written(LAG_S, unused), refused);
}

#[test]
fn an_accepted_table_flies_its_vehicle_with_its_lag() {
    let bytes = actuator_bytes();
    let read = GainTable::from_bytes(&bytes).unwrap();
    let table = read.accept_for(&VEHICLE, rate()).unwrap();
    let board = Actuation::new(&Airframe::CRAZYFLIE_2_1, rate()).unwrap();
    let actuation = table.actuation(&board);
    let airframe = actuation.airframe();
    assert_eq!(airframe.figures().motor_lag_s, LAG_S);
    assert_eq!(*airframe, Airframe::CRAZYFLIE_2_1.with_motor_lag(LAG_S).unwrap().commanded_at(rate()));
    let settings = Settings { actuation: Some(&actuation), ..Settings::new(Limits::NONE, rate()) };
    let controller = table.controller(&settings).unwrap();
    let at = Vector3::new(0.0, 0.0, 1.0);
    let reference = MotorReference::hover(at, 0.0, airframe).unwrap();
    let state = RigidState { state: State::at_rest(at), body_rates_rad_s: Vector3::zeros() };
    let mut memory = Memory::hovering(airframe);
    let step = controller.step_to_motors(&mut memory, (&state).into(), (&reference).into()).unwrap();
    assert_eq!(step.forces_n, [airframe.hover_force_n(); 4]);
    // Without motors, or with those of another lag, it is not flown.
    let none = table.controller(&Settings::new(Limits::NONE, rate()));
    assert_eq!(none.err(), Some(ControllerError::NoActuation));
    let other = table.controller(&Settings { actuation: Some(&board), ..settings });
    assert_eq!(other.err(), Some(ControllerError::MotorLag { table_s: LAG_S, actuation_s: 0.126 }));

    let other = Vehicle { id: 1, ..VEHICLE };
    assert_eq!(read.accept_for(&other, rate()), Err(AcceptError::Vehicle { table: VEHICLE }));
    let refused = read.accept_for(&VEHICLE, Rate::from_hz(1000).unwrap());
    assert_eq!(refused, Err(AcceptError::Rate { table_hz: 500, loop_hz: 1000 }));
    // 31.25 ms are certified, and half of the gain margin is left of none: 1 + (2 - 1) / 2 at 0, 1 at the end.
    assert_eq!(table.margin_behind(0.0), Ok(1.5));
    assert_eq!(table.margin_behind(0.03125), Ok(1.0));
    let refused = Err(AcceptError::MotorLag { lag_max_s: 0.03125, motor_lag_s: 0.126 });
    assert_eq!(table.margin_behind(0.126), refused);
}

proptest! {
    #[test]
    fn any_cut_or_flipped_bit_is_refused(at in 0_usize..505, bit in 0_u32..8) {
        let mut bytes = actuator_bytes();
        prop_assert!(GainTable::from_bytes(&bytes[..at]).is_err());
        bytes[at] ^= 1 << bit;
        prop_assert!(GainTable::from_bytes(&bytes).is_err());
    }

    #[test]
    fn any_payload_is_refused_or_comes_back(noise in vec(any::<u8>(), 0..308), at in 8_usize..480) {
        let mut bytes = actuator_bytes();
        for (byte, noise) in bytes[at..501].iter_mut().zip(noise) {
            *byte = noise;
        }
        let bytes = sealed(bytes);
        if let Ok(table) = GainTable::from_bytes(&bytes) {
            let mut again = [0; CONSTANT_TABLE_BYTES_MAX];
            prop_assert_eq!(table.to_bytes(&mut again), Some(&bytes[..]));
        }
    }
}
