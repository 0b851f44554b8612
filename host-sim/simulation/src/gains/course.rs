//! The trajectory that gains over time are for: its name in a design in; the pieces that the board stores out.
//!
//! Gains belong to a trajectory by its checksum. One that is planned anew ends with other last digits on another processor,
//! and with them another checksum: the paper's two are taken as they are stored, and a plan is refused.

use std::path::Path;

use quatrack::{Piece, Trajectory};
use quatrack_plan::plan::paper::PaperTrajectory;
use quatrack_plan::plan::stored;
use quatrack_plan::trajectory::Trajectory as _;
use quatrack_plan::trajectory::file::{self, TrajectoryFile};
use quatrack_plan::trajectory::on_board;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use serde::{Serialize, Serializer};

use super::GainsError;

/// At the end it rests: speed, acceleration and jerk are below this, m/s, m/s^2, m/s^3. In f32 coefficients rest is a
/// difference of numbers of some size.
const REST: f64 = 1e-2;

/// A trajectory as a board stores it.
#[derive(Debug, Clone, PartialEq)]
pub struct OnBoardTrajectory {
    trajectory: PiecewisePolynomial,
    checksum: u32,
}

impl OnBoardTrajectory {
    /// `mild` or `aggressive` as they are stored on board, or a file, from a folder, of pieces or control points.
    ///
    /// # Errors
    /// [`GainsError::Value`] for a file that cannot be used, a plan, and a trajectory that does not end at rest.
    pub fn named(written: &str, folder: &Path) -> Result<Self, GainsError> {
        let refused =
            |must: String| GainsError::Value { key: "trajectory".into(), value: format!("\"{written}\""), must };
        let unusable = |reason: &dyn std::fmt::Display| refused(format!("a trajectory that flies ({reason})"));
        let pieces: Vec<Piece> = match written {
            "mild" => stored::pieces(PaperTrajectory::Mild).to_vec(),
            "aggressive" => stored::pieces(PaperTrajectory::Aggressive).to_vec(),
            path => match file::read(&folder.join(path)).map_err(|error| unusable(&error))? {
                TrajectoryFile::Pieces(pieces) => on_board::pieces(&pieces),
                TrajectoryFile::Spline(spline) => {
                    on_board::pieces(&PiecewisePolynomial::from_bspline(&spline).map_err(|error| unusable(&error))?)
                }
                TrajectoryFile::Plan(_) => {
                    return Err(refused(
                        "\"mild\", \"aggressive\", or a file of pieces or control points: a plan ends with other last \
                         digits on another processor, and gains belong to the bits of a trajectory; give the output of \
                         `quatrack plan FILE --toml OUT`"
                            .into(),
                    ));
                }
            },
        };
        let checksum = Trajectory::new(&pieces).map_err(|error| unusable(&error))?.checksum();
        let trajectory = on_board::trajectory(&pieces).map_err(|error| unusable(&error))?;
        let end = trajectory.at(trajectory.duration_s());
        let rests = [end.velocity_m_s, end.acceleration_m_s2, end.jerk_m_s3].iter().all(|rate| rate.norm() < REST);
        if !rests || end.heading_rate_rad_s.abs() >= REST {
            return Err(refused("one that ends at rest: behind it the last gain is flown".into()));
        }
        Ok(Self { trajectory, checksum })
    }

    /// The trajectory, in f64; every number is that of the board.
    pub fn trajectory(&self) -> &PiecewisePolynomial {
        &self.trajectory
    }

    /// [`Trajectory::checksum`] of its pieces on board.
    pub fn checksum(&self) -> u32 {
        self.checksum
    }
}

impl Serialize for OnBoardTrajectory {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&format_args!("{:08x}", self.checksum))
    }
}
