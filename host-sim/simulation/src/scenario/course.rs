//! The course of a scenario: 2 s of hover, 3 s in which an eight comes up to speed, then the measured part.

use nalgebra::Vector3;

use quatrack_plan::trajectory::fifth_order::{FifthOrder, FlatTrajectory, Jump, Rest};
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;

/// Hover before anything moves, s.
pub const HOVER_S: f64 = 2.0;
/// How long an eight takes to come up to speed, s.
pub const RAMP_S: f64 = 3.0;
/// Height of every course that is not a trajectory of its own, m.
const HEIGHT_M: f64 = 1.0;

/// A course with the part of it that counts.
pub struct Flown {
    /// From before the start of the measured part to its end.
    pub course: Box<dyn FlatTrajectory>,
    /// From when it is measured, s.
    pub measured_from_s: f64,
}

impl Flown {
    /// A hover at 1 m.
    pub fn hover(duration_s: f64) -> Self {
        let position_m = Vector3::new(0.0, 0.0, HEIGHT_M);
        let whole_s = HOVER_S + duration_s;
        Self { course: Box::new(Rest { position_m, heading_rad: 0.0, duration_s: whole_s }), measured_from_s: HOVER_S }
    }

    /// A hover whose place jumps forwards.
    pub fn step(step_m: f64, duration_s: f64) -> Self {
        let from_m = Vector3::new(0.0, 0.0, HEIGHT_M);
        let to_m = from_m + Vector3::x() * step_m;
        let course = Jump { from_m, to_m, at_s: HOVER_S, duration_s: HOVER_S + duration_s };
        Self { course: Box::new(course), measured_from_s: HOVER_S }
    }

    /// An eight of 2 m by 1 m, whose highest speed is given.
    pub fn eight(speed_m_s: f64, duration_s: f64) -> Self {
        let course = RampedEight { rate_rad_s: speed_m_s / std::f64::consts::SQRT_2, measured_s: duration_s };
        Self { course: Box::new(course), measured_from_s: HOVER_S + RAMP_S }
    }

    /// A trajectory after a hover at its start, or from its start where it does not begin at rest.
    pub fn trajectory(trajectory: PiecewisePolynomial, measured_s: Option<f64>) -> Self {
        let start = trajectory.at(0.0);
        let moves = start.position[1..4].iter().any(|derivative| derivative.norm() > 1e-6);
        let before_s = if moves { 0.0 } else { HOVER_S };
        let whole_s = FlatTrajectory::duration_s(&trajectory);
        let duration_s = before_s + measured_s.unwrap_or(whole_s).min(whole_s);
        Self { course: Box::new(Delayed { trajectory, before_s, duration_s }), measured_from_s: before_s }
    }
}

/// `x = sin s, y = 1/2 sin 2s` at 1 m, heading 0, with a phase `s` that rests for 2 s, gains speed for 3 s without a jump up
/// to the snap, and then goes on at a rate.
struct RampedEight {
    rate_rad_s: f64,
    measured_s: f64,
}

impl FlatTrajectory for RampedEight {
    fn duration_s(&self) -> f64 {
        HOVER_S + RAMP_S + self.measured_s
    }

    fn at(&self, t_s: f64) -> FifthOrder {
        let phase = self.phase(t_s);
        let [(sin, _), (sin_twice, _)] = [1.0, 2.0].map(|factor| sine_and_cosine(&phase.map(|c| factor * c)));
        // Coefficients of Taylor's series to derivatives.
        let factorial = [1.0, 1.0, 2.0, 6.0, 24.0, 120.0];
        let mut position = [0, 1, 2, 3, 4, 5].map(|k| Vector3::new(sin[k], 0.5 * sin_twice[k], 0.0) * factorial[k]);
        position[0].z = HEIGHT_M;
        FifthOrder { position, heading: [0.0; 4] }
    }
}

/// Taylor coefficients at a time, to the fifth order.
type Series = [f64; 6];

