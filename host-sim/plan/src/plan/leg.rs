//! One curve: its plan in, the B-spline that meets it or the limits that are too tight out.

use super::diagnosis::diagnose;
use super::error::WaypointName;
use super::program::Program;
use super::{
    BSpline, Bounds, Budget, Corridor, FlightPlan, Plan, PlanError, RangeInclusive, UniformBasis, Vector3, Waypoint,
    file, heading, socp,
};

/// Why there is no curve, not yet looked into.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum NoCurve {
    /// There is none.
    Infeasible,
    /// The solver stopped; near the edge of the bounds, mostly.
    Failed(String),
    /// The time is up.
    OutOfTime,
}

impl Plan {
    /// Reads a plan of one curve from TOML; the keys are those of `plans/mild.toml` and `plans/aggressive.toml`, and of
    /// docs/plan.md.
    ///
    /// # Errors
    /// [`PlanError`] names the key or waypoint, its value and its range; [`PlanError::SeveralCurves`] for a flight with
    /// stops, which [`FlightPlan`] plans.
    pub fn from_toml(text: &str) -> Result<Self, PlanError> {
        let plan = FlightPlan::from_toml(text, &file::Overrides::default(), &Budget::unlimited())?;
        plan.into_one()
    }

    /// Finds the curve. Start and end are as given; bounds and waypoints are kept within 1e-6 of their size and 1e-6 in SI
    /// units, the solver's accuracy; mostly it is 1e-9.
    ///
    /// # Errors
    /// [`PlanError::Infeasible`] with the bounds that are too tight, or [`PlanError::NotConverged`].
    pub fn solve(&self) -> Result<BSpline, PlanError> {
        let budget = Budget::unlimited();
        let curve =
            self.curve_within(&budget).map_err(|reason| diagnose(std::slice::from_ref(self), &reason, &budget))?;
        heading::planned(self, curve, &budget)
    }

