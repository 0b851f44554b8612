//! Why a plan gives no curve: what was found wrong in, one line that names it and the remedy out.

use std::fmt;

use super::diagnosis::Infeasibility;
use crate::trajectory::bspline::BSplineError;

/// Why a plan gives no curve.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// Nothing in the file.
    #[error(
        "the plan is empty: it needs degree, spans, duration_s, snap_sample_period_s and at least two [[waypoints]]"
    )]
    Empty,
    /// Not TOML, a key that is unknown or missing, or a value of the wrong type.
    #[error("line {line}: {reason}")]
    Syntax {
        /// Where, from 1.
        line: usize,
        /// What the parser says, in one line.
        reason: String,
    },
    /// A value out of range.
    #[error("{field} = {value}: must be {must}")]
    Value {
        /// The key, with its place where there are several.
        field: String,
        /// The value as read.
        value: f64,
        /// What it must be.
        must: String,
    },
    /// Fewer than a start and an end.
    #[error("[[waypoints]]: {0} given; a plan needs at least two, the start and the end")]
    TooFewWaypoints(usize),
    /// Without rest at the ends, fewer waypoints than it takes to tell a curve.
    #[error(
        "[[waypoints]]: {0} given with rest_to_rest = false; the snap of every cubic is zero, so at least four are \
         needed to tell the curve: add waypoints or keep rest_to_rest = true"
    )]
    Undetermined(usize),
    /// Neither or both of the two ways to say when.
    #[error("{waypoint}: {}", if *.twice {
        "has time_s, and segment_shares is given too: keep one of the two"
    } else {
        "has no time_s: give it, or segment_shares for all"
    })]
    WaypointTime {
        /// Which one.
        waypoint: WaypointName,
        /// Whether both were given.
        twice: bool,
    },
    /// Segments do not match waypoints.
    #[error("segment_shares: {found} given for {waypoints} waypoints; there must be {}, one between each two", waypoints - 1)]
    SegmentShares {
        /// How many shares there are.
        found: usize,
        /// How many waypoints there are.
        waypoints: usize,
    },
    /// Times that do not grow.
    #[error("{waypoint}: not after the one before it, at {before_s} s; put waypoints in order of time, no two at once")]
    NotIncreasing {
        /// The later one in the file.
        waypoint: WaypointName,
        /// The time of the one before, s.
        before_s: f64,
    },
    /// The first waypoint is not at 0 or the last not at the end.
    #[error("{waypoint}: must be at {expected_s} s, since the {} waypoint is where the flight {}",
        if *expected_s == 0.0 { "first" } else { "last" }, if *expected_s == 0.0 { "starts" } else { "ends (duration_s)" })]
    EndTime {
        /// The first or the last.
        waypoint: WaypointName,
        /// Where it must be, s.
        expected_s: f64,
    },
    /// Schoenberg and Whitney's condition fails: two waypoints would have to be met with one control point.
    #[error(
        "{waypoint}: cannot be met exactly, spans = {spans} leave no control point for it; raise spans, or give tolerance_m"
    )]
    TooFewSpans {
        /// The first waypoint that is left without.
        waypoint: WaypointName,
        /// Spans of the plan.
        spans: usize,
    },
    /// A lower bound that is not below its upper one.
    #[error("{field}: lower {lower}, upper {upper}; the lower one must be below")]
    Crossed {
        /// Which pair.
        field: String,
        /// Lower bound, SI.
        lower: f64,
        /// Upper bound, SI.
        upper: f64,
    },
    /// Degree, spans, duration or a control point that make no spline.
    #[error(transparent)]
    Spline(#[from] BSplineError),
    /// No curve meets the plan.
    #[error("{0}")]
    Infeasible(Infeasibility),
    /// The solver stopped without an answer.
    #[error(
        "the solver stopped without an answer ({0}): the plan is at the edge of what its bounds allow, or its numbers \
         differ too much in size; loosen a bound or take fewer spans"
    )]
    NotConverged(String),
}

impl PlanError {
    /// Whether the plan was understood and found to be impossible, rather than not understood or not solved.
    pub fn is_infeasible(&self) -> bool {
        matches!(self, Self::Infeasible(_))
    }
}

/// How a message calls a waypoint: by its number in the file, from 1, and its time if known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaypointName {
    /// From 1, as people count.
    pub number: usize,
    /// Time, s.
    pub time_s: Option<f64>,
}

impl fmt::Display for WaypointName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "waypoint {}", self.number)?;
        self.time_s.map_or(Ok(()), |time_s| write!(f, " (time_s = {time_s})"))
    }
}
