//! Courses of the high-level commander: analytic figures, its own take-off and landing, uploaded trajectories.

use nalgebra::Vector3;
use quatrack_plan::plan::{self, Plan, PlanError};
use quatrack_plan::trajectory::bspline::BSpline;
use quatrack_plan::trajectory::fifth_order::{Eight, FifthOrder, FlatTrajectory as _};
use thiserror::Error;

/// Position and its derivatives up to the jerk at one time, SI, world frame.
pub(super) type Motion = [Vector3<f64>; 4];

/// Pieces that the firmware's trajectory memory holds: 4096 bytes of 132 each.
pub(super) const PIECES_MAX: usize = 31;

/// A course over time.
#[derive(Clone, Debug)]
pub enum Course {
    /// Rest at a point.
    Hover(Vector3<f64>),
    /// Rest at the first point, at the second from 1 s on.
    Step(Vector3<f64>, Vector3<f64>),
    /// `x = sin wt, y = sin(2 wt) / 2`, 1 m high; w in rad/s.
    FigureEight(f64),
    /// From standing at the first height to the second in 2 s, 1 s of hover, and back.
    Hop(f64, f64),
    /// Pieces of degree 7.
    Septics(Septics),
}

/// Why there is no course.
#[derive(Debug, Error)]
pub enum CourseError {
    /// The planner found none of the paper's trajectories.
    #[error("the paper's trajectories: {0}")]
    Plan(#[from] PlanError),
}

/// Where [`Course::Hop`] takes off, hovers and lands, s.
const HOP_S: [f64; 3] = [2.0, 3.0, 5.0];

impl Course {
    /// One of the paper's trajectories as an uploaded one.
    ///
    /// # Errors
    /// [`CourseError::Plan`].
    pub fn mild() -> Result<Self, CourseError> {
        Self::planned(&plan::paper::mild()?)
    }

    /// The other one.
    ///
    /// # Errors
    /// [`CourseError::Plan`].
    pub fn aggressive() -> Result<Self, CourseError> {
        Self::planned(&plan::paper::aggressive()?)
    }

    fn planned(plan: &Plan) -> Result<Self, CourseError> {
        Ok(Self::Septics(Septics::refit(&plan.solve()?, plan.duration_s(), PIECES_MAX)))
    }

    /// The motion at a time; nothing once it is over and the commander sends no more.
    pub(super) fn at(&self, t_s: f64) -> Option<Motion> {
        let rest = |p: &Vector3<f64>| [*p, Vector3::zeros(), Vector3::zeros(), Vector3::zeros()];
        match self {
            Self::Hover(p) => Some(rest(p)),
            Self::Step(from, to) => Some(rest(if t_s < 1.0 { from } else { to })),
            Self::FigureEight(w) => Some(to_jerk(&figure_eight(*w, t_s))),
            Self::Hop(low, high) => {
                let [up, down, end] = HOP_S;
                let height = if t_s <= down {
                    septic(*low, *high, up, t_s)
                } else {
                    septic(*high, *low, end - down, t_s - down)
                };
                (t_s <= end).then(|| height.map(|z| Vector3::new(0.0, 0.0, z)))
            }
            Self::Septics(septics) => Some(septics.at(t_s)),
        }
    }

    /// Where it comes from: the figures that go on before the start as they do after it, at a time that may be negative.
    pub(super) fn coming_from(&self, t_s: f64) -> Option<FifthOrder> {
        if let Self::FigureEight(w) = self { Some(figure_eight(*w, t_s)) } else { None }
    }

    /// Its position at a time, m.
    pub fn position_m(&self, t_s: f64) -> Option<Vector3<f64>> {
        self.at(t_s).map(|[position_m, ..]| position_m)
    }

    /// Farthest that pieces are from the curve that they are fitted to, m; 0 for courses that are flown as they are.
    pub fn fit_error_m(&self) -> f64 {
        if let Self::Septics(septics) = self { septics.fit_error_m() } else { 0.0 }
    }

