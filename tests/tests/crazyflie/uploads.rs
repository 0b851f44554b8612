//! Tables that come over the app channel in flight, and the owner's settings beside them.

use std::sync::atomic::Ordering::Relaxed;

use nalgebra::Vector3;
use quatrack::Limits;
use quatrack::gains::paper;
use quatrack::gains::table::{
    Certificate, GainTable, Hash, Margins, Name, Rows, TABLE_BYTES_MAX, TableHead, Vehicle as TableVehicle,
};
use quatrack_crazyflie::abi::{Attitude, Mode, Modes, Setpoint};
use quatrack_crazyflie::craft::{KNOWN, RATE};
use quatrack_crazyflie::ffi;
use quatrack_crazyflie::shared::AtomicF32;
use quatrack_crazyflie::tables::Refusal;
use quatrack_crazyflie::upload::{PACKET_BYTES, Packet, Status};
use quatrack_simulation::crazyflie::{Course, Firmware, Setpoints, Tune};
use quatrack_simulation::gains::Design;
use quatrack_simulation::plant::{Craft, RigidState};
use quatrack_simulation::vehicles;

use super::tables::{LAG_S, QUIET};

/// LQR-E of the paper as a table, with limits of its own.
fn table_within(vehicle: TableVehicle, limits: Limits) -> Vec<u8> {
    table_of(vehicle, limits, &Rows::Equilibrium(*paper::LQR_E.gain().rows()))
}

/// The same within limits that any craft reaches.
fn known_lag_table(vehicle: TableVehicle) -> Vec<u8> {
    table_within(vehicle, Limits::new(1.8, 16.5, Vector3::new(20.0, 20.0, 10.0)).unwrap())
}

fn table_of(vehicle: TableVehicle, limits: Limits, rows: &Rows) -> Vec<u8> {
    let margins = Margins { gain_factor: 1.5, phase_rad: 0.4 };
    let head = TableHead {
        name: Name::literal("known-lag"),
        vehicle,
        rate: RATE,
        limits,
        design_hash: Hash([1; 32]),
        certificate: Certificate {
            hash: Hash([2; 32]),
            one_channel: margins,
            all_channels: margins,
            delay_max_s: 0.01,
            motor_lag_max_s: 0.0218,
            f32_distance: 1e-7,
        },
    };
    GainTable::new(head, rows).unwrap().to_bytes(&mut [0; TABLE_BYTES_MAX]).unwrap().to_vec()
}

fn exchange(bytes: &[u8]) -> (u8, u16) {
    let mut packet = Packet { length: bytes.len() as u8, bytes: [0; PACKET_BYTES] };
    packet.bytes[..bytes.len()].copy_from_slice(bytes);
    let mut answer = packet;
    ffi::quatrackPacket(&packet, &mut answer);
    assert_eq!((answer.length >= 4, answer.bytes[0]), (true, bytes[0]));
    (answer.bytes[1], u16::from_le_bytes([answer.bytes[2], answer.bytes[3]]))
}

/// Sends a table as a script on the ground does; the status of its last packet.
fn send(table: &[u8]) -> u8 {
    send_for_words(table).0
}

/// The same with the words of the answer.
pub(super) fn send_for_words(table: &[u8]) -> (u8, String) {
    let length = (table.len() as u16).to_le_bytes();
    let begin = [&[1][..], &length, &table[table.len() - 4..]].concat();
    assert_eq!(exchange(&begin), (Status::Taken as u8, 0));
    for (index, bytes) in table.chunks(27).enumerate() {
        let offset = (27 * index) as u16;
        let chunk = [&[2][..], &offset.to_le_bytes(), bytes].concat();
        assert_eq!(exchange(&chunk), (Status::Taken as u8, offset + bytes.len() as u16));
    }
    let mut packet = Packet { length: 1, bytes: [0; PACKET_BYTES] };
    packet.bytes[0] = 3;
    let mut answer = packet;
    ffi::quatrackPacket(&packet, &mut answer);
    let words = &answer.bytes[4..usize::from(answer.length)];
    (answer.bytes[1], String::from_utf8(words.to_vec()).unwrap())
}

