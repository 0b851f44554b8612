//! Planning: waypoints and bounds in, a B-spline that holds them for all t out.
//!
//! The method of the paper's reference \[10\], "virtual control points". The flat output `sigma(t) = (x, y, z)` is a
//! clamped uniform B-spline with control points `P_j`; its `k`-th derivative is a B-spline too, of degree `degree - k`,
//! whose control points `Pk_j` are scaled differences of those of derivative `k - 1`, and so linear in `P`. In each span a
//! B-spline is a mean of `degree - k + 1` consecutive control points with weights that are never negative: whatever
//! convex set holds those points holds the curve, for all t and not only at samples. With `g` gravity and
//! `h = a + g e3` the thrust vector, heading 0, the bounds are second-order cones in the control points:
//!
//! | bound | imposed on control points | why it holds for all t |
//! |---|---|---|
//! | speed | `\|P1_j\| <= speed_max` | a ball is convex |
//! | tilt | `\|P2_j,xy\| <= tan(tilt_max) (P2_j,z + g)` | the set of `h` within `tilt_max` of vertical is a cone |
//! | thrust, upper | `\|P2_j + g e3\| <= thrust_max` | `T = \|h\|` |
//! | thrust, lower | `P2_j,z + g >= thrust_min` | `T >= h_z` |
//! | body rate | for each span `l`: `P2_j,z + g >= zeta_l >= 0` and `\|P3_j\| <= rate_max zeta_l` | the thrust axis turns at `\|n_dot\| <= \|jerk\| / T <= \|jerk\| / zeta_l` |
//! | corridor | `min <= P_j <= max` for the spans it touches | a box is convex |
//! | waypoint | `\|sigma(t_i) - r_i\| <= tolerance_i`, or equal | at that time only |
//!
//! `|n_dot|` is the part of the body rate across the thrust axis, `sqrt(p^2 + q^2)`; with the paper's `q3 = 0` the part
//! along it is at most `tan(tilt / 2)` of that. Rest at both ends means that the first four control points are equal,
//! and so are the last four. The objective is that of \[10\] with the flights of the paper: the snap at samples, less a
//! reward for slack in the body rate's bound, `sum_k |sigma''''(k T)|^2 - reward sum_l zeta_l`, in SI units.

mod diagnosis;
mod error;
mod file;
pub mod paper;
mod program;
mod realised;
mod socp;
pub mod stored;

use std::ops::RangeInclusive;

use nalgebra::Vector3;

use crate::trajectory::bspline::{BSpline, UniformBasis};

pub use diagnosis::{Infeasibility, Limit, Remedy};
pub use error::{PlanError, WaypointName};
pub use realised::{Extremes, Realised};

/// Where to be at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    /// When, s.
    pub time_s: f64,
    /// Where, m, world frame.
    pub position_m: Vector3<f64>,
    /// How far off the curve may pass, m; 0 is to be met exactly.
    pub tolerance_m: f64,
}

/// What the flight must keep to for all t; `None` is no bound.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// Speed, m/s.
    pub speed_max_m_s: Option<f64>,
    /// Angle between thrust and vertical, rad.
    pub tilt_max_rad: Option<f64>,
    /// Lower bound on thrust over mass, m/s^2, imposed on its vertical part.
    pub thrust_min_m_s2: Option<f64>,
    /// Upper bound on thrust over mass, m/s^2.
    pub thrust_max_m_s2: Option<f64>,
    /// Rate at which the thrust axis turns, rad/s.
    pub body_rate_max_rad_s: Option<f64>,
}

/// An axis-aligned box that holds the flight for some time.
///
/// It is imposed on the control points of every span that the time touches, so that it may bind a little before and
/// after.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corridor {
    /// From when, s.
    pub from_s: f64,
    /// Until when, s.
    pub to_s: f64,
    /// Least coordinates, m, world frame.
    pub min_m: Vector3<f64>,
    /// Greatest coordinates, m, world frame.
    pub max_m: Vector3<f64>,
}

/// A planning problem whose numbers are all in range.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    basis: UniformBasis,
    rest_to_rest: bool,
    snap_sample_period_s: f64,
    body_rate_slack_reward: f64,
    waypoints: Vec<Waypoint>,
    bounds: Bounds,
    corridors: Vec<Corridor>,
}

impl Plan {
    /// Reads a plan from TOML; the keys are those of `plans/mild.toml` and `plans/aggressive.toml`, and `[[corridors]]`
    /// with `min_m`, `max_m` and, if not for the whole flight, `from_s` and `to_s`.
    ///
    /// # Errors
    /// [`PlanError`] names the key or waypoint, its value and what it must be.
    pub fn from_toml(text: &str) -> Result<Self, PlanError> {
        file::read(text)
    }

