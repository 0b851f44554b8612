//! The flight down to its motors, without a board: the forces are the core's to the bit, and every flight that ends, ends
//! with none.

use embedded_hal::i2c::ErrorKind;
use embedded_hal_mock::eh1::delay::NoopDelay;
use embedded_hal_mock::eh1::i2c::{Mock as Bus, Transaction as OnBus};
use embedded_hal_mock::eh1::pwm::{Mock as Channel, Transaction as OnChannel};
use quatrack::cascade::CascadeLimits;
use quatrack::gains::cascade::CRAZYFLIE_2_1_DEFAULT;
use quatrack::gains::paper;
use quatrack::link::{ForcesOut, FromBoard, LawChoice, NoCommand, RigidStateIn, StateIn, Table, TrajectoryId};
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::{ArmError, Fault, Mode, Reason};
use quatrack::{
    Actuation, Cascade, Controller, Equilibrium, FlatSample, Handover, Heading, Leash, Limits, Measured, Memory,
    MotorForces, Output, Player, Quaternion, RigidState, State, StepError, Target, Tick,
};
use quatrack_firmware::craft::{BoardCraft, BodyRates, Craft};
use quatrack_firmware::drivers::battery::CellVoltage;
use quatrack_firmware::drivers::bmi088::{Address, Bandwidth, Gyro, Range};
use quatrack_firmware::drivers::motors::Motors;
use quatrack_firmware::drivers::thrust_curve::ThrustCurve;
use quatrack_firmware::flight::{CONFIG, Flight, LOCK_STEP};
use quatrack_firmware::laws::{FADE_STEPS, Refused};
use quatrack_firmware::stored;
use quatrack_firmware::vehicle::{ACTUATION, AIRFRAME, STEP_RATE};

const LAWS: [Table; 2] = [Table::LqrE, Table::Cascade];
const NONE: MotorForces = [0.0; 4];

/// Somewhere below the start and turning: every law asks for thrust, and for something else at every step.
fn state(step: u16) -> RigidState {
    let k = f32::from(step);
    let position_m = Vector3::new(0.01 * k, -0.005, -0.1);
    RigidState { state: State::at_rest(position_m), body_rates_rad_s: Vector3::new(0.2, -0.01 * k, 0.1) }
}

fn board(table: Table) -> Flight {
    let mut flight = Flight::new(Box::leak(Box::default()), None);
    flight.select(LawChoice::new(table)).expect("it is in flash");
    assert_eq!(flight.law().table, table);
    flight.playback.start(stored::player(TrajectoryId::Mild).expect("it is in flash"));
    flight
}

/// A flight in the air at a tick, on rates that came with the state.
fn flying(table: Table, now: Tick) -> Flight {
    let mut flight = board(table);
    flight.hear(now);
    // A law of commands is not armed for motors that lag, and so before any body rates come.
    flight.accept(StateIn { tick: 7, state: state(0).state }, now);
    flight.arm(now).expect("it is where the trajectory begins");
    flight.accept_rigid(RigidStateIn { tick: 7, state: state(0) }, now);
    flight.step(now, false, BodyRates::NoGyroscope);
    assert_eq!(flight.mode(), Mode::Flying);
    assert!(flight.forces_n().iter().sum::<f32>() > 4.0 * AIRFRAME.hover_force_n(), "it climbs");
    flight
}

fn answered(flight: &mut Flight) -> ForcesOut {
    match flight.take_message() {
        Some(FromBoard::Forces(forces)) => forces,
        other => panic!("not answered by forces: {other:?}"),
    }
}

fn stopped(flight: &Flight) -> Reason {
    assert_eq!((*flight.forces_n(), *flight.driven_forces_n()), (NONE, NONE), "a flight that has ended holds no force");
    match flight.mode() {
        Mode::Stopped(reason) => reason,
        mode => panic!("still {mode}"),
    }
}

static ON_THE_CRAFT: Actuation = ACTUATION;

fn cascade() -> Cascade {
    let of = &CRAZYFLIE_2_1_DEFAULT.table;
    of.flown(&AIRFRAME, STEP_RATE, &CascadeLimits::STANDARD, &of.air).unwrap()
}

