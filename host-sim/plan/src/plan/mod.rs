//! Planning: waypoints and bounds in, a B-spline that holds them for all t out.
//!
//! The method of the paper's reference \[10\], "virtual control points". The flat output `sigma(t) = (x, y, z)` is a
//! clamped uniform B-spline with control points `P_j`; its `k`-th derivative is a B-spline too, of degree `degree - k`,
//! whose control points `Pk_j` are scaled differences of those of derivative `k - 1`, and so linear in `P`. In each span a
//! B-spline is a mean of `degree - k + 1` consecutive control points with weights that are never negative: any
//! convex set holds those points holds the curve, for all t and not only at samples. With `g` gravity and
//! `h = a + g e3` the thrust vector, heading 0, the bounds are second-order cones in the control points:
//!
//! | bound | imposed on control points | why it holds for all t |
//! |---|---|---|
//! | speed | `\|P1_j\| <= speed_max` | a ball is convex |
//! | acceleration | `\|P2_j\| <= acceleration_max` | likewise |
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

mod budget;
mod detour;
mod diagnosis;
mod error;
mod file;
mod flight;
mod heading;
mod leg;
pub mod paper;
mod program;
mod realised;
mod socp;
pub mod stored;
mod times;

use std::ops::RangeInclusive;

use nalgebra::Vector3;

use crate::trajectory::bspline::{BSpline, UniformBasis};

pub use budget::Budget;
pub use detour::Detour;
pub use diagnosis::{Infeasibility, Limit, Remedy};
pub use error::{PlanError, WaypointName};
pub use file::{FindVehicle, Overrides};
pub use flight::{FlightPlan, PlannedFlight, PlannedLeg};
pub use realised::{Extremes, Realised};

/// Spans of the longest flight; the bound keeps a slip of the finger from filling the memory.
const MOST_SPANS: usize = 500;

/// A position to pass at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    /// The time, s.
    pub time_s: f64,
    /// The position, m, world frame.
    pub position_m: Vector3<f64>,
    /// How far off the curve may pass, m; 0 is to be met exactly.
    pub tolerance_m: f64,
    /// Velocity there, m/s; `None` is free.
    pub velocity_m_s: Option<Vector3<f64>>,
    /// Heading there, rad, turns counted; `None` is free.
    pub heading_rad: Option<f64>,
}

/// The bounds of the flight for all t; `None` is no bound.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// Speed, m/s.
    pub speed_max_m_s: Option<f64>,
    /// Acceleration, without gravity, m/s^2.
    pub acceleration_max_m_s2: Option<f64>,
    /// Angle between thrust and vertical, rad.
    pub tilt_max_rad: Option<f64>,
    /// Lower bound on thrust over mass, m/s^2, imposed on its vertical part.
    pub thrust_min_m_s2: Option<f64>,
    /// Upper bound on thrust over mass, m/s^2.
    pub thrust_max_m_s2: Option<f64>,
    /// Rate at which the thrust axis turns, rad/s.
    pub body_rate_max_rad_s: Option<f64>,
    /// Rate of the heading, rad/s.
    pub heading_rate_max_rad_s: Option<f64>,
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

/// A planning problem for one curve whose numbers are all in range.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    basis: UniformBasis,
    /// Whether it starts and ends at rest.
    rest: [bool; 2],
    snap_sample_period_s: f64,
    body_rate_slack_reward: f64,
    waypoints: Vec<Waypoint>,
    bounds: Bounds,
    corridors: Vec<Corridor>,
    /// Number of the first waypoint in the file, from 1.
    first_number: usize,
}
