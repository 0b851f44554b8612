//! Setpoints that come slowly: what the Crazyflie's controller makes of the motion between them.

use quatrack::nalgebra::Vector3;
use quatrack::{FifthOrderSample, Heading};
use quatrack_crazyflie::demand::Motion;
use quatrack_crazyflie::stream::{Arrival, EXTRAPOLATION_MAX_MS, GAP_MAX_MS, Stream};
use quatrack_crazyflie::turning::Turning;

/// A curve of degree 6, whose crackle still changes; the order is that of the derivative.
fn curve(order: usize, t_s: f64) -> Vector3<f64> {
    let coefficients = [[0.1, -0.2, 0.5], [1.0, 0.8, 0.1], [-0.7, 2.0, 0.3], [3.0, -2.5, 0.4], [5.0, 4.0, -0.6]];
    let mut sum = Vector3::zeros();
    for (power, c) in coefficients.into_iter().chain([[6.0, -7.0, 1.0], [9.0, 8.0, -2.0]]).enumerate().skip(order) {
        let factor: f64 = (power + 1 - order..=power).map(|k| k as f64).product();
        sum += Vector3::from(c) * factor * t_s.powi((power - order) as i32);
    }
    sum
}

fn motion(t_s: f64) -> Motion {
    let [position_m, velocity_m_s, acceleration_m_s2, jerk_m_s3] =
        [0, 1, 2, 3].map(|order| curve(order, t_s).map(|c| c as f32));
    Motion { position_m, velocity_m_s, acceleration_m_s2, jerk_m_s3 }
}

/// Setpoints every `gap_ms` up to the last, that came at `end_ms`; the clock of the stream starts at `origin_ms`.
fn fed(gap_ms: u32, end_ms: u32, origin_ms: u32) -> Stream {
    let mut stream = Stream::new();
    for ms in (0..=end_ms).step_by(gap_ms as usize) {
        let wanted = if ms == 0 { Arrival::Begun } else { Arrival::Continued };
        assert_eq!(stream.accept(&motion(f64::from(ms) * 1e-3), origin_ms.wrapping_add(ms)), wanted, "{ms} ms");
    }
    stream
}

fn at(stream: &Stream, now_ms: u32, to_fifth: bool) -> FifthOrderSample {
    let mut sample = FifthOrderSample::at_rest(Vector3::zeros(), 0.0);
    stream.at(now_ms, to_fifth, &mut sample);
    sample
}

fn assert_near(found: &Vector3<f32>, order: usize, t_s: f64, bound: f64) {
    let difference = (found.map(f64::from) - curve(order, t_s)).amax();
    assert!(difference <= bound, "derivative {order} at {t_s} s: off by {difference}");
}

#[test]
fn four_jerks_give_a_curve_of_degree_six_to_its_fifth_derivative() {
    // Through the wrap of the clock, too.
    for origin_ms in [0, u32::MAX - 25] {
        for gap_ms in [10, 20] {
            let end_ms = 5 * gap_ms;
            let stream = fed(gap_ms, end_ms, origin_ms);
            let age_ms = 6;
            let sample = at(&stream, origin_ms.wrapping_add(end_ms + age_ms), true);
            let t_s = f64::from(end_ms + age_ms) * 1e-3;
            // The jerk is a cubic, which three differences have exactly; jerks of 40 m/s^3 are rounded by 2e-6, and four
            // times that over the gap and its square. The crackle grows by 6480 m/s^6 and is held as it is at an age of half
            // the gap and 1 ms; the snap follows it.
            let gap_s = f64::from(gap_ms) * 1e-3;
            let (age_s, held_s) = (f64::from(age_ms) * 1e-3, 0.5 * gap_s + 0.001);
            let off = 6480.0 * (held_s - age_s);
            assert_near(&sample.snap_m_s4, 4, t_s, 6480.0 * age_s * (held_s - 0.5 * age_s) + 0.12 + 2e-5 / gap_s);
            assert_near(&sample.crackle_m_s5, 5, t_s, 1.1 * off + 2e-5 / gap_s.powi(2));
            assert_near(&sample.flat.jerk_m_s3, 3, t_s, 2e-3);
            assert_near(&sample.flat.acceleration_m_s2, 2, t_s, 1e-5);
            assert_near(&sample.flat.velocity_m_s, 1, t_s, 1e-6);
            assert_near(&sample.flat.position_m, 0, t_s, 1e-6);
        }
    }
}

#[test]
fn between_setpoints_the_newest_is_carried_on_by_its_own_derivatives() {
    let mut stream = Stream::new();
    assert_eq!(stream.accept_to_jerk(&motion(0.0), 7), Arrival::Begun);
    let sample = at(&stream, 7 + 10, false);
    // What is left out: the snap of 120 m/s^4 over 10 ms, t^4/24, t^3/6 and t^2/2 of it.
    assert_near(&sample.flat.position_m, 0, 0.01, 120.0 * 1e-8 / 24.0 + 1e-7);
    assert_near(&sample.flat.velocity_m_s, 1, 0.01, 130.0 * 1e-6 / 6.0 + 1e-7);
    assert_near(&sample.flat.acceleration_m_s2, 2, 0.01, 130.0 * 1e-4 / 2.0 + 1e-6);
    assert_eq!(sample.flat.jerk_m_s3, motion(0.0).jerk_m_s3);
}

#[test]
fn a_motion_without_successors_comes_to_stand() {
    let stream = fed(10, 50, 0);
    let late = at(&stream, 50 + EXTRAPOLATION_MAX_MS + 1, true);
    assert_near(&late.flat.position_m, 0, 0.05 + f64::from(EXTRAPOLATION_MAX_MS) * 1e-3, 1e-3);
    assert_eq!(late, FifthOrderSample::at_rest(late.flat.position_m, 0.0));
}