/// The same law in the core, down to the motors.
fn core(table: Table, limits: Limits, cascade: &Cascade) -> Controller<'_> {
    match table {
        Table::Cascade => Controller::new(cascade, limits),
        _ => Controller::new(Equilibrium::new(&paper::LQR_E), limits).with_actuation(&ON_THE_CRAFT),
    }
}

/// The forces of the core at a tick of the trajectory.
fn stepped(
    player: &mut Player<'_>,
    tick: Tick,
    measured: &RigidState,
    step: impl FnOnce(Measured<'_>, Target<'_>) -> Result<Output, StepError>,
) -> quatrack::MotorStep {
    let (mut reference, sample) = (player.reference(tick).unwrap(), player.at_fifth_order(tick));
    Leash::STANDARD.hold(&mut reference, &measured.state);
    let heading = Heading::from_angle(sample.flat.heading_rad);
    match step(measured.into(), Target::new(&reference).and_sample(&sample, heading)) {
        Ok(Output::Forces(step)) => step,
        other => panic!("tick {tick}: no forces but {other:?}"),
    }
}

#[test]
fn forces_are_the_cores_to_the_bit() {
    for table in LAWS {
        let (mut flight, cascade) = (flying(table, 100), cascade());
        let controller = core(table, flight.limits().check().unwrap(), &cascade);
        let mut memory = Memory::at_rest();
        let mut player = stored::player(TrajectoryId::Mild).unwrap();
        for step in 0..200 {
            let now = 100 + 2 * Tick::from(step);
            if step > 0 {
                flight.accept_rigid(RigidStateIn { tick: now, state: state(step) }, now);
                flight.hear(now);
                flight.step(now, false, BodyRates::NoGyroscope);
            }
            let expected = stepped(&mut player, now - 100, &state(step), |measured, target| {
                controller.step_to_motors(&mut memory, measured, target).map(Output::Forces)
            });
            let found = answered(&mut flight).result.unwrap();
            assert_eq!(found.forces_n.map(f32::to_bits), expected.forces_n.map(f32::to_bits), "{table:?}, step {step}");
            assert_eq!(found.limited, expected.limited);
            assert_eq!(flight.forces_n(), &expected.forces_n);
        }
    }
}

#[test]
fn the_cascade_takes_over_in_flight_and_its_forces_are_the_cores() {
    let mut flight = flying(Table::LqrE, 0);
    let first = *flight.forces_n();
    flight.select(LawChoice::new(Table::Cascade)).expect("it is in flash");
    let cascade = cascade();
    // As the core has it: from the forces that the lag gives after one step of the first law, from motors at rest.
    let mut memory = Memory::new(ACTUATION.lag().next(&NONE, &first)).unwrap();
    let limits = flight.limits().check().unwrap();
    let (old, new) = (core(Table::LqrE, limits, &cascade), core(Table::Cascade, limits, &cascade));
    let mut way = Handover::begin(FADE_STEPS, old.law(), new.law(), &mut memory);
    let mut player = stored::player(TrajectoryId::Mild).unwrap();
    for step in 1..=FADE_STEPS + 50 {
        let tick = 2 * Tick::from(step);
        let measured = state(step);
        flight.hear(tick);
        flight.accept_rigid(RigidStateIn { tick, state: measured }, tick);
        flight.step(tick, false, BodyRates::NoGyroscope);
        let expected = stepped(&mut player, tick, &measured, |measured, target| {
            way.step((&old, &new), &mut memory, measured, target)
        });
        assert_eq!(flight.forces_n(), &expected.forces_n, "step {step}");
    }
    assert!(way.is_over());
}

#[test]
fn before_it_is_armed_and_after_a_disarm_there_are_no_forces() {
    for table in LAWS {
        let mut flight = board(table);
        flight.accept_rigid(RigidStateIn { tick: 0, state: state(0) }, 0);
        flight.step(0, false, BodyRates::Measured(Vector3::zeros()));
        assert_eq!(flight.forces_n(), &NONE);
        assert!(!flight.takes_body_rates(), "nobody asks the gyroscope");
        let mut flight = flying(table, 0);
        flight.disarm();
        assert_eq!((flight.mode(), flight.forces_n()), (Mode::OnGround, &NONE));
    }
}

