//! A trajectory by name or file in; the pieces that a board flies, moved, turned, scaled or slowed as asked, out.

use std::path::Path;

use quatrack_plan::plan;
use quatrack_plan::trajectory::bspline::BSpline;
use quatrack_plan::trajectory::file::{self, TrajectoryFile};
use quatrack_plan::trajectory::on_board::OnBoardError;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;

use super::Args;
use crate::cli::transform::TransformArgs;
use crate::cli::{Failure, output};

/// The trajectory by name or from a file, as the pieces that the board flies; and the folder for the log.
pub(super) fn load(args: &Args) -> Result<PiecewisePolynomial, Failure> {
    let trajectory = transformed(&args.trajectory, &args.transform)?;
    args.out.as_deref().map_or(Ok(()), output::create_dir)?;
    Ok(trajectory)
}

/// The same flown slower, backwards, elsewhere, turned or larger.
pub(in crate::cli) fn transformed(name: &str, args: &TransformArgs) -> Result<PiecewisePolynomial, Failure> {
    let transform = args.transform()?;
    transform.apply(&trajectory(name)?).map_err(|error| Failure::input(format!("{name}: {error}")))
}

/// A trajectory by name or from a file, as the pieces that the board flies.
pub(in crate::cli) fn trajectory(name: &str) -> Result<PiecewisePolynomial, Failure> {
    let from_spline = |spline: &BSpline| {
        PiecewisePolynomial::from_bspline(spline).map_err(|error| Failure::input(format!("{name}: {error}")))
    };
    let planned = |text: &str| {
        let flight = crate::cli::plan::of_text(Path::new(name), text)?;
        flight.pieces().map_err(|error| Failure::input(format!("{name}: {error}")))
    };
    match name {
        "mild" => planned(plan::paper::MILD_TOML),
        "aggressive" => planned(plan::paper::AGGRESSIVE_TOML),
        path => match file::read(Path::new(path)).map_err(Failure::input)? {
            TrajectoryFile::Pieces(pieces) => Ok(pieces),
            TrajectoryFile::Spline(spline) => from_spline(&spline),
            TrajectoryFile::Plan(text) => planned(&text),
        },
    }
}

/// Names the fault for which a board does not fly it; a start elsewhere is one way on.
pub(in crate::cli) fn not_on_board(name: &str, error: &OnBoardError) -> Failure {
    let how = if matches!(error, OnBoardError::Coarse { .. }) { " by --start 0,0,0" } else { "" };
    Failure::input(format!("{name}: {error}{how}"))
}
