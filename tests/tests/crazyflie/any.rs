//! Any input of a firmware, a radio or an estimator: the Crazyflie's controller's output is finite and
//! within the motors' range.

use std::sync::atomic::Ordering::Relaxed;

use proptest::prelude::*;
use quatrack::cascade::CascadeLimits;
use quatrack::gains::Scales;
use quatrack::{FeedForward, Leash, Limits};
use quatrack_crazyflie::abi::{Attitude, Control, Mode, Modes, Quaternion, SensorData, Setpoint, State, Vector};
use quatrack_crazyflie::control::{self, Controller, Settings, Why};
use quatrack_crazyflie::craft::Craft;
use quatrack_crazyflie::ffi;
use quatrack_crazyflie::output::Output;
use quatrack_crazyflie::shaping::Bounds;
use quatrack_crazyflie::tables::{Brought, Table, Tuning};
use quatrack_simulation::crazyflie::{Firmware, Sensors, Tune, platform};
use quatrack_simulation::vehicles;

/// Numbers that make sense most of the time.
fn number(size: f32) -> impl Strategy<Value = f32> {
    prop_oneof![
        12 => -size..size,
        6 => Just(0.0),
        1 => any::<f32>(),
        1 => prop_oneof![Just(f32::NAN), Just(f32::INFINITY), Just(f32::MAX), Just(-f32::MAX), Just(1e-42)],
    ]
}

fn vector(size: f32) -> impl Strategy<Value = Vector> {
    [number(size), number(size), number(size)].prop_map(|[x, y, z]| Vector { timestamp: 0, x, y, z })
}

fn angles(size: f32) -> impl Strategy<Value = Attitude> {
    [number(size), number(size), number(size)].prop_map(|[roll, pitch, yaw]| Attitude {
        timestamp: 0,
        roll,
        pitch,
        yaw,
    })
}

fn quaternion() -> impl Strategy<Value = Quaternion> {
    let turned = [-1.0_f32..1.0, -1.0..1.0, -1.0..1.0, 0.1..1.0].prop_map(|[x, y, z, w]| {
        let norm = (x * x + y * y + z * z + w * w).sqrt();
        Quaternion { x: x / norm, y: y / norm, z: z / norm, w: w / norm }
    });
    let any = [number(1.0), number(1.0), number(1.0), number(1.0)].prop_map(|[x, y, z, w]| Quaternion { x, y, z, w });
    prop_oneof![9 => turned, 1 => any]
}

/// The modes of the commanders, and any.
fn modes() -> impl Strategy<Value = Modes> {
    let of = |x, z, roll, yaw, quat| {
        let [x, z, roll, yaw, quat] = [x, z, roll, yaw, quat].map(Mode);
        Modes { x, y: x, z, roll, pitch: roll, yaw, quat }
    };
    prop_oneof![
        6 => Just(of(1, 1, 0, 1, 0)),
        4 => Just(of(1, 1, 0, 0, 1)),
        2 => Just(of(2, 1, 0, 2, 0)),
        1 => Just(of(0, 0, 1, 2, 0)),
        1 => Just(of(0, 0, 2, 2, 0)),
        1 => Just(Modes::default()),
        1 => (0..3_u8, 0..3_u8, 0..3_u8, 0..4_u8, 0..3_u8)
            .prop_map(move |(x, z, roll, yaw, quat)| of(x.into(), z.into(), roll.into(), yaw.into(), quat.into())),
    ]
}

/// A setpoint and how many milliseconds it holds.
fn setpoint() -> impl Strategy<Value = (Setpoint, u32)> {
    let motion = (vector(2.0), vector(3.0), vector(10.0), vector(60.0));
    let stamp = prop_oneof![8 => Just(true), 1 => Just(false)];
    (modes(), motion, angles(200.0), angles(200.0), quaternion(), number(65_535.0), stamp, 0..2_u8, 1..30_u32).prop_map(
        |(
            mode,
            (position, velocity, acceleration, jerk),
            attitude,
            rates,
            q,
            thrust,
            is_stamped,
            velocity_body,
            hold,
        )| {
            let setpoint = Setpoint {
                timestamp: u32::from(is_stamped),
                attitude,
                attitude_rate: rates,
                attitude_quaternion: q,
                thrust,
                position,
                velocity,
                acceleration,
                jerk,
                velocity_body,
                mode,
            };
            (setpoint, hold)
        },
    )
}

