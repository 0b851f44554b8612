//! The monitor on spoilt samples: each fault, how long it is bridged, and how far the bridge is from the truth.

use super::*;
use crate::flatness::GRAVITY_M_S2;

const CONFIG: MonitorConfig = MonitorConfig::STANDARD;
const NAN: Vector3<f32> = Vector3::new(f32::NAN, f32::NAN, f32::NAN);

/// A craft that flies along x with 1 m/s, turns about z with 1 rad/s, and whose sensors are never quite the same.
fn state(tick: Tick) -> State {
    let t = tick as f32 * 1e-3;
    let (s, c) = crate::math::sin_cos(0.5 * t);
    State {
        position_m: Vector3::new(t, 0.0, 1.0),
        attitude: Quaternion::new(c, 0.0, 0.0, s),
        velocity_m_s: Vector3::new(1.0, 0.0, 0.0),
    }
}

fn rates(tick: Tick) -> Vector3<f32> {
    Vector3::new(if tick.is_multiple_of(2) { 2e-3 } else { -2e-3 }, 0.0, 1.0)
}

const FELT: Vector3<f32> = Vector3::new(0.0, 0.0, GRAVITY_M_S2);

struct Bench {
    monitor: Monitor,
    now: Tick,
}

impl Bench {
    /// In sound flight for a tenth of a second.
    fn flying() -> Self {
        let mut bench = Self { monitor: Monitor::new(), now: 0 };
        for _ in 0..100 {
            let (state, rates) = (state(bench.now), rates(bench.now));
            assert_eq!(bench.look(Some(state), Some(rates)).0, Soundness::Sound);
        }
        bench
    }

    fn look(&mut self, state: Option<State>, rates: Option<Vector3<f32>>) -> (Soundness, State, Vector3<f32>) {
        let (now, felt) = (self.now, Some(&FELT));
        let sample = Sample {
            now,
            state: state.as_ref(),
            body_rates_rad_s: rates.as_ref(),
            specific_force_m_s2: felt,
            thrust_m_s2: GRAVITY_M_S2,
        };
        let looked = self.monitor.look(&CONFIG, &sample);
        self.now += 1;
        (looked.soundness, *looked.state, *looked.body_rates_rad_s)
    }

    /// The same change of every state for so many ticks; the last look's soundness, and its distance from the truth.
    fn spoilt(&mut self, ticks: Tick, spoil: impl Fn(Tick, &mut State, &mut Vector3<f32>)) -> (Soundness, f32, f32) {
        let mut last = (Soundness::Sound, 0.0, 0.0);
        for _ in 0..ticks {
            let now = self.now;
            let (mut given, mut turning) = (state(now), rates(now));
            spoil(now, &mut given, &mut turning);
            let (soundness, found, turn) = self.look(Some(given), Some(turning));
            let truth = state(now);
            let off = (found.position_m - truth.position_m).norm() + (found.velocity_m_s - truth.velocity_m_s).norm();
            let turned = (truth.attitude.conjugate() * found.attitude).vector().norm() + (turn - rates(now)).norm();
            last = (soundness, off, turned);
        }
        last
    }
}

#[test]
fn a_sound_flight_is_given_as_it_is() {
    let mut bench = Bench::flying();
    let now = bench.now;
    assert_eq!(bench.look(Some(state(now)), Some(rates(now))), (Soundness::Sound, state(now), rates(now)));
}

#[test]
fn each_bound_is_its_own_however_the_others_are() {
    // Together beyond the bound of the first look, each next to its own bound: 30 m/s, 34.9 rad/s, 10 km.
    for (v, w, p, expected) in [
        (29.9, 34.8, 9_990.0, Soundness::Sound),
        (29.9, 0.0, 0.0, Soundness::Sound),
        (0.0, 34.8, 0.0, Soundness::Sound),
        (0.0, 0.0, 9_990.0, Soundness::Sound),
        (30.1, 0.0, 0.0, Soundness::Bridged),
        (0.0, 35.0, 0.0, Soundness::Bridged),
        (0.0, 0.0, 10_010.0, Soundness::Bridged),
    ] {
        let mut bench = Bench::flying();
        for _ in 0..10 {
            let (mut fast, mut turning) = (state(bench.now), rates(bench.now));
            (fast.velocity_m_s.y, fast.velocity_m_s.x, fast.position_m.z) = (v, 0.0, p);
            (turning.x, turning.z) = (w + turning.x, 0.0);
            let (soundness, found, turned) = bench.look(Some(fast), Some(turning));
            assert_eq!(soundness, expected, "{v} m/s, {w} rad/s, {p} m");
            assert!(expected != Soundness::Sound || (found, turned) == (fast, turning));
        }
    }
}