    /// Its duration, s.
    pub fn duration_s(&self) -> f64 {
        match self {
            Self::Hover(_) | Self::Step(..) => 5.0,
            Self::FigureEight(w) if *w < 1.0 => 30.0,
            Self::FigureEight(_) => 12.0,
            Self::Hop(..) => HOP_S[2],
            Self::Septics(septics) => septics.duration_s,
        }
    }
}

/// To the fifth derivative; also before its start.
fn figure_eight(w: f64, t_s: f64) -> FifthOrder {
    Eight { rate_rad_s: w, duration_s: f64::INFINITY }.at(t_s)
}

/// The motion to the jerk, as far as the commander knows it.
fn to_jerk(point: &FifthOrder) -> Motion {
    let [position, velocity, acceleration, jerk, _, _] = point.position;
    [position, velocity, acceleration, jerk]
}

/// From rest at one value to rest at another, jerk and all, as `piecewise_plan_7th_order_no_jerk` has it; then rest.
fn septic(from: f64, to: f64, duration_s: f64, t_s: f64) -> [f64; 4] {
    let (s, d) = ((t_s / duration_s).min(1.0), to - from);
    let (s2, s3) = (s * s, s * s * s);
    let rate = |order: i32| d / duration_s.powi(order);
    [
        from + d * s3 * s * (35.0 - 84.0 * s + 70.0 * s2 - 20.0 * s3),
        rate(1) * s3 * (140.0 - 420.0 * s + 420.0 * s2 - 140.0 * s3),
        rate(2) * s2 * (420.0 - 1680.0 * s + 2100.0 * s2 - 840.0 * s3),
        rate(3) * s * (840.0 - 5040.0 * s + 8400.0 * s2 - 4200.0 * s3),
    ]
}

/// A trajectory of pieces of degree 7 and of the same duration.
#[derive(Clone, Debug)]
pub struct Septics {
    pieces: Vec<[Vector3<f64>; 8]>,
    duration_s: f64,
    fit_error_m: f64,
}

impl Septics {
    /// The pieces that agree with a curve in position, velocity, acceleration and jerk where they meet.
    pub fn refit(curve: &BSpline, duration_s: f64, pieces: usize) -> Self {
        let piece_s = duration_s / pieces as f64;
        let ends = |t_s: f64| [0, 1, 2, 3].map(|order| curve.derivative(order, t_s));
        let fitted =
            (0..pieces).map(|i| hermite(&ends(piece_s * i as f64), &ends(piece_s * (i + 1) as f64), piece_s)).collect();
        let mut septics = Self { pieces: fitted, duration_s, fit_error_m: 0.0 };
        let samples = (0..=2000).map(|k| duration_s * f64::from(k) / 2000.0);
        let error = |t_s: f64| (septics.at(t_s)[0] - curve.derivative(0, t_s)).norm();
        septics.fit_error_m = samples.map(error).fold(0.0, f64::max);
        septics
    }

    /// Farthest that the pieces are from the curve, m.
    pub fn fit_error_m(&self) -> f64 {
        self.fit_error_m
    }

    /// The motion; rest at the end.
    fn at(&self, t_s: f64) -> Motion {
        let piece_s = self.duration_s / self.pieces.len() as f64;
        let index = ((t_s / piece_s).floor().max(0.0) as usize).min(self.pieces.len() - 1);
        let t = (t_s - piece_s * index as f64).min(piece_s);
        let piece = &self.pieces[index];
        [0_usize, 1, 2, 3].map(|order| {
            (order..8).rev().fold(Vector3::zeros(), |sum, power| {
                let factor: f64 = (power + 1 - order..=power).map(|k| k as f64).product();
                sum * t + piece[power] * factor
            })
        })
    }
}

/// Coefficients, in ascending powers, of the septic between two ends of a piece.
fn hermite(from: &Motion, to: &Motion, h: f64) -> [Vector3<f64>; 8] {
    let [p0, v0, a0, j0] = *from;
    let [c0, c1, c2, c3] = [p0, v0, a0 / 2.0, j0 / 6.0];
    // The rest at the end for the upper four coefficients, in powers of the duration.
    let p = to[0] - (c0 + c1 * h + c2 * h * h + c3 * h.powi(3));
    let v = (to[1] - (c1 + c2 * (2.0 * h) + c3 * (3.0 * h * h))) * h;
    let a = (to[2] - (c2 * 2.0 + c3 * (6.0 * h))) * (h * h);
    let j = (to[3] - c3 * 6.0) * h.powi(3);
    let c4 = (p * 35.0 - v * 15.0 + a * 2.5 - j / 6.0) / h.powi(4);
    let c5 = (p * -84.0 + v * 39.0 - a * 7.0 + j * 0.5) / h.powi(5);
    let c6 = (p * 70.0 - v * 34.0 + a * 6.5 - j * 0.5) / h.powi(6);
    let c7 = (p * -20.0 + v * 10.0 - a * 2.0 + j / 6.0) / h.powi(7);
    [c0, c1, c2, c3, c4, c5, c6, c7]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_septic_ends_as_it_should() {
        let ends: [Motion; 2] = [0.3, 1.7].map(|t| to_jerk(&figure_eight(1.485, t)));
        let septics = Septics { pieces: vec![hermite(&ends[0], &ends[1], 1.4)], duration_s: 1.4, fit_error_m: 0.0 };
        for (t, end) in [(0.0, &ends[0]), (1.4, &ends[1])] {
            for (found, wanted) in septics.at(t).iter().zip(end) {
                assert!((found - wanted).norm() < 1e-10, "{found} {wanted}");
            }
        }
    }

    #[test]
    fn take_off_is_a_septic_between_rests() {
        let hop = Course::Hop(0.0, 1.0);
        let one = hermite(&hop.at(0.0).unwrap(), &hop.at(2.0).unwrap(), 2.0);
        let septics = Septics { pieces: vec![one], duration_s: 2.0, fit_error_m: 0.0 };
        for (found, wanted) in septics.at(0.7).iter().zip(hop.at(0.7).unwrap()) {
            assert!((found - wanted).norm() < 1e-12, "{found} {wanted}");
        }
        assert!(hop.at(5.001).is_none());
    }
}
