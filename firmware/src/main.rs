//! The image that flies.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;

    use quatrack::{Limits, Player, Rate, State, Trajectory};
    use quatrack_firmware as _;
    use quatrack_firmware::{control, laws, stored};

    struct Slot;
    impl control::StateSource for Slot {
        fn newest(&mut self) -> Option<State> {
            black_box(None)
        }
    }
    impl control::CommandSink for Slot {
        fn put(&mut self, command: &quatrack::Command) {
            black_box(command);
        }
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let (Some(law), Some(rate), Ok(trajectory)) =
            (laws::by_index(black_box(0)), Rate::from_hz(500), Trajectory::new(black_box(&stored::MILD)))
        else {
            loop {
                cortex_m::asm::wfi();
            }
        };
        let tracker = quatrack::Tracker::new(law, Limits::NONE);
        let mut player = Player::new(trajectory, rate);
        loop {
            let _ = black_box(control::tick(0, &tracker, &mut Slot, &mut player, &mut Slot));
        }
    }
}

/// On a desk there is nothing to run: the image is built with `cargo firmware`.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is the firmware of an STM32F405; build it with `cargo firmware`");
}
