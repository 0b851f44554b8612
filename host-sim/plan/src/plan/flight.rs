//! A flight: curves from stop to stop, each planned on its own.

use super::budget::Budget;
use super::detour::{self, Detour};
use super::diagnosis::diagnose;
use super::{BSpline, Overrides, Plan, PlanError, Realised, file, heading};
use crate::trajectory::polynomial::{PiecewisePolynomial, PolynomialError};

/// The flight of a plan file, with all times known.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightPlan {
    /// The curves, at least one.
    pub(super) legs: Vec<Plan>,
    /// Whether the times were found from the bounds.
    pub(super) free: bool,
    /// Interpretations of the file beyond its letters.
    pub(super) notes: Vec<String>,
}

/// A curve with its plan and its largest quantities.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedLeg {
    /// The plan.
    pub plan: Plan,
    /// The curve.
    pub curve: BSpline,
    /// Its quantities, at samples and by control points.
    pub realised: Realised,
    /// Whether it is many times as long as its waypoints are apart.
    pub detour: Option<Detour>,
}

/// A planned flight.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedFlight {
    /// From stop to stop; at least one.
    pub legs: Vec<PlannedLeg>,
}

impl FlightPlan {
    /// Reads a plan from TOML, or rows of waypoints ([`crate::trajectory::waypoints`]). Where no times are given, the least
    /// within the bounds are found.
    ///
    /// # Errors
    /// [`PlanError`] names the key or waypoint, its value and its range.
    pub fn from_toml(text: &str, over: &Overrides<'_>, budget: &Budget<'_>) -> Result<Self, PlanError> {
        file::read(text, over, budget)
    }

    /// Plans every curve.
    ///
    /// # Errors
    /// [`PlanError::Infeasible`] with the bounds that are too tight, [`PlanError::HeadingRate`], [`PlanError::NotConverged`] or
    /// [`PlanError::TimeLimit`].
    pub fn solve(&self, budget: &Budget<'_>) -> Result<PlannedFlight, PlanError> {
        let mut legs = Vec::with_capacity(self.legs.len());
        for plan in &self.legs {
            budget.say("planning");
            let curve = plan.curve_within(budget).map_err(|reason| diagnose(&self.legs, &reason, budget))?;
            let curve = match heading::planned(plan, curve, budget) {
                Err(PlanError::HeadingRate { .. }) => return Err(heading::refused(&self.legs, budget)?),
                planned => planned?,
            };
            legs.push(PlannedLeg {
                realised: plan.realised(&curve),
                detour: detour::of(plan, &curve, budget),
                plan: plan.clone(),
                curve,
            });
        }
        Ok(PlannedFlight { legs })
    }

    /// The plans from stop to stop.
    pub fn legs(&self) -> &[Plan] {
        &self.legs
    }

    /// Whether the times were found from the bounds.
    pub fn has_free_times(&self) -> bool {
        self.free
    }

    /// Interpretations of the file beyond its letters: one line each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The plan of the only curve.
    pub(super) fn into_one(mut self) -> Result<Plan, PlanError> {
        match (self.legs.pop(), self.legs.is_empty()) {
            (Some(plan), true) => Ok(plan),
            _ => Err(PlanError::SeveralCurves),
        }
    }
}

impl PlannedFlight {
    /// Length in time, s.
    pub fn duration_s(&self) -> f64 {
        self.legs.iter().map(|leg| leg.plan.duration_s()).sum()
    }

    /// The flight as polynomial pieces.
    ///
    /// # Errors
    /// [`PolynomialError`] if a coefficient overflows.
    pub fn pieces(&self) -> Result<PiecewisePolynomial, PolynomialError> {
        if let [leg] = self.legs.as_slice() {
            return PiecewisePolynomial::from_bspline(&leg.curve);
        }
        let mut pieces = Vec::new();
        for leg in &self.legs {
            pieces.extend_from_slice(PiecewisePolynomial::from_bspline(&leg.curve)?.pieces());
        }
        PiecewisePolynomial::joined(pieces)
    }
}
