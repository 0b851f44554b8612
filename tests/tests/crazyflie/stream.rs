//! Setpoints that come slowly: the motion that the Crazyflie's controller makes between them.

use quatrack::nalgebra::Vector3;
use quatrack::{FifthOrderSample, Heading};
use quatrack_crazyflie::heading::HeadingStream;
use quatrack_crazyflie::motion::Motion;
use quatrack_crazyflie::stream::{Arrival, EXTRAPOLATION_MAX_MS, GAP_MAX_MS, Stream};

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
        assert_eq!(stream.accept(&motion(f64::from(ms) * 1e-3), origin_ms.wrapping_add(ms), true), wanted, "{ms} ms");
        stream.catch_up();
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
fn jerks_give_a_curve_to_its_fifth_derivative_at_any_period() {
    // Through the wrap of the clock, too.
    for origin_ms in [0, u32::MAX - 25] {
        for gap_ms in [5, 7, 10, 13] {
            let end_ms = 9 * gap_ms;
            let stream = fed(gap_ms, end_ms, origin_ms);
            let age_ms = 4;
            let sample = at(&stream, origin_ms.wrapping_add(end_ms + age_ms), true);
            let t_s = f64::from(end_ms + age_ms) * 1e-3;
            // The jerk is a cubic, its crackle grows by 6480 m/s^6: over the seven gaps of the parabola it is in the middle where
            // the fit has it, and the snap at the end is off by a tenth of that times the square of the way. Jerks of 40 m/s^3
            // are rounded by 2e-6, over the way and its square.
            let way_s = 7.0 * f64::from(gap_ms) * 1e-3;
            let age_s = f64::from(age_ms) * 1e-3;
            let crackle_off = 6480.0 * (0.55 * way_s + age_s) + 6e-5 / way_s.powi(2);
            let snap_off = 6480.0 * 0.13 * way_s.powi(2) + age_s * crackle_off + 6e-5 / way_s;
            assert_near(&sample.crackle_m_s5, 5, t_s, crackle_off);
            assert_near(&sample.snap_m_s4, 4, t_s, snap_off);
            assert_near(&sample.flat.jerk_m_s3, 3, t_s, age_s * snap_off + 1e-5);
            assert_near(&sample.flat.acceleration_m_s2, 2, t_s, age_s.powi(2) * snap_off + 1e-5);
            assert_near(&sample.flat.velocity_m_s, 1, t_s, 1e-5);
            assert_near(&sample.flat.position_m, 0, t_s, 1e-6);
        }
    }
}

#[test]
fn where_no_jerk_is_sent_it_is_the_slope_of_the_accelerations() {
    let mut stream = Stream::new();
    for ms in (0..=100).step_by(10) {
        let bare = Motion { jerk_m_s3: Vector3::zeros(), ..motion(f64::from(ms) * 1e-3) };
        stream.accept(&bare, ms, true);
        stream.catch_up();
    }
    let sample = at(&stream, 100, true);
    // The acceleration's fourth derivative is 6480 m/s^6, its third at most 1600 m/s^5 here: a parabola over 70 ms lacks
    // it.
    let off = 1600.0 * 0.07_f64.powi(2) / 5.0;
    assert_near(&sample.flat.jerk_m_s3, 3, 0.1, 0.5 * off);
    assert_near(&sample.snap_m_s4, 4, 0.1, 0.07 * 1600.0);
    assert_eq!(sample.crackle_m_s5, Vector3::zeros());
}