/// A craft in flight with a gyroscope of its own, whose readings are never quite still.
struct Gyroscopic {
    flight: Flight,
    now: Tick,
}

impl Gyroscopic {
    fn flying(table: Table) -> Self {
        Self { flight: flying(table, 0), now: 0 }
    }

    /// The next step, with a state or without.
    fn step(&mut self, state: Option<RigidState>) {
        self.now += 2;
        let wobble = if self.now.is_multiple_of(4) { 1e-3 } else { -1e-3 };
        if let Some(state) = state {
            self.flight.hear(self.now);
            self.flight.accept(StateIn { tick: self.now, state: state.state }, self.now);
        }
        self.flight.step(self.now, false, BodyRates::Measured(Vector3::new(wobble, 0.0, 0.0)));
    }
}

#[test]
fn after_the_link_is_lost_it_levels_and_lands_on_its_own_gyroscope() {
    for table in LAWS {
        let mut craft = Gyroscopic::flying(table);
        let mut modes = vec![];
        while craft.flight.mode().is_in_air() {
            craft.step(None);
            if modes.last() != Some(&craft.flight.mode()) {
                modes.push(craft.flight.mode());
            }
            let [a, b, c, d] = *craft.flight.forces_n();
            if craft.now > 2500 && craft.flight.mode().is_in_air() {
                let hover = 4.0 * AIRFRAME.hover_force_n();
                // A little less than the weight, however far the climb went before.
                let thrust = a + b + c + d;
                assert!(thrust > 0.9 * hover && thrust < hover, "{} of {hover} at {}", thrust, craft.now);
            }
        }
        let down = Mode::LevelAndDown(Reason::StateLost);
        let off = Mode::Stopped(Reason::AttitudeLost);
        assert!(
            modes.starts_with(&[Mode::Flying, Mode::Holding(Reason::LinkLost)]) || modes.contains(&down),
            "{modes:?}"
        );
        assert_eq!(modes.last(), Some(&off), "{modes:?}");
        assert!(craft.now > 15_000 && craft.now < 15_100, "as long as the gyroscope is believed: {}", craft.now);
    }
}

#[test]
fn a_reference_that_is_none_is_braked_for() {
    for table in LAWS {
        let mut craft = Gyroscopic::flying(table);
        craft.flight.playback.follow(FlatSample::at_rest(Vector3::new(0.0, 0.0, f32::NAN), 0.0));
        for step in 1..1000 {
            craft.step(Some(state(step)));
            assert_ne!(craft.flight.forces_n(), &NONE);
            let expected = if craft.now <= 1502 {
                Mode::Holding(Reason::BadReference)
            } else {
                Mode::LevelAndDown(Reason::BadReference)
            };
            assert_eq!(craft.flight.mode(), expected, "{}", craft.now);
        }
        craft.flight.playback.follow(FlatSample::at_rest(state(0).state.position_m, 0.0));
        for step in 1..100 {
            craft.step(Some(state(step)));
        }
        assert_eq!(craft.flight.mode(), Mode::Flying, "sound again for a tenth of a second");
    }
}

#[test]
fn every_end_of_a_flight_leaves_no_forces() {
    for table in LAWS {
        // On body rates that come with the state, none are left to level by.
        let mut old = flying(table, 0);
        let now = CONFIG.state_age_max_ticks + 1;
        old.hear(now);
        old.step(now, false, BodyRates::NoGyroscope);
        old.step(now + 2, false, BodyRates::NoGyroscope);
        assert_eq!(stopped(&old), Reason::BodyRatesLost);

        let mut late = flying(table, 0);
        for tick in 1..=CONFIG.overruns_tolerated + 1 {
            late.step(tick, true, BodyRates::NoGyroscope);
        }
        assert_eq!(stopped(&late), Reason::Overrun);

        let mut faulted = flying(table, 0);
        faulted.fail(Fault::StackExhausted, 2);
        assert_eq!(faulted.forces_n(), &NONE);
        faulted.step(4, false, BodyRates::NoGyroscope);
        let stopped = Mode::Stopped(Reason::Fault(Fault::StackExhausted));
        assert_eq!((faulted.forces_n(), faulted.mode()), (&NONE, stopped));
    }
}

