//! The guard by its orders: flights that go on, brake, level and switch off, tick by tick.

use nalgebra::Vector3;

use super::super::mode::Tumble;
use super::*;
use crate::quaternion::Quaternion;
use crate::state::State;

const CONFIGS: (&Config, &MonitorConfig) = (&Config::STANDARD, &MonitorConfig::STANDARD);
const NAN: Vector3<f32> = Vector3::new(f32::NAN, f32::NAN, f32::NAN);
const WELL: Circumstances = Circumstances::WELL;
const BAD: Circumstances = Circumstances { reference: ReferenceReport::Bad, ..WELL };

/// A craft whose sensors are never quite the same.
struct Bench {
    guard: Guard,
    now: Tick,
    state: State,
    felt: Vector3<f32>,
}

/// An order without its borrowed parts.
#[derive(Debug, PartialEq)]
enum Given {
    Off,
    Fly,
    Brake { to: Vector3<f32>, velocity: Vector3<f32> },
    Level(Vector3<f32>),
}

impl Bench {
    /// Hovering at 1 m.
    fn flying() -> Self {
        let state = State::at_rest(Vector3::new(0.0, 0.0, 1.0));
        let mut bench = Self { guard: Guard::flying(0), now: 0, state, felt: Vector3::new(0.0, 0.0, GRAVITY_M_S2) };
        assert_eq!(bench.pass(10, &WELL), Given::Fly);
        bench
    }

    fn step(&mut self, around: &Circumstances) -> Given {
        self.now += 2;
        let noise = if self.now.is_multiple_of(4) { 1e-4 } else { -1e-4 };
        let mut state = self.state;
        state.velocity_m_s.x += noise;
        let rates = Vector3::new(20.0 * noise, 0.0, 0.0);
        let sample = Sample {
            now: self.now,
            state: Some(&state),
            body_rates_rad_s: Some(&rates),
            specific_force_m_s2: Some(&self.felt),
            thrust_m_s2: GRAVITY_M_S2,
        };
        match self.guard.order(CONFIGS, &sample, around) {
            Order::Off => Given::Off,
            Order::Fly(_) => Given::Fly,
            Order::Brake(_, sample, _) => {
                Given::Brake { to: sample.flat.position_m, velocity: sample.flat.velocity_m_s }
            }
            Order::Level(levelled) => Given::Level(levelled.acceleration_m_s2),
        }
    }

    /// So many ticks of the same; the order at the last.
    fn pass(&mut self, ticks: Tick, around: &Circumstances) -> Given {
        (0..ticks / 2).map(|_| self.step(around)).last().unwrap()
    }
}

#[test]
fn it_brakes_from_where_it_is_each_time() {
    let mut bench = Bench::flying();
    for x in [0.0, 5.0, -3.0] {
        bench.state.position_m.x = x;
        bench.pass(300, &WELL);
        let Given::Brake { to, .. } = bench.pass(200, &BAD) else { panic!("it does not brake") };
        assert!((to.x - x).abs() < 1e-3, "{to}");
        // Long enough to go down, and well again in the middle of that.
        let Given::Brake { velocity, .. } = bench.pass(1900, &BAD) else { panic!("it does not go down") };
        assert_eq!((bench.guard.mode(), velocity.z), (Mode::LevelAndDown(Reason::BadReference), -0.3));
        assert_eq!(bench.pass(110, &WELL), Given::Fly);
    }
}

#[test]
fn a_ground_that_was_met_is_none_in_the_next_descent() {
    let mut bench = Bench::flying();
    let place = bench.state.position_m;
    bench.state.position_m = NAN;
    let Given::Level(_) = bench.pass(600, &WELL) else { panic!("it does not level") };
    // The ground is felt in a step after which the place is there again.
    bench.felt.z = 30.0;
    bench.pass(2, &WELL);
    bench.felt.z = GRAVITY_M_S2;
    assert_eq!(bench.guard.mode(), Mode::LevelAndDown(Reason::StateLost));
    bench.state.position_m = place;
    bench.guard.arm(bench.now);
    assert_eq!(bench.step(&WELL), Given::Off, "it has landed");
    bench.guard.arm(bench.now);
    assert_eq!(bench.step(&WELL), Given::Fly);
    bench.state.position_m = NAN;
    let Given::Level(_) = bench.pass(700, &WELL) else { panic!("it does not level again") };
    assert_eq!(bench.guard.mode(), Mode::LevelAndDown(Reason::StateLost));
}

#[test]
fn by_hand_it_comes_down_level_at_any_velocity_over_ground() {
    for asked in [Asked::Tilts, Asked::Rates] {
        let mut bench = Bench::flying();
        bench.state.velocity_m_s = Vector3::new(3.0, -2.0, 0.0);
        assert_eq!(bench.pass(100, &Circumstances { asked, ..WELL }), Given::Fly);
        // Downwards the velocity is held to 0.3 m/s: 2 1/s times the velocity that is missing.
        let level = Given::Level(Vector3::new(0.0, 0.0, -0.6));
        assert_eq!(bench.pass(100, &Circumstances { asked, ..BAD }), level);
        assert_eq!(bench.guard.mode(), Mode::Holding(Reason::BadReference));
        let failed = bench.guard.step_failed(bench.now, 1e-3, &Circumstances { asked, ..BAD }).unwrap();
        assert_eq!(Given::Level(failed.acceleration_m_s2), level);
    }
}

#[test]
fn a_pilot_may_turn_over_and_a_craft_that_comes_down_may_not() {
    let mut bench = Bench::flying();
    bench.state.attitude = Quaternion::new(0.0, 1.0, 0.0, 0.0);
    let asked = Asked::Rates;
    assert_eq!(bench.pass(3000, &Circumstances { asked, ..WELL }), Given::Fly);
    bench.pass(700, &Circumstances { asked, ..BAD });
    assert_eq!(bench.guard.mode(), Mode::Tumbled(Tumble::UpsideDown));
}

#[test]
fn a_controller_selected_in_the_air_flies_on_the_first_state_if_that_is_sound() {
    let mut bench = Bench::flying();
    for (tilt, expected) in [(0.2, Given::Fly), (3.0, Given::Fly), (f32::NAN, Given::Off)] {
        bench.guard = Guard::flying(bench.now);
        let (sin, cos) = crate::math::sin_cos(0.5 * tilt);
        bench.state.attitude = Quaternion::new(cos, sin, 0.0, 0.0);
        assert_eq!(bench.step(&WELL), expected, "{tilt}");
    }
    assert_eq!(bench.guard.mode(), Mode::Stopped(Reason::AttitudeLost));
}

#[test]
fn a_step_that_fails_is_levelled_on_the_state_that_it_was_given() {
    let mut bench = Bench::flying();
    bench.state.velocity_m_s = Vector3::new(1.0, 0.0, -0.3);
    bench.pass(10, &WELL);
    let levelled = bench.guard.step_failed(bench.now, 1e-3, &WELL).unwrap();
    // 1.5 1/s times 1 m/s, and the noise.
    assert!((levelled.acceleration_m_s2 - Vector3::new(-1.5, 0.0, 0.0)).norm() < 1e-3, "{levelled:?}");
    assert_eq!(levelled.attitude, Quaternion::IDENTITY);
    let (looked, sample, _) =
        Bench::flying().guard.reference_failed(12, 1e-3, &WELL).map(|(l, s, h)| (*l.state, *s, h)).unwrap();
    assert_eq!(looked.position_m, sample.flat.position_m);
}
