//! Tables of the cascade: where every field is, each reason for a refusal, the law that comes of one.

use proptest::collection::vec;
use proptest::prelude::*;
use quatrack::cascade::{Air, CascadeGains, CascadeLimits};
use quatrack::gains::cascade::{BRUSHLESS_50_MS, CRAZYFLIE_2_1, UPGRADE_KIT};
use quatrack::gains::table::{
    CascadeFigure, CascadeRange, CascadeTable, GainTable, TableError, TableHead, TableKind, Vehicle,
};
use quatrack::nalgebra::Vector3;
use quatrack::{
    Airframe, ControllerError, FifthOrderSample, Heading, Limits, Measured, Memory, RigidState, Settings, State, Target,
};

use super::fixture::{VEHICLE, bytes_of, head, rate, sealed};

/// Bytes of a table; where the fields behind the head begin, and the gains.
const BYTES: usize = 326;
const FIELDS: usize = 193;
const GAINS: usize = FIELDS + 65;

fn wide_head() -> TableHead {
    let mut head = head("cascade");
    head.certificate.motor_lag_max_s = 0.125;
    head
}

fn figures() -> CascadeTable {
    CascadeTable {
        gains: BRUSHLESS_50_MS.table.gains,
        motor_lag_s: 0.0625,
        air: Air { drag_per_s: 0.375, drag_along_share: 1.25, moment_n_s: [5e-4, 7e-4], gust: 0.5, learn: true },
        certified: CascadeRange {
            motor_lag_s: [0.03125, 0.09375],
            mass_share: 0.1875,
            inertia_share: 0.25,
            force_share: [0.75, 1.0625],
            delay_s: 0.0078125,
            drag_per_s: 0.625,
            moment_n_s: [8e-4, 11e-4],
        },
    }
}

fn written(table: &CascadeTable) -> Result<GainTable<'static>, TableError> {
    GainTable::of_cascade(wide_head(), table)
}

fn cascade_bytes() -> Vec<u8> {
    bytes_of(&written(&figures()).unwrap())
}

fn refusal(offset: usize, replacement: &[u8]) -> TableError {
    let mut bytes = cascade_bytes();
    bytes[offset..offset + replacement.len()].copy_from_slice(replacement);
    GainTable::from_bytes(&sealed(bytes)).unwrap_err()
}

#[test]
fn every_field_is_where_the_page_says_and_comes_back() {
    let bytes = cascade_bytes();
    assert_eq!(bytes.len(), BYTES);
    assert_eq!(bytes[4..11], [2, 0, (BYTES - 12) as u8, ((BYTES - 12) >> 8) as u8, 6, 1, 16]);
    let numbers = |from: usize, to: usize| -> Vec<f32> {
        bytes[from..to].chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect()
    };
    assert_eq!(
        numbers(FIELDS, GAINS - 1),
        [
            0.0625, 0.03125, 0.09375, 0.1875, 0.25, 0.75, 1.0625, 0.0078125, 0.625, 8e-4, 11e-4, 0.375, 1.25, 5e-4,
            7e-4, 0.5
        ]
    );
    assert_eq!(bytes[GAINS - 1], 1, "it learns");
    assert_eq!(numbers(GAINS, BYTES - 4), figures().gains.numbers());
    let read = GainTable::from_bytes(&bytes).unwrap();
    assert_eq!((read.kind(), read.head(), read.cascade()), (TableKind::Cascade, &wide_head(), Some(&figures())));
    assert_eq!((read.gain(), read.rows(), read.lag().unwrap().lag_s()), (None, None, 0.0625));
    assert_eq!(bytes_of(&read.owned().unwrap()), bytes);
}

#[test]
fn every_figure_without_sense_is_named() {
    use CascadeFigure::{
        Delay, Drag, ForceShare, Inertia, Learn, Mass, Moment, MotorLag, ToldDrag, ToldDragAlong, ToldGust, ToldMoment,
    };
    let nan = f32::NAN;
    // In the order of the fields behind the lag of the design, with values that each may not have.
    let fields: [(CascadeFigure, [f32; 3]); 15] = [
        (MotorLag, [0.0, 0.07, nan]),
        (MotorLag, [0.06, 0.126, nan]),
        (Mass, [-0.1, 0.91, nan]),
        (Inertia, [-0.1, 0.91, nan]),
        (ForceShare, [0.0, 1.01, nan]),
        (ForceShare, [0.99, 11.0, nan]),
        (Delay, [-1e-3, 0.0626, nan]),
        (Drag, [-0.1, f32::INFINITY, nan]),
        (Moment, [-1e-4, 1.1, nan]),
        (Moment, [-1e-4, 1.1, nan]),
        (ToldDrag, [-0.1, 1.01, nan]),
        (ToldDragAlong, [-0.1, 2.1, nan]),
        (ToldMoment, [-1e-4, 2.1e-3, nan]),
        (ToldMoment, [-1e-4, 2.1e-3, nan]),
        (ToldGust, [-0.1, 1.1, nan]),
    ];
    for (place, (named, values)) in fields.into_iter().enumerate() {
        for bad in values {
            let refused = refusal(FIELDS + 4 * (place + 1), &bad.to_le_bytes());
            let TableError::Cascade { figure, value } = refused else { panic!("{place}: {refused}") };
            assert!(figure == named && (value == bad || value.is_nan() && bad.is_nan()), "{place}: {refused}");
        }
    }
    assert!(matches!(refusal(GAINS - 1, &[2]), TableError::Cascade { figure: Learn, .. }));
    // A lag below two periods of 500 Hz, within a range that goes as far down.
    let short = CascadeTable {
        motor_lag_s: 0.0039,
        certified: CascadeRange { motor_lag_s: [0.003, 0.09], ..figures().certified },
        ..figures()
    };
    assert_eq!(written(&short), Err(TableError::MotorLag { lag_s: 0.0039 }));
    for index in 0..CascadeGains::COUNT {
        for value in [0.0, -f32::MAX, 1.1e4, -figures().gains.numbers()[index]] {
            let figure = CascadeFigure::Gain { index: index as u8 };
            let refused = refusal(GAINS + 4 * index, &value.to_le_bytes());
            assert_eq!(refused, TableError::Cascade { figure, value });
        }
    }
    assert_eq!(
        refusal(FIELDS + 12, &1.5_f32.to_le_bytes()).to_string(),
        "gain table: certified share of mass is 1.5; design it again"
    );
}