#[test]
fn body_rates_that_are_none_are_bridged_by_the_attitude_and_then_end_the_flight() {
    for table in LAWS {
        for failed in [BodyRates::Failed, BodyRates::Measured(Vector3::new(0.0, f32::INFINITY, 0.0))] {
            let mut flight = flying(table, 0);
            let mut now = 0;
            while flight.mode().is_in_air() {
                now += 2;
                flight.hear(now);
                flight.accept(StateIn { tick: now, state: state(now as u16).state }, now);
                flight.step(now, false, failed);
            }
            assert_eq!(stopped(&flight), Reason::BodyRatesLost);
            assert!(now > 600 && now < 610, "{now}");
        }
    }
}

#[test]
fn the_default_is_the_cascade_where_there_are_body_rates() {
    for (has_rates, expected) in [(true, Table::Cascade), (false, Table::LqrE)] {
        let mut flight = Flight::new(Box::leak(Box::default()), None);
        flight.playback.start(stored::player(TrajectoryId::Mild).expect("it is in flash"));
        flight.hear(0);
        if has_rates {
            flight.accept_rigid(RigidStateIn { tick: 0, state: state(0) }, 0);
        } else {
            flight.accept(StateIn { tick: 0, state: state(0).state }, 0);
        }
        flight.arm(0).expect("it is fit to fly");
        assert_eq!(flight.law().table, expected);
        flight.step(0, false, BodyRates::NoGyroscope);
        assert_eq!(flight.mode(), Mode::Flying);
        assert_eq!(flight.forces_n() != &NONE, has_rates);
    }
}

#[test]
fn a_law_that_no_certificate_covers_is_not_armed_for_motors() {
    for (table, expected) in [
        (Table::LqrE, Err(ArmError::NotCertified)),
        (Table::LyapF, Err(ArmError::NotCertified)),
        (Table::Cascade, Ok(())),
    ] {
        let mut flight = board(table);
        flight.hear(0);
        flight.accept_rigid(RigidStateIn { tick: 0, state: state(0) }, 0);
        assert_eq!(flight.arm(0), expected, "{table:?}");
    }
    let mut flight = board(Table::Cascade);
    flight.hear(0);
    assert_eq!(flight.arm(0), Err(ArmError::NoState));
    let mut tilted = state(0);
    tilted.state.attitude = Quaternion::new(0.966, 0.0, 0.259, 0.0);
    flight.accept_rigid(RigidStateIn { tick: 0, state: tilted }, 0);
    assert!(matches!(flight.arm(0), Err(ArmError::Tilted { .. })), "30 degrees");
    flight.accept_rigid(RigidStateIn { tick: 0, state: state(0) }, 0);
    flight.motors.set_battery(CellVoltage::new(2.5).unwrap());
    assert_eq!(flight.arm(0), Err(ArmError::Battery { volts: 2.5 }));
}

#[test]
fn without_body_rates_a_law_that_needs_none_commands_and_drives_nothing() {
    let mut flight = flying(Table::LqrE, 0);
    flight.accept(StateIn { tick: 2, state: state(1).state }, 2);
    flight.step(2, false, BodyRates::NoGyroscope);
    assert_eq!((flight.mode(), flight.forces_n()), (Mode::Flying, &NONE));
    assert!(matches!(flight.take_message(), Some(FromBoard::Command(command)) if command.result.is_ok()));

    let mut flight = flying(Table::Cascade, 0);
    flight.accept(StateIn { tick: 2, state: state(1).state }, 2);
    flight.step(2, false, BodyRates::NoGyroscope);
    assert_eq!(stopped(&flight), Reason::StepFailed);
    let answer = flight.take_message();
    assert!(matches!(answer, Some(FromBoard::Command(command)) if command.result == Err(NoCommand::NoBodyRates)));
}