/// Resets the sum that a table has to be sent with.
fn with_checksum(mut table: Vec<u8>) -> Vec<u8> {
    let end = table.len() - 4;
    let checksum = quatrack::checksum::crc32c(&table[..end]).to_le_bytes();
    table[end..].copy_from_slice(&checksum);
    table
}

#[test]
fn a_table_is_sent_in_flight_and_taken_over_without_a_bump() {
    let craft = vehicles::by_name("crazyflie-2.1").unwrap();
    let mut firmware = Firmware::start(&craft, &Tune::new(0, LAG_S.into()), QUIET);
    let mut plant = Craft::new(&craft);
    plant.motors = plant.motors.with_lag(LAG_S.into(), LAG_S.into());
    let course = Course::FigureEight(1.485);
    let mut state = RigidState::at_rest(Vector3::z(), craft.hover_thrust_n());
    let (mut after, mut largest_m) = (0.0, 0.0_f64);
    for step in 0..18_000_u32 {
        let t_s = f64::from(step) * 1e-3;
        if step == 8000 {
            assert_eq!(send(&known_lag_table(KNOWN[0].vehicle)), Status::Taken as u8);
            ffi::quatrack.parameters.table.store(5, Relaxed);
            ffi::quatrackService();
        }
        firmware.command(&course, t_s, Setpoints::HighLevel);
        let commands_n = firmware.step(&state, None);
        let error_m = (state.position_m - course.position_m(t_s).unwrap()).norm();
        if step >= 8000 {
            largest_m = largest_m.max(error_m);
        }
        if step >= 14_000 {
            after += error_m * 1e-3;
        }
        state = plant.hold(&state, &commands_n, t_s, 1e-3);
    }
    assert_eq!(ffi::quatrack.log.table.load(Relaxed), 5);
    // LQR-E, whose laws know nothing of the lag, strays 12 mm on this figure: it is faded to that.
    assert!(largest_m < 0.02, "{largest_m} m");
    assert!(after < 0.02, "{after} m s");
}

#[test]
fn an_actuator_aware_table_is_refused_by_name() {
    let craft = vehicles::by_name("crazyflie-2.1").unwrap();
    let _firmware = Firmware::start(&craft, &Tune::new(5, 0.0), QUIET);
    let (status, words) = send_for_words(include_bytes!("../../data/actuator-aware.bin"));
    assert_eq!((status, words.as_str()), (Status::ActuatorAware as u8, "actuator-aware: outdated"));
    assert_eq!(ffi::quatrack.log.refusal.load(Relaxed), Refusal::Law as u16);
}

#[test]
fn a_cascade_that_is_sent_flies_where_it_is_certified() {
    let craft = vehicles::by_name("crazyflie-2.1").unwrap();
    let mut firmware = Firmware::start(&craft, &Tune::new(5, 0.0635).in_vacuum(), QUIET);
    assert_eq!(send(include_bytes!("../../../gains/generated/cascade-brushless-50ms.bin")), Status::Vehicle as u8);
    assert_eq!(send(include_bytes!("../../../gains/generated/cascade-63ms.bin")), Status::Taken as u8);
    ffi::quatrackService();
    assert_eq!(ffi::quatrack.log.table.load(Relaxed), 5);
    let mut plant = Craft::new(&craft);
    plant.motors = plant.motors.with_lag(0.0635, 0.0635);
    let mut state = RigidState::at_rest(Vector3::z(), craft.hover_thrust_n());
    let course = Course::FigureEight(1.485);
    let mut strayed = 0.0;
    for step in 0..10_000_u32 {
        let t_s = f64::from(step) * 1e-3;
        firmware.command(&course, t_s, Setpoints::HighLevel);
        let commands_n = firmware.step(&state, None);
        if step >= 6000 {
            strayed += (state.position_m - course.position_m(t_s).unwrap()).norm() * 1e-3;
        }
        state = plant.hold(&state, &commands_n, t_s, 1e-3);
    }
    // A third of the error that 12 s of the table in the image may have.
    assert!(strayed < 0.0008, "{strayed} m s");
    // Certified to 95 ms.
    ffi::quatrack.parameters.motor_lag_s.set(0.1);
    ffi::quatrackService();
    assert_eq!(ffi::quatrack.log.refusal.load(Relaxed), Refusal::MotorLag as u16);
}

