//! The law in force: the orders that change it, and the settings that a change leaves alone.

use quatrack::gains::paper;
use quatrack::gains::table::{Certificate, GainTable, Hash, Margins, Name, Rows, TableHead};
use quatrack::link::{LawChoice, StateIn, Table, TrajectoryId};
use quatrack::nalgebra::Vector3;
use quatrack::{Limits, Rate, State, Tick};
use quatrack_firmware::craft::BodyRates;
use quatrack_firmware::flight::{DECIMATION, Flight};
use quatrack_firmware::laws::{FADE_STEPS, Refused};
use quatrack_firmware::stored;
use quatrack_firmware::vehicle::VEHICLE;

/// LYAP-E as a table that the board takes; the figures only have to be possible ones.
fn table() -> GainTable<'static> {
    let head = TableHead {
        name: Name::literal("lyap-e"),
        vehicle: VEHICLE,
        rate: rate(),
        limits: Limits::new(1.75, 16.5, Vector3::new(20.0, 20.0, 5.0)).unwrap(),
        design_hash: Hash([1; 32]),
        certificate: Certificate {
            hash: Hash([2; 32]),
            one_channel: Margins { gain_factor: 3.0, phase_rad: 1.0 },
            all_channels: Margins { gain_factor: 2.0, phase_rad: 0.75 },
            delay_max_s: 0.0625,
            motor_lag_max_s: 0.03125,
            f32_distance: 2.5e-8,
        },
    };
    let rows = Rows::Equilibrium(*paper::LYAP_E.gain().rows());
    GainTable::new(head, &rows).unwrap()
}

fn rate() -> Rate {
    Rate::from_hz(500).unwrap()
}

fn load(flight: &mut Flight) -> Result<(), Refused> {
    flight.load(&table().accept_for(&VEHICLE, rate()).unwrap())
}

fn board() -> Flight {
    let mut flight = Flight::new(Box::leak(Box::default()), None);
    flight.playback.start(stored::player(TrajectoryId::Mild).unwrap());
    flight
}

/// The thrust of a step, 10 cm below the start of the trajectory: LQR-E asks for 10 m/s^2 more than hover, LYAP-E for 0.8.
fn thrust(flight: &mut Flight, now: Tick) -> f32 {
    flight.hear(now);
    flight.accept(StateIn { tick: now, state: State::at_rest(Vector3::new(0.0, 0.0, -0.1)) }, now);
    flight.step(now, false, BodyRates::NoGyroscope);
    flight.command().thrust_m_s2
}

#[test]
fn a_change_in_flight_takes_its_steps_under_any_requests_meanwhile() {
    let mut flight = board();
    load(&mut flight).unwrap();
    flight.hear(0);
    flight.accept(StateIn { tick: 0, state: State::at_rest(Vector3::new(0.0, 0.0, -0.1)) }, 0);
    flight.arm(0).unwrap();
    // LQR-E is cut to the most thrust, that of four motors of 0.12 N at 29 g; LYAP-E gives 9.81 + 8 * 0.1.
    let most = flight.limits().thrust_max_m_s2;
    assert!((most - 0.48 / 0.029).abs() < 2e-6, "{most}");
    assert_eq!(thrust(&mut flight, 1), most);
    flight.select(LawChoice::new(Table::Loaded(0))).unwrap();
    let mut before = most;
    for step in 1..=u32::from(FADE_STEPS) {
        let now = thrust(&mut flight, 1 + step);
        assert!(now < before && before - now < 0.2, "step {step}: from {before} to {now}");
        before = now;
        if step == 20 {
            flight.arm(1 + step).expect("it is armed");
            flight.select(LawChoice::new(Table::Loaded(0))).expect("it is chosen");
            assert_eq!(flight.select(LawChoice::new(Table::LqrE)), Err(Refused::Busy));
            assert_eq!(load(&mut flight), Err(Refused::Busy));
        }
    }
    // 8 1/s^2 times the reference's climb in these 50 ms, a few micrometres.
    assert!((before - 10.61).abs() < 1e-4, "{before}");
}

#[test]
fn a_table_that_is_flown_is_not_taken_away() {
    let mut flight = board();
    for _ in 0..2 {
        load(&mut flight).unwrap();
    }
    flight.select(LawChoice::new(Table::Loaded(1))).unwrap();
    flight.hear(0);
    flight.accept(StateIn { tick: 0, state: State::at_rest(Vector3::new(0.0, 0.0, -0.1)) }, 0);
    flight.arm(0).unwrap();
    assert_eq!(load(&mut flight), Err(Refused::Busy), "it would be the room for the next one");
    flight.select(LawChoice::new(Table::LqrE)).unwrap();
    flight.disarm();
    load(&mut flight).expect("on the ground it is gone from at once");
}

#[test]
fn tables_go_with_the_rate_that_they_are_certified_at() {
    let mut flight = board();
    load(&mut flight).unwrap();
    flight.select(LawChoice::new(Table::Loaded(0))).unwrap();
    flight.set_decimation(DECIMATION);
    assert_eq!(flight.law().table, Table::Loaded(0), "the same rate");
    // 333.3 Hz is no rate of a table; 100 Hz is another one.
    for (decimation, hz) in [(3, None), (10, Some(100))] {
        flight.set_decimation(decimation);
        assert_eq!(flight.table_rate().map(Rate::hz), hz);
        assert_eq!(flight.law().table, Table::LqrE);
        assert_eq!(flight.select(LawChoice::new(Table::Loaded(0))), Err(Refused::NoTable));
        assert!(matches!(load(&mut flight), Err(Refused::Accept(_))));
    }
}