    /// Finds the curve. Start and end are as given; bounds and waypoints are kept within 1e-6 of their size and 1e-6 in SI
    /// units, the solver's accuracy; mostly it is 1e-9.
    ///
    /// # Errors
    /// [`PlanError::Infeasible`] with the bounds that are too tight, or [`PlanError::NotConverged`].
    pub fn solve(&self) -> Result<BSpline, PlanError> {
        let program = program::Program::new(self, &[]);
        let outcome = match socp::solve(&program, socp::Accuracy::CURVE) {
            socp::Outcome::Failed(_) => socp::solve(&program, socp::Accuracy::EDGE),
            outcome => outcome,
        };
        match outcome {
            socp::Outcome::Solved(values) => {
                let curve = self.curve(&values)?;
                // The solver's residuals are relative to the whole program; this looks at each bound.
                if self.kept_by(&curve) {
                    Ok(curve)
                } else {
                    Err(PlanError::NotConverged("bounds not kept".to_owned()))
                }
            }
            socp::Outcome::Infeasible => Err(PlanError::Infeasible(diagnosis::diagnose(self))),
            socp::Outcome::Failed(reason) => Err(PlanError::NotConverged(reason)),
        }
    }

    /// Degree of the curve.
    pub fn degree(&self) -> usize {
        self.basis.degree()
    }

    /// Number of its polynomial spans.
    pub fn spans(&self) -> usize {
        self.basis.spans()
    }

    /// Length of the flight in time, s.
    pub fn duration_s(&self) -> f64 {
        self.basis.duration_s()
    }

    /// Waypoints in order of time; the first is the start, the last the end.
    pub fn waypoints(&self) -> &[Waypoint] {
        &self.waypoints
    }

    /// Bounds for the whole flight.
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// Boxes that hold the flight.
    pub fn corridors(&self) -> &[Corridor] {
        &self.corridors
    }

    /// The curve whose coordinates are the first variables of a program.
    fn curve(&self, values: &[f64]) -> Result<BSpline, PlanError> {
        let n = self.basis.control_points();
        let mut points: Vec<_> = (0..n).map(|j| Vector3::new(values[j], values[n + j], values[2 * n + j])).collect();
        // Those given at the ends are as given; the solver leaves 1e-17 or so, which would not be rest.
        let count = self.points_at_an_end();
        if let [start, .., end] = self.waypoints.as_slice() {
            points[..count].fill(start.position_m);
            points[n - count..].fill(end.position_m);
        }
        Ok(BSpline::new(self.degree(), self.duration_s(), points)?)
    }

    /// Waypoints other than start and end.
    fn inner_waypoints(&self) -> &[Waypoint] {
        self.waypoints.get(1..self.waypoints.len().saturating_sub(1)).unwrap_or_default()
    }

    /// How many control points are given at each end: position only, or rest up to jerk.
    fn points_at_an_end(&self) -> usize {
        if self.rest_to_rest { 4 } else { 1 }
    }

    /// Control points of the spans that a corridor touches.
    fn points_of(&self, corridor: &Corridor) -> RangeInclusive<usize> {
        let spans = self.spans() as f64;
        // A time written in decimals that means a knot must not touch the span on its other side.
        let first = (corridor.from_s / self.duration_s() * spans + 1e-9).floor() as usize;
        let last = ((corridor.to_s / self.duration_s() * spans - 1e-9).ceil() as usize).saturating_sub(1);
        first.min(self.spans() - 1)..=last.clamp(first, self.spans() - 1) + self.degree()
    }

    /// Schoenberg and Whitney: waypoints can be met exactly, whatever their positions, if and only if each can have a
    /// control point of its own, in order, whose basis function is not zero there.
    fn check_spans(&self) -> Result<(), PlanError> {
        let mut free = self.points_at_an_end();
        let end = self.basis.control_points() - self.points_at_an_end();
        for (waypoint, number) in self.inner_waypoints().iter().zip(2..) {
            if waypoint.tolerance_m > 0.0 {
                continue;
            }
            let (first, weights) = self.basis.derivative_at(0, waypoint.time_s);
            let mut candidates = (first.max(free)..first + weights.len()).filter(|j| weights[j - first] > 1e-12);
            match candidates.next() {
                Some(j) if j < end => free = j + 1,
                _ => {
                    let waypoint = WaypointName { number, time_s: Some(waypoint.time_s) };
                    return Err(PlanError::TooFewSpans { waypoint, spans: self.spans() });
                }
            }
        }
        Ok(())
    }
}