#[test]
fn a_table_with_an_integral_flies() {
    let craft = vehicles::by_name("crazyflie-2.1").unwrap();
    let mut firmware = Firmware::start(&craft, &Tune::new(0, 0.0178), QUIET);
    assert_eq!(send(include_bytes!("../../../gains/generated/lqi-e.bin")), Status::Taken as u8);
    ffi::quatrack.parameters.table.store(5, Relaxed);
    ffi::quatrackService();
    let mut plant = Craft::new(&craft);
    plant.motors = plant.motors.with_lag(0.0178, 0.0178);
    // 10 % more mass than told: an integral makes it good, and nothing else of the paper's does.
    plant.body = plant.body.scaled(1.1, 1.0);
    let mut state = RigidState::at_rest(Vector3::z(), craft.hover_thrust_n());
    let course = Course::Hover(Vector3::z());
    for step in 0..15_000_u32 {
        let t_s = f64::from(step) * 1e-3;
        firmware.command(&course, t_s.min(1.0), Setpoints::HighLevel);
        let commands_n = firmware.step(&state, None);
        state = plant.hold(&state, &commands_n, t_s, 1e-3);
    }
    assert_eq!(ffi::quatrack.log.table.load(Relaxed), 5);
    assert!((state.position_m - Vector3::z()).norm() < 0.002, "{}", state.position_m);
}

#[test]
fn tables_damaged_uncertified_or_for_another_craft_are_refused_and_change_nothing() {
    let craft = vehicles::by_name("crazyflie-2.1").unwrap();
    let _firmware = Firmware::start(&craft, &Tune::new(5, LAG_S.into()), QUIET);
    let good = known_lag_table(KNOWN[0].vehicle);

    assert_eq!(exchange(&[3]).0, Status::NotBegun as u8);
    assert_eq!(exchange(&[9]).0, Status::Unknown as u8);
    let mut damaged = good.clone();
    damaged[200] ^= 1;
    assert_eq!(send(&damaged), Status::Checksum as u8);
    // The hash of the certificate, at the end of the head but for its seven figures.
    let mut uncertified = good.clone();
    let hash_at = 8 + 3 + 2 * Name::BYTES + 8 + 20 + 32;
    uncertified[hash_at..hash_at + 32].fill(0);
    assert_eq!(send(&with_checksum(uncertified)), Status::Table as u8);
    assert_eq!(send(&known_lag_table(KNOWN[2].vehicle)), Status::Vehicle as u8);
    ffi::quatrackService();
    assert_eq!(ffi::quatrack.log.table.load(Relaxed), 0, "none has been taken");

    assert_eq!(send(&good), Status::Taken as u8);
    ffi::quatrackService();
    assert_eq!(ffi::quatrack.log.table.load(Relaxed), 5);
    // With the motors' lag back to the published one of the craft, 126 ms, its certificate does not reach.
    ffi::quatrack.parameters.motor_lag_s.set(0.0);
    let refused = ffi::quatrack.log.refused_tables.load(Relaxed);
    ffi::quatrackService();
    assert_eq!(ffi::quatrack.log.refused_tables.load(Relaxed), refused + 1);
}

#[test]
fn a_lag_is_stated_in_flight_and_one_that_nothing_is_certified_for_changes_nothing() {
    let craft = vehicles::by_name("crazyflie-2.1").unwrap();
    let _firmware = Firmware::start(&craft, &Tune::new(0, 0.0), QUIET);
    let state = |lag_s: f32| {
        ffi::quatrack.parameters.motor_lag_s.set(lag_s);
        ffi::quatrackService();
        let log = &ffi::quatrack.log;
        (log.refused_tables.load(Relaxed), ffi::quatrack.gains.entries[0].get(), log.table.load(Relaxed))
    };
    let (refused, unstated, _) = state(0.0);
    let (_, short, _) = state(0.02);
    assert!(short != unstated, "{short}");
    assert_eq!(state(0.2), (refused + 1, short, 0), "refused, the one before stays");
    assert_eq!(ffi::quatrack.log.refusal.load(Relaxed), Refusal::MotorLag as u16);
    assert_eq!(state(0.1), (refused + 1, unstated, 0), "the same design, told its own lag");
}