#[test]
fn an_accepted_table_flies_the_craft_that_it_is_made_for() {
    let bytes = cascade_bytes();
    let read = GainTable::from_bytes(&bytes).unwrap();
    let accepted = read.accept_for(&VEHICLE, rate()).unwrap();
    assert!(read.accept_for(&Vehicle { id: 1, ..VEHICLE }, rate()).is_err());
    let table = accepted.cascade().unwrap();
    let airframe = Airframe::CRAZYFLIE_2_1;
    let cascade = table.flown(&airframe, rate(), &CascadeLimits::STANDARD, &table.air).unwrap();
    assert_eq!(cascade.airframe().figures().motor_lag_s, 0.0625, "of the table, not of the craft");
    let settings = Settings { cascade: Some(&cascade), ..Settings::new(Limits::NONE, rate()) };
    let controller = accepted.controller(&settings).unwrap();
    assert!(controller.law().follows_samples());

    let at = Vector3::new(0.0, 0.0, 1.0);
    let state = RigidState { state: State::at_rest(at), body_rates_rad_s: Vector3::zeros() };
    let mut memory = Memory::hovering(&airframe);
    let sample = FifthOrderSample::at_rest(at, 0.0);
    let target = Target::with_sample(&sample, Heading::from_angle(0.0));
    let step = controller.step_to_motors(&mut memory, Measured::from(&state), target).unwrap();
    for force in step.forces_n {
        // A rounding of each of some sums.
        assert!((force - airframe.hover_force_n()).abs() < 1e-6, "{:?}", step.forces_n);
    }

    let none = accepted.controller(&Settings::new(Limits::NONE, rate()));
    assert_eq!(none.err(), Some(ControllerError::NoCascade));
    let other = BRUSHLESS_50_MS.table.flown(&airframe, rate(), &CascadeLimits::STANDARD, &Air::NONE).unwrap();
    let refused = accepted.controller(&Settings { cascade: Some(&other), ..settings });
    assert_eq!(refused.err(), Some(ControllerError::MotorLag { table_s: 0.0625, actuation_s: 0.05 }));
}

#[test]
fn a_range_holds_its_ends_and_nothing_beyond() {
    let range = figures().certified;
    for (lag_s, held) in [(0.03125, true), (0.09375, true), (0.031, false), (0.094, false), (f32::NAN, false)] {
        assert_eq!(range.holds_lag(lag_s), held, "{lag_s}");
    }
    for (mass_kg, held) in [(1.1875, true), (0.8125, true), (1.19, false), (0.81, false), (f32::NAN, false)] {
        assert_eq!(range.holds_mass(1.0, mass_kg), held, "{mass_kg}");
    }
    assert!(range.holds_air(0.625, [8e-4, 11e-4]) && range.holds_air(0.0, [0.0; 2]));
    assert!(
        !range.holds_air(0.63, [0.0; 2]) && !range.holds_air(0.1, [0.0, 12e-4]) && !range.holds_air(-0.1, [0.0; 2])
    );
}

#[test]
fn the_built_in_tables_cover_the_lags_that_an_owner_may_state() {
    for tables in [CRAZYFLIE_2_1, UPGRADE_KIT] {
        for lag_ms in 10..=126 {
            let lag_s = 1e-3 * lag_ms as f32;
            assert!(tables.iter().any(|built_in| built_in.table.certified.holds_lag(lag_s)), "{lag_ms} ms");
        }
    }
}

proptest! {
    #[test]
    fn any_cut_or_flipped_bit_is_refused(at in 0_usize..BYTES, bit in 0_u32..8) {
        let mut bytes = cascade_bytes();
        prop_assert!(GainTable::from_bytes(&bytes[..at]).is_err());
        bytes[at] ^= 1 << bit;
        prop_assert!(GainTable::from_bytes(&bytes).is_err());
    }

    #[test]
    fn any_payload_is_refused_or_comes_back(noise in vec(any::<u8>(), 0..130), at in 8_usize..320) {
        let mut bytes = cascade_bytes();
        for (byte, noise) in bytes[at..BYTES - 4].iter_mut().zip(noise) {
            *byte = noise;
        }
        let bytes = sealed(bytes);
        if let Ok(table) = GainTable::from_bytes(&bytes) {
            prop_assert_eq!(bytes_of(&table), bytes);
        }
    }
}
