//! Control points as a file writes them in; a B-spline, or the pieces of several, out.

use nalgebra::Vector3;
use serde::Deserialize;

use super::{FileError, TrajectoryFile};
use crate::trajectory::bspline::BSpline;
use crate::trajectory::polynomial::PiecewisePolynomial;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ControlPoints {
    /// The schema that `quatrack plan` writes before the rest.
    #[serde(default)]
    #[expect(dead_code, reason = "a file may state its schema")]
    schema: Option<String>,
    degree: usize,
    duration_s: f64,
    control_points_m: Vec<[f64; 3]>,
    heading_control_points_rad: Option<Vec<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Curves {
    /// As of [`ControlPoints`].
    #[serde(default)]
    #[expect(dead_code, reason = "a file may state its schema")]
    schema: Option<String>,
    curves: Vec<ControlPoints>,
}

pub(super) fn spline(name: &str, points: ControlPoints) -> Result<TrajectoryFile, FileError> {
    one_spline(name, points).map(TrajectoryFile::Spline)
}

pub(super) fn one_spline(name: &str, points: ControlPoints) -> Result<BSpline, FileError> {
    let control_points_m = points.control_points_m.into_iter().map(Vector3::from).collect();
    let spline = BSpline::new(points.degree, points.duration_s, control_points_m);
    let spline = match points.heading_control_points_rad {
        Some(heading) => spline.and_then(|spline| spline.with_heading(heading)),
        None => spline,
    };
    spline.map_err(|reason| FileError::Spline { name: name.into(), reason })
}

/// Curves one after the other, as pieces.
pub(super) fn curves(name: &str, Curves { curves, .. }: Curves) -> Result<TrajectoryFile, FileError> {
    let mut pieces = Vec::new();
    let wrong = |reason| FileError::Curves { name: name.into(), reason };
    for points in curves {
        let of_curve = PiecewisePolynomial::from_bspline(&one_spline(name, points)?).map_err(wrong)?;
        pieces.extend_from_slice(of_curve.pieces());
    }
    PiecewisePolynomial::new(pieces).map(TrajectoryFile::Pieces).map_err(wrong)
}
