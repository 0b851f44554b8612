//! The trajectories in flash: planned offline from `plans/*.toml` and written by `quatrack plan --rust`.

use quatrack::link::TrajectoryId;
use quatrack::{Piece, Player, Trajectory};

use crate::rates::TICK_RATE;

include!("../../plans/mild.rs");
include!("../../plans/aggressive.rs");

/// A player of a trajectory in flash; nothing for the one that is not there.
pub fn player(id: TrajectoryId) -> Option<Player<'static>> {
    let pieces: &[Piece] = match id {
        TrajectoryId::Mild => &MILD,
        TrajectoryId::Aggressive => &AGGRESSIVE,
        TrajectoryId::Uploaded => return None,
    };
    Some(Player::new(Trajectory::new(pieces).ok()?, TICK_RATE))
}