#[test]
fn limits_are_the_tighter_of_the_owners_and_the_tables() {
    let craft = KNOWN[0].airframe;
    // Four motors of 0.01282 to 0.12 N on 29 g: 1.768 to 16.55 m/s^2.
    let owner = Vector3::new(20.0, 20.0, 10.0);
    let physical = Limits::of(&craft, owner).within(&Limits::NONE);
    assert_eq!(physical.body_rates_max_rad_s(), owner);
    let wide = Limits::new(0.0, 50.0, Vector3::new(99.0, 99.0, 99.0)).unwrap();
    assert_eq!(Limits::of(&craft, owner).within(&wide), physical, "a table widens nothing");
    let tight = Limits::new(5.0, 15.0, Vector3::new(3.0, 30.0, 2.0)).unwrap();
    assert_eq!(Limits::of(&craft, owner).within(&tight), Limits::new(5.0, 15.0, Vector3::new(3.0, 20.0, 2.0)).unwrap());
    let beyond = Limits::new(20.0, 30.0, Vector3::new(3.0, 3.0, 3.0)).unwrap();
    let left = Limits::of(&craft, owner).within(&beyond);
    assert_eq!(
        (left.thrust_min_m_s2(), left.thrust_max_m_s2()),
        (physical.thrust_min_m_s2(), physical.thrust_max_m_s2())
    );
}

#[test]
fn a_sent_table_is_flown_within_its_own_limits() {
    let craft = vehicles::by_name("crazyflie-2.1").unwrap();
    let mut firmware = Firmware::start(&craft, &Tune::new(0, LAG_S.into()), QUIET);
    let plant = Craft::new(&craft);
    // Manual flight at 200 degrees a second of roll, which is 3.5 rad/s.
    let off = Mode::DISABLED;
    let mode =
        Modes { x: off, y: off, z: off, roll: Mode::VELOCITY, pitch: Mode::VELOCITY, yaw: Mode::VELOCITY, quat: off };
    let attitude_rate = Attitude { roll: 200.0, ..Attitude::default() };
    let thrust = 65_535.0 * 0.029 * 9.81 / 0.48;
    let setpoint = Setpoint { attitude_rate, thrust, mode, ..Setpoint::OFF };
    let roll_rate_after = |firmware: &mut Firmware| {
        let mut state = RigidState::at_rest(Vector3::z(), craft.hover_thrust_n());
        for step in 0..1000 {
            let commands_n = firmware.step(&state, Some(&setpoint));
            state = plant.hold(&state, &commands_n, f64::from(step) * 1e-3, 1e-3);
        }
        state.body_rates_rad_s.x
    };
    let own = roll_rate_after(&mut firmware);
    assert!((own - 3.49).abs() < 0.1, "{own}");
    let limits = Limits::new(1.8, 16.5, Vector3::new(1.5, 1.5, 1.5)).unwrap();
    assert_eq!(send(&table_within(KNOWN[0].vehicle, limits)), Status::Taken as u8);
    ffi::quatrack.parameters.table.store(5, Relaxed);
    ffi::quatrackService();
    let limited = roll_rate_after(&mut firmware);
    assert!((limited - 1.5).abs() < 0.1, "{limited}");
    // Back to a table that says nothing of itself.
    ffi::quatrack.parameters.table.store(0, Relaxed);
    ffi::quatrackService();
    let own = roll_rate_after(&mut firmware);
    assert!((own - 3.49).abs() < 0.1, "{own}");
}

#[test]
fn scales_stay_within_the_certificates_margin() {
    let craft = vehicles::by_name("crazyflie-2.1").unwrap();
    let _firmware = Firmware::start(&craft, &Tune::new(1, 0.02), QUIET);
    let gains = || [0, 4, 10, 16].map(|index: usize| ffi::quatrack.gains.entries[index].get());
    let (plain, most) = (gains(), ffi::quatrack.gains.scale_max.get());
    assert!(plain.iter().all(|gain| *gain != 0.0) && most > 1.0, "{plain:?} {most}");
    for (position, yaw, factors) in [(1.2, 0.8, [1.2, 1.2, 1.2, 0.8]), (99.0, 0.0, [most, most, most, 1.0 / most])] {
        ffi::quatrack.parameters.position_scale.set(position);
        ffi::quatrack.parameters.yaw_scale.set(yaw);
        ffi::quatrackService();
        for ((found, plain), factor) in gains().iter().zip(plain).zip(factors) {
            // Two products and a sum in f32.
            assert!((found / (plain * factor) - 1.0).abs() < 4e-7, "{found}, not {}", plain * factor);
        }
    }
}

