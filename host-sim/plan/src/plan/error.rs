//! Why a plan gives no curve: a fault in, one line that names it and the remedy out.

use std::fmt;

use super::MOST_SPANS;
use super::diagnosis::Infeasibility;
use crate::trajectory::bspline::BSplineError;
use crate::trajectory::waypoints::WaypointsError;

/// Why a plan gives no curve.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// Nothing in the file.
    #[error("the plan is empty: it needs at least two [[waypoints]] with position_m, and time_s or [bounds]")]
    Empty,
    /// Rows of waypoints that cannot be used.
    #[error(transparent)]
    Rows(#[from] WaypointsError),
    /// Not TOML, a key that is unknown or missing, or a value of the wrong type.
    #[error("line {line}: {reason}")]
    Syntax {
        /// The line, from 1.
        line: usize,
        /// The parser's message, in one line.
        reason: String,
    },
    /// A value out of range.
    #[error("{field} = {value}: must be {must}")]
    Value {
        /// The key, with its place where there are several.
        field: String,
        /// The value as read.
        value: f64,
        /// Its required range, in words.
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
        "has no time_s: give it, or segment_shares for all, or no times at all to have them found from the bounds"
    })]
    WaypointTime {
        /// The waypoint.
        waypoint: WaypointName,
        /// Whether both were given.
        twice: bool,
    },
    /// Segments do not match waypoints.
    #[error("segment_shares: {found} given for {waypoints} waypoints; there must be {}, one between each two", waypoints - 1)]
    SegmentShares {
        /// The number of shares.
        found: usize,
        /// The number of waypoints.
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
    /// The first waypoint is not at 0.
    #[error("{waypoint}: must be at 0 s, since the first waypoint is where the flight starts")]
    StartTime {
        /// The first.
        waypoint: WaypointName,
    },
    /// Shares of nothing.
    #[error("segment_shares: shares of duration_s, which is not given; give it, or leave segment_shares out")]
    SharesWithoutDuration,
    /// Nothing from which times could be found.
    #[error(
        "no times and nothing to find them from: give time_s at the waypoints, or duration_s with segment_shares, or bounds: \
         speed_max_m_s and acceleration_max_m_s2, or vehicle"
    )]
    NothingBounds,
    /// Velocities at waypoints whose times are to be found.
    #[error("velocity_m_s and rest_to_rest = false need time_s at the waypoints")]
    MovingWithoutTimes,
    /// Corridors over times that are to be found.
    #[error("[[corridors]]: from_s and to_s need time_s at the waypoints; leave them out for the whole flight")]
    CorridorWithoutTimes,
    /// A pause whose length is not said.
    #[error("{waypoint}: the same place as the one before it; a pause needs time_s at the waypoints")]
    PauseWithoutTimes {
        /// The later one.
        waypoint: WaypointName,
    },
    /// No times within the bounds; the remedies that the plan has.
    #[error("no times were found with which a curve meets the bounds, however slow: {}", remedies(*corridors, *spans, *thrust))]
    NoTimes {
        /// Whether corridors hold the curve.
        corridors: bool,
        /// Whether more spans may be asked for.
        spans: bool,
        /// Whether the thrust is bounded.
        thrust: bool,
    },
    /// Rest and motion at one place.
    #[error("{waypoint}: has a velocity_m_s where the flight rests; leave out the one or the other")]
    MovingStop {
        /// The waypoint.
        waypoint: WaypointName,
    },
    /// A box that would not be one along the axes any more.
    #[error("[[corridors]]: boxes along the axes cannot be turned; turn the trajectory after it is planned")]
    TurnedCorridor,
    /// Several curves where one is asked for.
    #[error("the flight has stops and so several curves; plan it as a flight (FlightPlan)")]
    SeveralCurves,
    /// A vehicle that is not known or cannot fly.
    #[error("bounds.vehicle = {name:?}: {reason}")]
    Vehicle {
        /// The name as written.
        name: String,
        /// The fault.
        reason: String,
    },
    /// A heading that turns too fast for its bound.
    #[error(
        "no heading meets the plan: yaw_rate_max_deg_s = {} is too tight ({enough_deg_s} would do), or duration_s is too short \
         ({duration_s} would do); the rest kept", (given_deg_s * 1e9).round() / 1e9
    )]
    HeadingRate {
        /// The bound, deg/s.
        given_deg_s: f64,
        /// A bound that would do, deg/s.
        enough_deg_s: f64,
        /// A duration that would do, s.
        duration_s: f64,
    },
    /// Schoenberg and Whitney's condition fails: two waypoints would have to be met with one control point.
    #[error(
        "{waypoint}: cannot be met exactly, spans = {spans} leave no control point for it; {}",
        if *spans < MOST_SPANS { "raise spans, or give tolerance_m" } else { "give it tolerance_m, or fewer waypoints" }
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
        /// The pair.
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
    /// No answer in the time allowed.
    #[error("no answer within {limit_s} s; take fewer spans or waypoints, or allow more time")]
    TimeLimit {
        /// The time allowed, s.
        limit_s: f64,
    },
    /// The solver stopped without an answer.
    #[error(
        "the solver stopped without an answer ({0}): the plan is at the edge of its bounds, or its numbers \
         differ too much in size; loosen a bound or take fewer spans"
    )]
    NotConverged(String),
}

impl PlanError {
    /// Whether the plan was understood and found to be impossible, rather than not understood or not solved.
    pub fn is_infeasible(&self) -> bool {
        matches!(self, Self::Infeasible(_) | Self::HeadingRate { .. })
    }
}

/// The remedies for a plan whose times were not found.
fn remedies(corridors: bool, spans: bool, thrust: bool) -> String {
    let all = [
        (corridors, "more room in the corridors"),
        (spans, "more spans"),
        (thrust, "a thrust_max_m_s2 further above g"),
        (true, "a tolerance_m at the waypoints"),
        (true, "fewer waypoints"),
    ];
    let of_plan: Vec<&str> = all.iter().filter(|(there, _)| *there).map(|(_, remedy)| *remedy).collect();
    format!("give it {}", of_plan.join(", or "))
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