#[test]
fn the_gyroscope_counts_before_rates_that_came_with_the_state() {
    for table in LAWS {
        let (mut sent, mut measured) = (flying(table, 0), flying(table, 0));
        let rates = state(5).body_rates_rad_s;
        let with_rates = RigidState { body_rates_rad_s: rates, ..state(1) };
        sent.accept_rigid(RigidStateIn { tick: 2, state: with_rates }, 2);
        sent.step(2, false, BodyRates::NoGyroscope);
        measured.accept_rigid(RigidStateIn { tick: 2, state: state(1) }, 2);
        measured.step(2, false, BodyRates::Measured(rates));
        assert_eq!(measured.forces_n(), sent.forces_n(), "{table:?}");
        // And where none came.
        measured.accept(StateIn { tick: 4, state: state(2).state }, 4);
        measured.step(4, false, BodyRates::Measured(rates));
        assert!(matches!(measured.take_message(), Some(FromBoard::Forces(forces)) if forces.result.is_ok()));
    }
}

#[test]
fn in_lock_step_with_a_simulation_the_motors_stay_off() {
    let mut flight = board(Table::Cascade);
    flight.set_decimation(LOCK_STEP);
    flight.hear(0);
    flight.arm(0).expect("no motor turns");
    flight.accept_rigid(RigidStateIn { tick: 0, state: state(0) }, 0);
    flight.step(0, false, BodyRates::NoGyroscope);
    assert!(answered(&mut flight).result.is_ok());
    assert_ne!(flight.forces_n(), &NONE, "the simulation has its forces");
    assert_eq!(flight.driven_forces_n(), &NONE);
    assert!(!flight.takes_body_rates());
}

#[test]
fn the_cascade_in_the_image_is_flown_at_its_rate_alone() {
    let mut flight = board(Table::Cascade);
    flight.set_decimation(LOCK_STEP);
    assert_eq!(flight.law().table, Table::Cascade, "states are taken to come at its rate");
    flight.set_decimation(1);
    assert_eq!(flight.law().table, Table::LqrE, "dropped at 1 kHz, as loaded tables are");
    assert_eq!(flight.select(LawChoice::new(Table::Cascade)), Err(Refused::NoTable));
    flight.set_decimation(2);
    assert_eq!(flight.select(LawChoice::new(Table::Cascade)), Ok(()));
}

#[test]
fn a_boards_craft_is_its_gyroscope_and_its_motors() {
    let mut bus = Bus::new(&[
        OnBus::write_read(0x68, vec![0x00], vec![0x0F]),
        OnBus::write(0x68, vec![0x14, 0xB6]),
        OnBus::write(0x68, vec![0x0F, 0x04]),
        OnBus::write_read(0x68, vec![0x0F], vec![0x04]),
        OnBus::write(0x68, vec![0x10, 0x02]),
        OnBus::write_read(0x68, vec![0x10], vec![0x82]),
        OnBus::write(0x68, vec![0x16, 0x0D]),
        OnBus::write(0x68, vec![0x18, 0x01]),
        OnBus::write(0x68, vec![0x15, 0x80]),
        OnBus::write_read(0x68, vec![0x02], vec![0x00, 0x40, 0, 0, 0, 0]),
        OnBus::write_read(0x68, vec![0x02], vec![0; 6]).with_error(ErrorKind::Bus),
    ]);
    let gyro = Gyro::start(bus.clone(), Address::Low, Range::Degrees125, Bandwidth::Hz116, &mut NoopDelay::new());
    // Off at the start; hover, 166 of 256 at 3.7 V; off again.
    let channels = [(); 4].map(|()| {
        Channel::new(&[
            OnChannel::set_duty_cycle(0),
            OnChannel::max_duty_cycle(256),
            OnChannel::set_duty_cycle(166),
            OnChannel::max_duty_cycle(256),
            OnChannel::set_duty_cycle(0),
        ])
    });
    let motors = Motors::new(channels.clone(), ThrustCurve::CRAZYFLIE_2_1).unwrap();
    let mut craft = BoardCraft { gyro: gyro.ok(), motors };
    let BodyRates::Measured(rates) = craft.body_rates() else { panic!("the chip has answered") };
    assert!((rates.x - 62.5_f32.to_radians()).abs() < 1e-6 && rates.y == 0.0, "{rates}");
    assert_eq!(craft.body_rates(), BodyRates::Failed);
    craft.drive(&[AIRFRAME.hover_force_n(); 4], CellVoltage::NOMINAL);
    craft.drive(&NONE, CellVoltage::NOMINAL);
    bus.done();
    channels.into_iter().for_each(|mut channel| channel.done());
}
