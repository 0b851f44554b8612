//! The control path and nothing else, for its size: states and pieces that somebody else writes in, commands out.
//!
//! Holds the four laws with their tables, the check and the evaluation of trajectories, the tick, and the start-up code;
//! neither trajectories nor drivers nor the link. It is linked, never run.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;

    use cortex_m_rt::entry;
    use quatrack::{Command, Limits, Piece, Player, Rate, State, Tracker, Trajectory};
    use quatrack_firmware::control::{self, CommandSink, StateSource};
    use quatrack_firmware::laws;

    /// Control steps a second.
    const RATE_HZ: u32 = 500;

    /// What the compiler knows nothing about: read and written as if from elsewhere.
    struct Elsewhere;

    impl StateSource for Elsewhere {
        fn newest(&mut self) -> Option<State> {
            black_box(None)
        }
    }

    impl CommandSink for Elsewhere {
        fn put(&mut self, command: &Command) {
            black_box(command);
        }
    }

    #[entry]
    fn main() -> ! {
        loop {
            fly(black_box(&[]), black_box(0));
        }
    }

    fn fly(pieces: &[Piece], law: u8) -> Option<()> {
        let mut player = Player::new(Trajectory::new(pieces).ok()?, Rate::from_hz(RATE_HZ)?);
        let tracker = Tracker::new(laws::by_index(law)?, black_box(Limits::NONE));
        for tick in 0..player.end_tick() {
            let _ = black_box(control::tick(tick, &tracker, &mut Elsewhere, &mut player, &mut Elsewhere));
        }
        Some(())
    }
}

/// On a desk there is nothing to run: `quatrack measure` builds the image and looks at its size.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is an image for an STM32F405; `quatrack measure` builds it for its size");
}