    /// The curve, or why there is none.
    pub(super) fn curve_within(&self, budget: &Budget<'_>) -> Result<BSpline, NoCurve> {
        // Numbers around the start keep their digits however far away it is.
        let Some(start) = self.waypoints.first() else { return Err(NoCurve::Failed("no waypoints".into())) };
        let origin_m = start.position_m;
        if origin_m != Vector3::zeros() {
            let curve = self.moved(&-origin_m).curve_within(budget)?;
            let points = curve.control_points_m().iter().map(|point| point + origin_m).collect();
            return self.with_ends(points).map_err(|error| NoCurve::Failed(error.to_string()));
        }
        let program = Program::new(self, &[]);
        let mut outcome = socp::solve(&program, socp::Accuracy::CURVE, budget);
        if matches!(outcome, socp::Outcome::Failed(_)) {
            outcome = socp::solve(&program, socp::Accuracy::EDGE, budget);
        }
        match outcome {
            socp::Outcome::Solved(values) => {
                let curve = self.curve(&values).map_err(|error| NoCurve::Failed(error.to_string()))?;
                // The solver's residuals are relative to the whole program; this looks at each bound.
                if self.kept_by(&curve) { Ok(curve) } else { Err(NoCurve::Failed("bounds not kept".to_owned())) }
            }
            socp::Outcome::Infeasible => Err(NoCurve::Infeasible),
            socp::Outcome::Failed(reason) => Err(NoCurve::Failed(reason)),
            socp::Outcome::OutOfTime => Err(NoCurve::OutOfTime),
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

    /// Number of the first waypoint in its file, from 1.
    pub fn first_number(&self) -> usize {
        self.first_number
    }

    /// The same plan elsewhere.
    pub(super) fn moved(&self, by_m: &Vector3<f64>) -> Self {
        let mut plan = self.clone();
        plan.waypoints.iter_mut().for_each(|waypoint| waypoint.position_m += by_m);
        for corridor in &mut plan.corridors {
            corridor.min_m += by_m;
            corridor.max_m += by_m;
        }
        plan
    }

    /// The same plan in `ratio` times the time.
    pub(super) fn stretched(&self, ratio: f64) -> Option<Self> {
        let mut plan = self.clone();
        plan.basis = UniformBasis::new(self.degree(), self.spans(), ratio * self.duration_s()).ok()?;
        plan.snap_sample_period_s *= ratio;
        let end_s = plan.basis.duration_s();
        plan.waypoints.iter_mut().for_each(|waypoint| waypoint.time_s *= ratio);
        if let Some(last) = plan.waypoints.last_mut() {
            last.time_s = end_s;
        }
        for corridor in &mut plan.corridors {
            corridor.from_s *= ratio;
            corridor.to_s = (ratio * corridor.to_s).min(end_s);
        }
        Some(plan)
    }

    /// The curve whose coordinates are the first variables of a program.
    pub(super) fn curve(&self, values: &[f64]) -> Result<BSpline, PlanError> {
        let n = self.basis.control_points();
        self.with_ends((0..n).map(|j| Vector3::new(values[j], values[n + j], values[2 * n + j])).collect())
    }

    /// The curve of control points, those given at the ends as they are given; the solver leaves 1e-17 or so, which would not
    /// be rest.
    fn with_ends(&self, mut points: Vec<Vector3<f64>>) -> Result<BSpline, PlanError> {
        let n = points.len();
        let [at_start, at_end] = self.points_at_the_ends();
        if let [start, .., end] = self.waypoints.as_slice() {
            points[..at_start].fill(start.position_m);
            points[n - at_end..].fill(end.position_m);
        }
        Ok(BSpline::new(self.degree(), self.duration_s(), points)?)
    }

    /// Waypoints other than start and end.
    pub(super) fn inner_waypoints(&self) -> &[Waypoint] {
        self.waypoints.get(1..self.waypoints.len().saturating_sub(1)).unwrap_or_default()
    }

    /// How many control points are given at start and end: position only, or rest up to jerk.
    pub(super) fn points_at_the_ends(&self) -> [usize; 2] {
        self.rest.map(|rest| if rest { 4 } else { 1 })
    }

    /// Control points of the spans that a corridor touches.
    pub(super) fn points_of(&self, corridor: &Corridor) -> RangeInclusive<usize> {
        let spans = self.spans() as f64;
        // A time written in decimals that means a knot must not touch the span on its other side.
        let first = (corridor.from_s / self.duration_s() * spans + 1e-9).floor() as usize;
        let last = ((corridor.to_s / self.duration_s() * spans - 1e-9).ceil() as usize).saturating_sub(1);
        first.min(self.spans() - 1)..=last.clamp(first, self.spans() - 1) + self.degree()
    }

    /// Schoenberg and Whitney: waypoints can be met exactly, at any positions, if and only if each condition can have
    /// a control point of its own, in order, whose basis function is not zero there.
    pub(super) fn check_spans(&self) -> Result<(), PlanError> {
        let [at_start, at_end] = self.points_at_the_ends();
        let velocity_at = |waypoint: Option<&Waypoint>| usize::from(waypoint.is_some_and(|w| w.velocity_m_s.is_some()));
        let mut free = at_start + velocity_at(self.waypoints.first());
        let end = self.basis.control_points().saturating_sub(at_end + velocity_at(self.waypoints.last()));
        for (waypoint, number) in self.inner_waypoints().iter().zip(self.first_number + 1..) {
            let conditions = usize::from(waypoint.tolerance_m == 0.0) + usize::from(waypoint.velocity_m_s.is_some());
            for _ in 0..conditions {
                let (first, weights) = self.basis.derivative_at(0, waypoint.time_s);
                let mut candidates = (first.max(free)..first + weights.len()).filter(|j| weights[j - first] > 1e-12);
                match candidates.next() {
                    Some(j) if j < end => free = j + 1,
                    _ => {
                        // After a stop by its number alone: a leg's clock begins at its own start, which is not the file's.
                        let time_s = (self.first_number == 1).then_some(waypoint.time_s);
                        let waypoint = WaypointName { number, time_s };
                        return Err(PlanError::TooFewSpans { waypoint, spans: self.spans() });
                    }
                }
            }
        }
        Ok(())
    }
}