#[test]
fn nothing_is_differenced_over_a_jump_or_a_gap_or_without_jerks() {
    let shifted = |t_s: f64, by: f32| {
        let motion = motion(t_s);
        Motion { position_m: motion.position_m + Vector3::new(by, 0.0, 0.0), ..motion }
    };
    let is_bare = |stream: &Stream, now_ms: u32| {
        let sample = at(stream, now_ms, true);
        sample.snap_m_s4 == Vector3::zeros() && sample.crackle_m_s5 == Vector3::zeros()
    };
    // A jump of 3 cm; 1 cm is within what a gap of full-state packets may leave.
    let mut stream = fed(10, 50, 0);
    assert!(!is_bare(&stream, 50));
    assert_eq!(stream.accept(&shifted(0.06, 0.03), 60), Arrival::Jumped);
    assert!(is_bare(&stream, 60));
    let mut stream = fed(10, 50, 0);
    assert_eq!(stream.accept(&shifted(0.06, 0.01), 60), Arrival::Continued);
    assert!(!is_bare(&stream, 60));
    // A gap.
    let mut stream = fed(10, 50, 0);
    assert_eq!(stream.accept(&motion(0.05 + f64::from(GAP_MAX_MS + 1) * 1e-3), 50 + GAP_MAX_MS + 1), Arrival::Begun);
    assert!(is_bare(&stream, 50 + GAP_MAX_MS + 1));
    // No jerk, as in packets of full states.
    let mut stream = fed(10, 50, 0);
    let bare = Motion { jerk_m_s3: Vector3::zeros(), ..motion(0.06) };
    assert_eq!(stream.accept(&bare, 60), Arrival::Continued);
    assert!(is_bare(&stream, 60));
    // While a law flew that does not look beyond the jerk.
    let mut stream = fed(10, 50, 0);
    assert_eq!(stream.accept_to_jerk(&motion(0.06), 60), Arrival::Continued);
    assert!(is_bare(&stream, 60));
    assert_eq!(stream.accept_to_jerk(&shifted(0.07, 0.03), 70), Arrival::Jumped);
}

#[test]
fn the_setpoint_that_is_flown_already_changes_nothing() {
    let mut stream = fed(10, 50, 0);
    let before = at(&stream, 58, true);
    assert_eq!(stream.accept(&motion(0.05), 57), Arrival::Continued);
    assert_eq!(stream.accept_to_jerk(&motion(0.05), 58), Arrival::Continued);
    assert_eq!(at(&stream, 58, true), before);
}

/// A heading whose jerk is 12 rad/s^3 throughout, with its derivatives.
fn turn(t_s: f64) -> [f64; 4] {
    [0.3 + 0.5 * t_s - 2.0 * t_s * t_s + 2.0 * t_s.powi(3), 0.5 - 4.0 * t_s + 6.0 * t_s * t_s, -4.0 + 12.0 * t_s, 12.0]
}

/// Headings every `gap_ms` up to the last, that came at `end_ms`.
fn turned(gap_ms: u32, end_ms: u32, is_differenced: bool) -> Turning {
    let mut turning = Turning::new();
    for ms in (0..=end_ms).step_by(gap_ms as usize) {
        let [heading, rate, ..] = turn(f64::from(ms) * 1e-3).map(|c| c as f32);
        if ms == 0 {
            turning.begin(Heading::from_angle(heading), rate, 0);
        } else {
            *turning.heading_mut() = Heading::from_angle(heading);
            turning.go_on(rate, ms, is_differenced);
        }
    }
    turning
}

fn heading_at(turning: &Turning, ms: u32) -> [f64; 4] {
    let mut sample = FifthOrderSample::at_rest(Vector3::zeros(), 0.0);
    let heading = turning.at(ms, &mut sample);
    let half = f64::from(heading.sin_half()).atan2(f64::from(heading.cos_half()));
    let (rate, second, third) =
        (sample.flat.heading_rate_rad_s, sample.heading_acceleration_rad_s2, sample.heading_jerk_rad_s3);
    [2.0 * half, f64::from(rate), f64::from(second), f64::from(third)]
}

#[test]
fn three_rates_give_a_turn_to_its_third_derivative() {
    let turning = turned(10, 40, true);
    let (found, wanted) = (heading_at(&turning, 46), turn(0.046));
    // The heading lacks t^3/6 of the jerk; rates of 0.5 rad/s are rounded by 3e-8, over the gap and its square.
    for (order, tolerance) in [(0, 12.0 * 0.006_f64.powi(3) / 6.0 + 5e-7), (1, 2e-7), (2, 2e-5), (3, 3e-3)] {
        assert!((found[order] - wanted[order]).abs() <= tolerance, "{order}: {found:?}, not {wanted:?}");
    }
}

#[test]
fn a_turn_that_jumps_pauses_or_is_not_to_be_differenced_has_a_rate_alone() {
    let bare = |turning: &Turning, ms: u32| heading_at(turning, ms)[2..] == [0.0, 0.0];
    assert!(bare(&turned(10, 40, false), 44));
    assert!(bare(&turned(GAP_MAX_MS + 1, 4 * (GAP_MAX_MS + 1), true), 4 * (GAP_MAX_MS + 1)));
    let mut jumped = turned(10, 40, true);
    jumped.go_on(1.5, 50, true);
    assert!(bare(&jumped, 54));
    // Without successors it stands after a tenth of a second.
    let [heading, rate, _, _] = turn(0.04);
    let late = heading_at(&turned(10, 40, true), 40 + EXTRAPOLATION_MAX_MS + 1);
    assert!((late[0] - heading - 0.1 * rate).abs() < 1e-6 && late[1..] == [0.0; 3], "{late:?}");
}