#[test]
fn between_setpoints_the_newest_is_carried_on_by_its_own_derivatives() {
    let mut stream = Stream::new();
    assert_eq!(stream.accept(&motion(0.0), 7, false), Arrival::Begun);
    let sample = at(&stream, 7 + 10, false);
    // The part left out: the snap of 120 m/s^4 over 10 ms, t^4/24, t^3/6 and t^2/2 of it.
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
fn nothing_is_fitted_over_a_jump_or_a_gap() {
    let shifted = |t_s: f64, by: f32| {
        let motion = motion(t_s);
        Motion { position_m: motion.position_m + Vector3::new(by, 0.0, 0.0), ..motion }
    };
    let is_bare = |stream: &Stream, now_ms: u32| {
        let sample = at(stream, now_ms, true);
        sample.snap_m_s4 == Vector3::zeros() && sample.crackle_m_s5 == Vector3::zeros()
    };
    // A jump of 3 cm; 1 cm is within the error that a gap of full-state packets may leave.
    let mut stream = fed(10, 50, 0);
    assert!(!is_bare(&stream, 50));
    assert_eq!(stream.accept(&shifted(0.06, 0.03), 60, true), Arrival::Jumped);
    stream.catch_up();
    assert!(is_bare(&stream, 60));
    let mut stream = fed(10, 50, 0);
    assert_eq!(stream.accept(&shifted(0.06, 0.01), 60, true), Arrival::Continued);
    assert!(!is_bare(&stream, 60));
    // A gap.
    let mut stream = fed(10, 50, 0);
    let late_ms = 50 + GAP_MAX_MS + 1;
    assert_eq!(stream.accept(&motion(f64::from(late_ms) * 1e-3), late_ms, true), Arrival::Begun);
    assert!(is_bare(&stream, late_ms));
    // While a law flew that does not look beyond the jerk.
    let mut stream = fed(10, 50, 0);
    assert_eq!(stream.accept(&motion(0.06), 60, false), Arrival::Continued);
    assert!(is_bare(&stream, 60));
    assert_eq!(stream.accept(&shifted(0.07, 0.03), 70, false), Arrival::Jumped);
}

#[test]
fn a_setpoint_of_the_same_time_is_moved_and_no_more() {
    let mut stream = fed(10, 50, 0);
    let before = at(&stream, 58, true);
    assert_eq!(stream.accept(&motion(0.05), 50, true), Arrival::Continued);
    assert_eq!(at(&stream, 58, true), before);
    let changed = Motion { velocity_m_s: Vector3::zeros(), ..motion(0.05) };
    stream.accept(&changed, 50, true);
    let after = at(&stream, 58, true);
    assert_eq!((after.snap_m_s4, after.flat.jerk_m_s3), (before.snap_m_s4, before.flat.jerk_m_s3));
    assert!((after.flat.velocity_m_s - before.flat.velocity_m_s + motion(0.05).velocity_m_s).norm() < 1e-6);
}

/// A heading whose jerk is 12 rad/s^3 throughout, with its derivatives.
fn turn(t_s: f64) -> [f64; 4] {
    [0.3 + 0.5 * t_s - 2.0 * t_s * t_s + 2.0 * t_s.powi(3), 0.5 - 4.0 * t_s + 6.0 * t_s * t_s, -4.0 + 12.0 * t_s, 12.0]
}

/// Headings every `gap_ms` up to the last, that came at `end_ms`.
fn turned(gap_ms: u32, end_ms: u32, is_differenced: bool) -> HeadingStream {
    let mut headings = HeadingStream::new();
    for ms in (0..=end_ms).step_by(gap_ms as usize) {
        let [heading, rate, ..] = turn(f64::from(ms) * 1e-3).map(|c| c as f32);
        if ms == 0 {
            headings.begin(Heading::from_angle(heading), rate, 0);
        } else {
            headings.accept(Heading::from_angle(heading), rate, ms, is_differenced);
        }
    }
    headings
}

fn heading_at(headings: &HeadingStream, ms: u32) -> [f64; 4] {
    let mut sample = FifthOrderSample::at_rest(Vector3::zeros(), 0.0);
    let heading = headings.at(ms, &mut sample);
    let half = f64::from(heading.sin_half()).atan2(f64::from(heading.cos_half()));
    let (rate, second, third) =
        (sample.flat.heading_rate_rad_s, sample.heading_acceleration_rad_s2, sample.heading_jerk_rad_s3);
    [2.0 * half, f64::from(rate), f64::from(second), f64::from(third)]
}

#[test]
fn three_rates_give_a_turn_to_its_third_derivative() {
    let headings = turned(10, 40, true);
    let (found, wanted) = (heading_at(&headings, 46), turn(0.046));
    // The heading lacks t^3/6 of the jerk; rates of 0.5 rad/s are rounded by 3e-8, over the gap and its square.
    for (order, tolerance) in [(0, 12.0 * 0.006_f64.powi(3) / 6.0 + 5e-7), (1, 2e-7), (2, 2e-5), (3, 3e-3)] {
        assert!((found[order] - wanted[order]).abs() <= tolerance, "{order}: {found:?}, not {wanted:?}");
    }
}

#[test]
fn a_turn_that_jumps_pauses_or_is_not_to_be_differenced_has_a_rate_alone() {
    let bare = |headings: &HeadingStream, ms: u32| heading_at(headings, ms)[2..] == [0.0, 0.0];
    assert!(bare(&turned(10, 40, false), 44));
    assert!(bare(&turned(GAP_MAX_MS + 1, 4 * (GAP_MAX_MS + 1), true), 4 * (GAP_MAX_MS + 1)));
    let mut jumped = turned(10, 40, true);
    jumped.accept(Heading::from_angle(0.3), 1.5, 50, true);
    assert!(bare(&jumped, 54));
    // Without successors it is at rest after a tenth of a second.
    let [heading, rate, _, _] = turn(0.04);
    let late = heading_at(&turned(10, 40, true), 40 + EXTRAPOLATION_MAX_MS + 1);
    assert!((late[0] - heading - 0.1 * rate).abs() < 1e-6 && late[1..] == [0.0; 3], "{late:?}");
}

#[test]
fn a_heading_that_moves_with_a_rate_of_zero_gets_its_own() {
    // 90 degrees a second in steps of 0.16 degrees, as full-state packets have them.
    let step_rad = 0.16_f64.to_radians();
    let sent = |ms: u32| {
        let angle = std::f64::consts::FRAC_PI_2 * f64::from(ms) * 1e-3;
        Heading::from_angle(((angle / step_rad).round() * step_rad) as f32)
    };
    let mut headings = HeadingStream::new();
    headings.begin(sent(0), 0.0, 0);
    (10..=1000).step_by(10).for_each(|ms| headings.accept(sent(ms), 0.0, ms, true));
    let [_, rate, second, third] = heading_at(&headings, 1004);
    // A fifth of half a step over 10 ms, some times over.
    assert!((rate - std::f64::consts::FRAC_PI_2).abs() < 0.1 && second == 0.0 && third == 0.0, "{rate}");
    (1010..=1500).step_by(10).for_each(|ms| headings.accept(sent(1000), 0.0, ms, true));
    assert_eq!(heading_at(&headings, 1504)[1], 0.0, "it is at rest again");
    headings.accept(sent(0), 0.0, 1510, true);
    assert_eq!(heading_at(&headings, 1514)[1], 0.0, "a jump is no turn");
}
