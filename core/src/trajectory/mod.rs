//! Stored trajectories: polynomial pieces and a tick in, the flat output to jerk out, or to its fifth derivative.
//!
//! A [`Trajectory`] is pieces that have been checked; a [`Player`] walks along them at a fixed rate. Time is the tick:
//! the time within a piece is found by integers, in nanoseconds, and only then becomes an `f32`.

mod checked;
mod error;
mod piece;
mod player;
mod polynomial;

#[cfg(feature = "link")]
pub(crate) use checked::Summary;
pub use checked::{MAX_DURATION_NS, Trajectory};
pub use error::TrajectoryError;
pub use piece::{MAX_HEADING_JUMP_RAD, MAX_JUMP_M, Piece};
pub use player::{Bookmark, Player, Progress};
pub use polynomial::Coefficients;
