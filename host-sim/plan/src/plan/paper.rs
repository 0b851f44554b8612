//! The two flights of the paper: nothing in, their plans out. The plan files are part of the program.

use serde::Serialize;

use super::{Plan, PlanError};

/// The paper's trajectories.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PaperTrajectory {
    /// 30 s through eight waypoints.
    Mild,
    /// The letter W in 12 s.
    Aggressive,
}

/// Text of `plans/mild.toml`.
pub const MILD_TOML: &str = include_str!("../../plans/mild.toml");
/// Text of `plans/aggressive.toml`.
pub const AGGRESSIVE_TOML: &str = include_str!("../../plans/aggressive.toml");

/// The mild flight, 30 s: Example 1 of the paper's reference \[10\].
///
/// # Errors
/// None with the file as it is; [`PlanError`] if it was edited out of range.
pub fn mild() -> Result<Plan, PlanError> {
    Plan::from_toml(MILD_TOML)
}

/// The aggressive flight, 12 s: the letter W.
///
/// # Errors
/// None with the file as it is; [`PlanError`] if it was edited out of range.
pub fn aggressive() -> Result<Plan, PlanError> {
    Plan::from_toml(AGGRESSIVE_TOML)
}