impl RampedEight {
    /// The phase, rad. While it gains speed its rate is `w (35 u^4 - 84 u^5 + 70 u^6 - 20 u^7)` with u from 0 to 1.
    fn phase(&self, t_s: f64) -> Series {
        let (w, since) = (self.rate_rad_s, t_s - HOVER_S);
        if since <= 0.0 {
            return [0.0; 6];
        }
        if since >= RAMP_S {
            // Half of the ramp's way is behind: the rate's integral is w RAMP_S / 2.
            return [w * (since - 0.5 * RAMP_S), w, 0.0, 0.0, 0.0, 0.0];
        }
        // The integral, in powers of u: 7 u^5 - 14 u^6 + 10 u^7 - 2.5 u^8.
        let way = [0.0, 0.0, 0.0, 0.0, 0.0, 7.0, -14.0, 10.0, -2.5];
        let u = since / RAMP_S;
        std::array::from_fn(|k| {
            let binomial = |n: usize| (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64);
            let sum: f64 = (k..way.len()).map(|n| way[n] * binomial(n) * u.powi((n - k) as i32)).sum();
            sum * w * RAMP_S / RAMP_S.powi(k as i32)
        })
    }
}

/// Sine and cosine of a series: `s' = c p'`, `c' = -s p'`, coefficient by coefficient.
fn sine_and_cosine(phase: &Series) -> (Series, Series) {
    let (mut sine, mut cosine) = ([0.0; 6], [0.0; 6]);
    (sine[0], cosine[0]) = phase[0].sin_cos();
    for n in 1..6 {
        for k in 1..=n {
            let share = k as f64 * phase[k] / n as f64;
            sine[n] += share * cosine[n - k];
            cosine[n] -= share * sine[n - k];
        }
    }
    (sine, cosine)
}

/// A trajectory after a rest at its start.
struct Delayed {
    trajectory: PiecewisePolynomial,
    before_s: f64,
    duration_s: f64,
}

impl FlatTrajectory for Delayed {
    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn at(&self, t_s: f64) -> FifthOrder {
        let since = t_s - self.before_s;
        if since < 0.0 {
            let start = self.trajectory.at(0.0);
            return FifthOrder::at_rest(start.position[0], start.heading[0]);
        }
        FlatTrajectory::at(&self.trajectory, since)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use quatrack_plan::trajectory::fifth_order::Eight;

    #[test]
    fn an_eight_has_the_speed_that_was_asked_for() {
        let flown = Flown::eight(2.1, 12.0);
        let samples = (0..1700).map(|k| flown.course.at(f64::from(k) * 0.01));
        let most = samples.map(|point| point.position[1].norm()).fold(0.0, f64::max);
        // A sample every 10 ms misses the peak by at most half of v'' (5 ms)^2 = 2e-4 m/s.
        assert!((most - 2.1).abs() < 2e-4, "{most}");
        assert!((flown.measured_from_s, flown.course.duration_s()) == (5.0, 17.0));
    }

    #[test]
    fn once_up_to_speed_it_is_the_eight_of_the_robustness_flights() {
        let (flown, w) = (Flown::eight(2.1, 12.0), 2.1 / 2.0_f64.sqrt());
        let eight = Eight { rate_rad_s: w, duration_s: 12.0 };
        let (point, same) = (flown.course.at(7.3), eight.at(7.3 - HOVER_S - 0.5 * RAMP_S));
        for (a, b) in point.position.iter().zip(&same.position) {
            assert!((a - b).norm() < 1e-12, "{a} {b}");
        }
    }

    #[test]
    fn derivatives_are_those_of_the_course_and_join() {
        let flown = Flown::eight(2.1, 12.0);
        let at = |t: f64| flown.course.at(t).position;
        let h = 1e-5;
        for t in [2.4, 3.1, 4.9] {
            for order in 0..5 {
                // Central difference: error h^2 of the third derivative, rounding over h.
                let slope = (at(t + h)[order] - at(t - h)[order]) / (2.0 * h);
                assert!((slope - at(t)[order + 1]).norm() < 2e-7, "{t} {order}: {slope} {}", at(t)[order + 1]);
            }
        }
        for t in [HOVER_S, HOVER_S + RAMP_S] {
            for order in 0..5 {
                assert!((at(t + 1e-9)[order] - at(t - 1e-9)[order]).norm() < 1e-6, "{t} {order}");
            }
        }
    }

    #[test]
    fn a_step_jumps_as_its_measurement_begins() {
        let flown = Flown::step(0.7, 5.0);
        let x = |t: f64| flown.course.at(t).position[0].x;
        assert!((x(1.999), x(2.0), flown.measured_from_s) == (0.0, 0.7, 2.0));
    }
}
