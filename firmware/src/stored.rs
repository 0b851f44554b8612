//! The trajectories in flash: planned offline from `plans/*.toml` and written by `quatrack plan --rust`.

use quatrack::Piece;

include!("../../plans/mild.rs");
include!("../../plans/aggressive.rs");
