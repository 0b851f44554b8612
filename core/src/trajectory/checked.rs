//! Checked pieces: pieces in; a trajectory, its length and its checksum out, or the first error in them.

use nalgebra::Vector3;

use super::error::TrajectoryError;
use super::piece::{Piece, Shape};
use crate::checksum::Crc32c;
use crate::reference::FlatSample;

/// Longest trajectory, ns: one hour.
pub const MAX_DURATION_NS: u64 = 3_600_000_000_000;

/// Pieces that have been checked: at least one, positive durations, finite coefficients, no jumps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trajectory<'a> {
    pub(super) first: &'a Piece,
    pub(super) following: &'a [Piece],
    pub(super) summary: Summary,
}

/// The result of the check of pieces. Kept beside pieces that do not change, it spares another check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Summary {
    pub(super) duration_ns: u64,
    pub(super) end: FlatSample,
    pub(super) shape: Shape,
}

impl Summary {
    /// Of no pieces; all zero bytes.
    #[cfg_attr(not(feature = "link"), expect(dead_code, reason = "for trajectories that come over the link"))]
    pub(crate) const EMPTY: Self = Self {
        duration_ns: 0,
        end: FlatSample::at_rest(Vector3::new(0.0, 0.0, 0.0), 0.0),
        shape: Shape { straight: false, quintic: false },
    };
}

impl<'a> Trajectory<'a> {
    /// Checks pieces.
    ///
    /// # Errors
    /// [`TrajectoryError`] names the piece.
    pub fn new(pieces: &'a [Piece]) -> Result<Self, TrajectoryError> {
        let (first, following) = pieces.split_first().ok_or(TrajectoryError::Empty)?;
        let mut duration_ns = 0_u64;
        let mut end = first.start();
        for (index, piece) in pieces.iter().enumerate() {
            if piece.duration_ns == 0 {
                return Err(TrajectoryError::NoDuration { piece: index });
            }
            duration_ns = duration_ns.saturating_add(piece.duration_ns);
            if duration_ns > MAX_DURATION_NS {
                return Err(TrajectoryError::TooLong { piece: index });
            }
            if !piece.is_finite() {
                return Err(TrajectoryError::NonFinite { piece: index });
            }
            if let Some(size) = piece.jump_from(&end) {
                return Err(TrajectoryError::Jump { piece: index, size });
            }
            end = piece.at_leisure(piece.duration_ns);
        }
        let shape = Shape {
            straight: pieces.iter().all(|piece| piece.heading.iter().all(|c| *c == 0.0)),
            quintic: pieces
                .iter()
                .flat_map(|piece| [&piece.x, &piece.y, &piece.z])
                .all(|[.., c6, c7]| *c6 == 0.0 && *c7 == 0.0),
        };
        let end = FlatSample::at_rest(end.position_m, end.heading_rad);
        Ok(Self { first, following, summary: Summary { duration_ns, end, shape } })
    }

    /// Length in time, ns.
    pub fn duration_ns(&self) -> u64 {
        self.summary.duration_ns
    }

    /// CRC-32C of the pieces, one after the other: duration in ns (`u64`), then the coefficients of x, y, z and heading
    /// (`f32`, ascending powers), lowest byte first. It tells one trajectory from another: gains over time name theirs by
    /// it. Goes over every byte: once a flight, not once a step.
    #[cold]
    pub fn checksum(&self) -> u32 {
        let mut crc = Crc32c::new();
        for piece in core::iter::once(self.first).chain(self.following) {
            piece.duration_ns.to_le_bytes().into_iter().for_each(|byte| crc.update(byte));
            let coefficients = [&piece.x, &piece.y, &piece.z, &piece.heading].into_iter().flatten();
            coefficients.flat_map(|c| c.to_le_bytes()).for_each(|byte| crc.update(byte));
        }
        crc.value()
    }

    /// The result of the check.
    #[cfg_attr(not(feature = "link"), expect(dead_code, reason = "for trajectories that come over the link"))]
    pub(crate) fn summary(&self) -> Summary {
        self.summary
    }

    /// The same pieces again, with the result of their check.
    #[cfg_attr(not(feature = "link"), expect(dead_code, reason = "for trajectories that come over the link"))]
    pub(crate) fn of_checked(pieces: &'a [Piece], summary: Summary) -> Option<Self> {
        let (first, following) = pieces.split_first()?;
        Some(Self { first, following, summary })
    }
}