#[test]
fn stiffness_changes_the_position_and_nothing_else() {
    let craft = vehicles::by_name("crazyflie-2.1").unwrap();
    let _firmware = Firmware::start(&craft, &Tune::new(0, 0.0), QUIET);
    let gains = || [0, 1, 2, 10, 11, 12, 16].map(|index: usize| ffi::quatrack.gains.entries[index].get());
    let plain = gains();
    assert_eq!([&ffi::quatrack.gains.scale_min, &ffi::quatrack.gains.scale_max].map(AtomicF32::get), [0.5, 1.3]);
    for (asked, flown) in [(1.2, 1.2), (99.0, 1.3), (0.0, 0.5)] {
        ffi::quatrack.parameters.position_scale.set(asked);
        ffi::quatrack.parameters.yaw_scale.set(0.5);
        ffi::quatrackService();
        let square: f32 = flown * flown;
        let factors = [square, flown, 1.0, square, flown, 1.0, 1.0];
        for ((found, plain), factor) in gains().iter().zip(plain).zip(factors) {
            // Two products in f32.
            assert!((found / (plain * factor) - 1.0).abs() < 4e-7, "{found}, not {}", plain * factor);
        }
    }
}

#[test]
fn a_parameter_that_is_no_number_gets_its_default_back_and_says_so() {
    let craft = vehicles::by_name("crazyflie-2.1-brushless").unwrap();
    let _firmware = Firmware::start(&craft, &Tune::new(0, 0.0), QUIET);
    let (parameters, log) = (&ffi::quatrack.parameters, &ffi::quatrack.log);
    // Known once the craft is.
    let air = [&parameters.drag_per_s, &parameters.moment_x_n_s, &parameters.moment_y_n_s].map(AtomicF32::get);
    assert_eq!(air, [0.353, 5.6e-4, 7.3e-4]);
    let before = log.put_back.load(Relaxed);
    for (number, parameter, default) in
        [(8, &parameters.motor_lag_s, 0.0), (9, &parameters.drag_per_s, 0.353), (15, &parameters.tilt_deg, 54.5)]
    {
        parameter.set(f32::NAN);
        ffi::quatrackService();
        assert_eq!((parameter.get(), log.parameter.load(Relaxed)), (default, number));
    }
    ffi::quatrackService();
    assert_eq!(log.put_back.load(Relaxed).wrapping_sub(before), 3, "once each");
}

#[test]
fn the_first_table_of_the_page_on_own_designs_flies_where_its_region_holds_the_lag() {
    let page = include_str!("../../../docs/own-gains.md");
    let toml = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let design = Design::from_toml("my-craft", toml, std::path::Path::new("")).unwrap();
    let table = design.certify().unwrap().to_bytes().unwrap();
    let craft = vehicles::by_name("crazyflie-2.1-brushless").unwrap();
    let _firmware = Firmware::start(&craft, &Tune::new(0, 0.0), QUIET);
    assert_eq!(send(&table), Status::Taken as u8);
    let (parameters, log) = (&ffi::quatrack.parameters, &ffi::quatrack.log);
    parameters.table.store(5, Relaxed);
    ffi::quatrackService();
    // With nothing stated the motors are taken to lag by 50 ms; its region is 25 to 60.
    let refused = log.refused_tables.load(Relaxed);
    assert_eq!(log.table.load(Relaxed), 5);
    for (lag_s, refusals) in [(0.04, 0), (0.1, 1)] {
        parameters.motor_lag_s.set(lag_s);
        ffi::quatrackService();
        assert_eq!(log.refused_tables.load(Relaxed).wrapping_sub(refused), refusals, "{lag_s} s");
    }
    assert_eq!((log.table.load(Relaxed), log.refusal.load(Relaxed)), (5, Refusal::MotorLag as u16));
}