fn state() -> impl Strategy<Value = (State, SensorData)> {
    (vector(2.0), vector(3.0), quaternion(), [number(300.0), number(300.0), number(300.0)]).prop_map(
        |(position, velocity, attitude_quaternion, gyro)| {
            let state = State { attitude_quaternion, position, velocity, ..State::default() };
            (state, SensorData { gyro, ..SensorData::default() })
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn outputs_are_finite_and_within_the_motors_range(
        name in prop_oneof![Just("crazyflie-2.1"), Just("crazyflie-2.1-upgrade-kit"), Just("crazyflie-2.1-brushless")],
        flown in prop::collection::vec((setpoint(), state(), 0..7_u8, number(0.15)), 1..30),
        first_step in prop_oneof![Just(10_u32), Just(u32::MAX - 101)],
    ) {
        let vehicle = vehicles::by_name(name).unwrap();
        let tune = Tune::new(0, 0.0);
        let _alone = Firmware::start(&vehicle, &tune, Sensors { gyro_noise_rad_s: 0.0, estimate_steps: 1 });
        let mut control = Control::default();
        let mut step = first_step;
        let most_n = 4.0 * vehicle.motors().thrust_max_n as f32 * 1.000_1;
        for ((setpoint, hold), (state, sensors), table, lag_s) in flown {
            let parameters = &ffi::quatrack.parameters;
            parameters.table.store(table, Relaxed);
            parameters.motor_lag_s.set(lag_s);
            ffi::quatrackService();
            let setpoint = Setpoint { timestamp: setpoint.timestamp * step, ..setpoint };
            for _ in 0..hold {
                ffi::controllerOutOfTree(&mut control, &setpoint, &sensors, &state, step);
                step = step.wrapping_add(1);
                let [thrust, ..] = control.payload;
                prop_assert!(control.payload.iter().all(|value| value.is_finite()), "{control:?}");
                match control.control_mode {
                    Control::FORCE => prop_assert!(
                        control.payload.iter().all(|force| (0.0..=1.0).contains(force)), "{control:?}"
                    ),
                    Control::FORCE_TORQUE => prop_assert!((0.0..=most_n).contains(&thrust), "{control:?} {most_n}"),
                    _ => prop_assert!(false, "{control:?}"),
                }
            }
        }
    }

    #[test]
    fn motors_stand_still_while_the_craft_is_stopped_and_until_a_new_flight(
        flown in prop::collection::vec((setpoint(), state(), 1..20_u32), 1..60),
        table in prop_oneof![4 => Just(0_u8), 1 => Just(2_u8)],
    ) {
        let mut controller = controller(table);
        let (mut step, mut stopped) = (10, false);
        for ((setpoint, hold), (state, sensors), times) in flown {
            let setpoint = Setpoint { timestamp: setpoint.timestamp * step, ..setpoint };
            let mut sensors = sensors;
            for _ in 0..hold * times {
                // A gyroscope that works is never quite still.
                sensors.gyro[2] += if step % 4 < 2 { 0.1 } else { -0.1 };
                let is_new = controller.step(&setpoint, &sensors, &state, step);
                let mode = controller.mode();
                if is_new {
                    let output = &controller.outcome().output;
                    let is_off = *output == Output::OFF;
                    if matches!(mode, control::Mode::Off | control::Mode::Stopped) {
                        prop_assert!(is_off, "{mode:?}: {output:?}");
                    }
                    if let Output::Forces(forces) = output {
                        let most = controller.craft().airframe().figures().force_max_n;
                        prop_assert!(forces.iter().all(|force| (0.0..=most).contains(force)), "{forces:?}");
                    }
                    stopped &= mode != control::Mode::Off;
                    prop_assert!(!stopped || mode == control::Mode::Stopped, "{mode:?}");
                    stopped |= mode == control::Mode::Stopped && controller.why() != Why::Nothing;
                } else {
                    controller.between(&setpoint, &sensors, step);
                    stopped &= controller.mode() != control::Mode::Off;
                }
                step += 1;
            }
        }
    }
}

/// Of a Crazyflie 2.1 whose motors' lag is told to be 20 ms.
fn controller(table: u8) -> Controller {
    let craft = Craft::of(&platform(&vehicles::by_name("crazyflie-2.1").unwrap())).unwrap().with_motor_lag(0.02);
    let tuning = Tuning { scales: Scales::ONE, air: craft.air, limits: CascadeLimits::STANDARD };
    let bounds = Bounds { leash: Leash { length_m: 1.0 }, speed_m_s: 1.5, acceleration_m_s2: 4.0 };
    let limits = Limits::of(craft.airframe(), nalgebra::Vector3::new(20.0, 20.0, 10.0));
    let settings = Settings { bounds, limits, feed_forward: FeedForward::With };
    let mut controller =
        Controller::new(craft, Table::choose(table, &craft, &tuning, Brought::default()).unwrap(), settings);
    controller.change_craft(&craft);
    controller
}