#[test]
fn a_position_or_velocity_that_is_none_is_bridged_for_half_a_second_and_then_lost() {
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3e38, 1.1e4, -1.1e4];
    for value in bad {
        for axis in 0..6 {
            let spoil = |_: Tick, state: &mut State, _: &mut Vector3<f32>| {
                let State { position_m: p, velocity_m_s: v, .. } = state;
                if axis < 3 { p[axis] = value } else { v[axis - 3] = value }
            };
            let mut bench = Bench::flying();
            let (soundness, off, turned) = bench.spoilt(500, spoil);
            assert_eq!(soundness, Soundness::Bridged);
            // Dead reckoning of an unaccelerated flight: roundings of 500 sums.
            assert!(off < 1e-3 && turned == 0.0, "{value} {axis}: {off} {turned}");
            assert_eq!(bench.spoilt(2, spoil).0, Soundness::AttitudeOnly);
            assert_eq!(bench.spoilt(10_000, spoil).0, Soundness::AttitudeOnly, "the attitude is still there");
            assert_eq!(bench.spoilt(1, |_, _, _| ()).0, Soundness::Sound, "and it comes back at once");
        }
    }
}

#[test]
fn an_attitude_that_is_none_is_carried_on_by_the_gyroscope_and_lost_after_five_seconds() {
    for q in [
        Quaternion::new(f32::NAN, 0.0, 0.0, 0.0),
        Quaternion::new(0.0, 0.0, 0.0, 0.0),
        Quaternion::new(0.0, 1.5, 0.0, 0.0),
    ] {
        let spoil = |_: Tick, state: &mut State, _: &mut Vector3<f32>| state.attitude = q;
        let mut bench = Bench::flying();
        let (soundness, off, turned) = bench.spoilt(500, spoil);
        assert_eq!((soundness, off), (Soundness::Bridged, 0.0));
        // Half a milliradian: roundings of 500 products, and the step to the first order.
        assert!(turned < 5e-4, "{turned}");
        assert_eq!(bench.spoilt(4500, spoil).0, Soundness::AttitudeOnly);
        assert_eq!(bench.spoilt(2, spoil).0, Soundness::AttitudeLost);
    }
}

#[test]
fn a_quaternion_of_norm_0_7_to_1_4_is_an_attitude() {
    for (norm, sound) in [(0.71, true), (0.98, true), (1.05, true), (1.39, true), (0.69, false), (1.41, false)] {
        let mut bench = Bench::flying();
        let (soundness, off, turned) = bench.spoilt(300, |_, state, _| state.attitude = state.attitude.scaled(norm));
        assert_eq!(soundness, if sound { Soundness::Sound } else { Soundness::Bridged }, "{norm}");
        assert!(off == 0.0 && turned < 5e-4, "{norm}: {turned}");
    }
}

#[test]
fn bad_samples_between_good_ones_are_bridged_for_ever() {
    for of in [2, 4] {
        let mut bench = Bench::flying();
        let (_, off, turned) = bench.spoilt(20_000, |now, state, rates| {
            if now % of == 0 {
                *state =
                    State { position_m: NAN, attitude: Quaternion::new(f32::NAN, 0.0, 0.0, 0.0), velocity_m_s: NAN };
                *rates = NAN;
            }
        });
        // Body rates of the step before, 4e-3 rad/s apart, and a tick of turn at 1 rad/s.
        assert!(off < 1e-5 && turned < 6e-3, "{of}: {off} {turned}");
    }
}

