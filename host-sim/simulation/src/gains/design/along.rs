//! A design of gains over time: its entries in; weights, trajectory and knots out.

use std::path::Path;

use quatrack::Rate;
use quatrack::gains::table::KNOTS_MAX;
use quatrack_plan::trajectory::Trajectory as _;

use super::entry::{misplaced, missing};
use super::problem::Problem;
use super::weights::equilibrium_weights;
use crate::gains::file::{DesignFile, Linearisation, Weights};
use crate::gains::{GainsError, OnBoardTrajectory};

/// As many knots as a table holds.
pub(super) fn along(file: &DesignFile, weights: &Weights, folder: &Path, rate: Rate) -> Result<Problem, GainsError> {
    if file.linearisation == Linearisation::FlatOutput {
        return Err(misplaced("method", &file.method.quoted(), &file.linearisation));
    }
    let weights = equilibrium_weights(weights)?;
    if let Some(weight) = weights.state.iter().find(|weight| **weight <= 0.0) {
        let must = "above 0 for each error with method = \"along\": an error without a cost need not decrease";
        return Err(GainsError::Value { key: "weights".into(), value: weight.to_string(), must: must.into() });
    }
    let written = file
        .trajectory
        .as_ref()
        .ok_or_else(|| missing("trajectory", &file.method, "trajectory = \"aggressive\", or the path of a file"))?;
    let trajectory = OnBoardTrajectory::named(written, folder)?;
    let steps = (trajectory.trajectory().duration_s() * f64::from(rate.hz())).ceil();
    let steps_per_knot = (steps / (KNOTS_MAX - 1) as f64).ceil().max(1.0);
    if steps_per_knot > f64::from(u16::MAX) {
        return Err(GainsError::Value {
            key: "trajectory".into(),
            value: format!("\"{written}\""),
            must: format!("shorter than {} control steps", u32::from(u16::MAX) * (KNOTS_MAX as u32 - 1)),
        });
    }
    Ok(Problem::Along { weights, trajectory, steps_per_knot: steps_per_knot as u16 })
}
