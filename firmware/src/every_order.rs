// Every order to a flight, for the images that are linked to measure their size. Each of them includes it.
mod image {
    use core::hint::black_box;

    use cortex_m_rt::entry;
    #[cfg(feature = "motors")]
    use quatrack::link::RigidStateIn;
    use quatrack::link::{LawChoice, LimitsSetting, StateIn};
    use quatrack::{FlatSample, Piece, Player, Trajectory};
    use quatrack_firmware::counter::Counter;
    use quatrack_firmware::craft::NoCraft;
    use quatrack_firmware::flight::{CONFIG, Flight, Store, TICK_RATE};
    use quatrack_firmware::tick;
    use quatrack_firmware::timing::Timing;
    use stm32f4::stm32f405::Peripherals;

    #[entry]
    fn main() -> ! {
        static mut STORE: Store = Store::new();
        let _ = control(STORE);
        loop {
            cortex_m::asm::wfi();
        }
    }

    /// Every order there is, with values that the compiler does not know.
    fn control(store: &'static mut Store) -> Option<()> {
        let peripherals = Peripherals::take()?;
        let counter = Counter::start(peripherals.TIM5, &peripherals.RCC);
        let timing = Timing::new(black_box(1));
        let mut flight = Flight::new(store, black_box(None));
        loop {
            let now = timing.now();
            match black_box(0_u8) {
                0 => flight.accept(black_box::<Option<StateIn>>(None)?, now),
                1 => flight.playback.follow(black_box::<Option<FlatSample>>(None)?),
                2 => flight
                    .playback
                    .start(Player::new(Trajectory::new(black_box::<&'static [Piece]>(&[])).ok()?, TICK_RATE)),
                3 => _ = flight.playback.pause(),
                4 => _ = flight.playback.resume(),
                5 => flight.playback.stop(),
                6 => _ = flight.playback.start_uploaded(),
                7 => _ = flight.select(black_box::<Option<LawChoice>>(None)?),
                8 => _ = flight.set_limits(black_box::<Option<LimitsSetting>>(None)?),
                9 => _ = flight.arm(now),
                10 => flight.disarm(),
                11 => flight.hear(now),
                12 => flight.set_decimation(black_box(0)),
                13 => flight.config = black_box(CONFIG),
                14 => _ = black_box(flight.take_answer()),
                15 => _ = black_box(timing.on_timer(counter.now())),
                #[cfg(feature = "motors")]
                16 => flight.accept_rigid(black_box::<Option<RigidStateIn>>(None)?, now),
                #[cfg(feature = "motors")]
                17 => _ = flight.set_bandwidth(black_box([1.0; 3])),
                _ => tick::control(&mut flight, &timing, counter, &mut NoCraft),
            }
            black_box((flight.command(), flight.forces_n()));
        }
    }
}