#[test]
fn an_estimate_that_stands_still_while_the_gyroscope_moves_is_lost_after_100_ms() {
    let mut bench = Bench::flying();
    let frozen = state(bench.now);
    let freeze = |_: Tick, state: &mut State, _: &mut Vector3<f32>| *state = frozen;
    assert_eq!(bench.spoilt(99, freeze).0, Soundness::Sound);
    let (soundness, off, turned) = bench.spoilt(3, freeze);
    assert_eq!(soundness, Soundness::Bridged);
    // It has been carried on since it stopped: dead reckoning of a tenth of a second.
    assert!(off < 1e-3 && turned < 1e-3, "{off} {turned}");
    assert_eq!(bench.spoilt(500, freeze).0, Soundness::AttitudeOnly);
    assert_eq!(bench.spoilt(1, |_, _, _| ()).0, Soundness::Sound);
}

#[test]
fn an_estimate_of_100_hz_and_a_craft_that_does_not_move_are_sound() {
    let mut bench = Bench::flying();
    let held = |now: Tick, given: &mut State, _: &mut Vector3<f32>| *given = state(now - now % 10);
    assert_eq!(bench.spoilt(1000, held).0, Soundness::Sound);
    let (frozen, turning) = (state(bench.now), rates(bench.now));
    let still = |_: Tick, state: &mut State, rates: &mut Vector3<f32>| (*state, *rates) = (frozen, turning);
    assert_eq!(bench.spoilt(1000, still).0, Soundness::Sound);
}

#[test]
fn a_gyroscope_beyond_its_range_is_replaced_by_the_turning_of_the_attitude_and_not_for_ever() {
    for bad in [NAN, Vector3::new(0.0, 34.9, 0.0), Vector3::new(0.0, 0.0, -1e9), Vector3::new(f32::INFINITY, 0.0, 0.0)]
    {
        let spoil = |_: Tick, _: &mut State, rates: &mut Vector3<f32>| *rates = bad;
        let mut bench = Bench::flying();
        let (soundness, _, turned) = bench.spoilt(600, spoil);
        assert_eq!(soundness, Soundness::Bridged);
        // Differences of rounded attitudes, 6e-8 each, over a millisecond and doubled; and the truth's own 4e-3.
        assert!(turned < 5e-3, "{turned}");
        assert_eq!(bench.spoilt(2, spoil).0, Soundness::BodyRatesLost);
    }
}

#[test]
fn a_gyroscope_that_stands_still_while_the_craft_turns_is_dead() {
    let mut bench = Bench::flying();
    let dead = |_: Tick, _: &mut State, rates: &mut Vector3<f32>| *rates = ZERO;
    assert_eq!(bench.spoilt(100, dead).0, Soundness::Sound);
    assert_eq!(bench.spoilt(2, dead).0, Soundness::Bridged);
    assert_eq!(bench.spoilt(601, dead).0, Soundness::BodyRatesLost);
}

#[test]
fn missing_estimates_are_bridged_like_bad_ones() {
    let mut bench = Bench::flying();
    for tick in 0..=501 {
        let (now, expected) = (bench.now, if tick > 500 { Soundness::AttitudeOnly } else { Soundness::Bridged });
        let (soundness, found, _) = bench.look(None, Some(rates(now)));
        assert_eq!(soundness, expected, "{tick}");
        assert!((found.position_m - state(now).position_m).norm() < 1e-3);
    }
}

#[test]
fn nothing_is_known_before_the_first_sound_state() {
    let mut bench = Bench { monitor: Monitor::new(), now: 7 };
    assert_eq!(bench.look(None, None).0, Soundness::AttitudeLost);
    let bad = State { velocity_m_s: NAN, ..state(0) };
    assert_eq!(bench.look(Some(bad), Some(rates(0))).0, Soundness::AttitudeLost);
    assert_eq!(bench.look(Some(state(0)), Some(rates(0))).0, Soundness::Sound);
    let mut alone = Bench { monitor: Monitor::new(), now: 7 };
    assert_eq!(alone.look(Some(state(0)), None), (Soundness::Sound, state(0), ZERO), "no gyroscope, no body rates");
}
