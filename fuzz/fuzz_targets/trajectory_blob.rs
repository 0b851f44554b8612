//! Any bytes into the trajectory loader: a trajectory that comes out plays to its end, every reference flyable or
//! refused.
#![no_main]

use libfuzzer_sys::fuzz_target;
use quatrack::link::{TRAJECTORY_PIECES, TrajectoryStore};
use quatrack::{Player, Rate};

fuzz_target!(|bytes: &[u8]| {
    let mut store = TrajectoryStore::<TRAJECTORY_PIECES>::new();
    let committed = store.commit(bytes).is_ok();
    let trajectory = store.active().trajectory();
    assert_eq!(trajectory.is_some(), committed, "in use if and only if it is sound");
    let (Some(trajectory), Some(rate)) = (trajectory, Rate::from_hz(100)) else { return };
    let mut player = Player::new(trajectory, rate);
    let end = player.end_tick();
    for tick in (0..=end).step_by(1 + end as usize / 50) {
        // An error is an answer; a panic is not.
        let _ = player.reference(tick);
    }
});
