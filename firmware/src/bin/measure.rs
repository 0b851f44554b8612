//! Counts instructions: recorded states in, from a file of the host; per step, counts and the command out, to another.
//!
//! Both files are in the folder in which the emulator runs, all numbers little-endian, 32 bits.
//! `states.bin`: for each flight, course (0 mild, 1 aggressive), controller, number of steps; then ten floats a step.
//! `counts.bin`: cost of reading the counter, counts of two loops of known length; then, for each step of each flight,
//! counts of reference, law and tick, and the four floats of the command.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;

    use cortex_m_rt::entry;
    use quatrack::link::{LawChoice, LimitsSetting, StateIn, Table, TrajectoryId};
    use quatrack::nalgebra::Vector3;
    use quatrack::{
        Command, ErrorForm, Piece, Player, Quaternion, Reference, ReferenceError, State, Step, StepError, Tick,
        Tracker, Trajectory,
    };
    use quatrack_firmware::counter::Counter;
    use quatrack_firmware::flight::{DECIMATION as TICKS_PER_STEP, Flight, TICK_RATE};
    use quatrack_firmware::playback::Store;
    use quatrack_firmware::semihosting::{File, Mode, exit};
    use quatrack_firmware::timing::Timing;
    use quatrack_firmware::{stored, tick};
    use stm32f4::stm32f405::Peripherals;

    /// The whole range of f32, as in the reproduction of the paper.
    const NO_LIMITS: LimitsSetting =
        LimitsSetting { thrust_min_m_s2: f32::MIN, thrust_max_m_s2: f32::MAX, body_rates_max_rad_s: [f32::MAX; 3] };

    /// Rounds of `delay`, a loop of two instructions: the costs differ by 2000, however long call and return are.
    const LOOPS: [u32; 2] = [100, 1100];

    #[entry]
    fn main() -> ! {
        static mut STORE: Store = Store::new();
        exit(run(STORE).is_some())
    }

    fn run(store: &'static mut Store) -> Option<()> {
        let peripherals = Peripherals::take()?;
        let counter = Counter::start(peripherals.TIM5, &peripherals.RCC);
        let mut states = File::open(c"states.bin", Mode::Read)?;
        let mut counts = File::open(c"counts.bin", Mode::Write)?;
        let overhead = overhead(counter);
        let loops = LOOPS.map(|rounds| {
            let start = counter.now();
            spin(rounds);
            counter.now().wrapping_sub(start).wrapping_sub(overhead)
        });
        write_words(&mut counts, [overhead, loops[0], loops[1]])?;
        let mut bench = Bench { counter, overhead, timing: Timing::new(1), flight: Flight::new(store, None) };
        bench.timing.set_decimation(1);
        bench.flight.set_limits(NO_LIMITS).ok()?;
        while let Some(header) = read_words::<3>(&mut states) {
            bench.fly(header, &mut states, &mut counts)?;
        }
        Some(())
    }

    /// What is measured and what with.
    struct Bench {
        counter: Counter,
        overhead: u32,
        timing: Timing,
        flight: Flight,
    }

    /// Out of line, so that both loops are the same one, with the same padding before it.
    #[inline(never)]
    fn spin(rounds: u32) {
        cortex_m::asm::delay(rounds);
    }

    /// What a pair of readings costs by itself.
    fn overhead(counter: Counter) -> u32 {
        let start = counter.now();
        counter.now().wrapping_sub(start)
    }

    impl Bench {
        fn fly(&mut self, header: [u32; 3], states: &mut File, counts: &mut File) -> Option<()> {
            let [course, controller, steps] = header;
            let (id, pieces): (_, &[Piece]) = match course {
                0 => (TrajectoryId::Mild, &stored::MILD),
                _ => (TrajectoryId::Aggressive, &stored::AGGRESSIVE),
            };
            let table = [Table::LyapF, Table::LyapE, Table::LqrF, Table::LqrE].get(controller as usize).copied()?;
            let law = LawChoice { error_form: ErrorForm::Paper, ..LawChoice::new(table) };
            let tracker = black_box(Tracker::new(law.built_in()?, NO_LIMITS.check().ok()?));
            let mut player = Player::new(Trajectory::new(pieces).ok()?, TICK_RATE);
            self.flight.disarm();
            self.flight.select(law).then_some(())?;
            self.flight.playback.start(stored::player(id)?);
            self.flight.hear(self.timing.now());
            self.flight.arm(self.timing.now()).ok()?;
            for step in 0..steps {
                let state = black_box(state(read_words::<10>(states)?.map(f32::from_bits)));
                let tick = step * TICKS_PER_STEP;

                let start = self.counter.now();
                let reference = reference(&mut player, tick);
                let of_reference = self.since(start);
                let reference = black_box(reference.ok()?);

                let start = self.counter.now();
                let expected = law_step(&tracker, &state, &reference);
                let of_law = self.since(start);
                let expected = black_box(expected.ok()?);

                // Ticks between two steps, which only count.
                (1..TICKS_PER_STEP).for_each(|_| self.pass());
                self.flight.hear(self.timing.now());
                self.flight.accept(StateIn { tick, state }, self.timing.now());
                self.timing.on_timer(self.counter.now());
                let start = self.counter.now();
                control(&mut self.flight, &self.timing, self.counter);
                let of_tick = self.since(start);
                let answer = self.flight.take_answer()?;
                if answer.result != Ok(expected) {
                    return None;
                }

                let Command { thrust_m_s2: thrust, body_rates_rad_s: rates } = self.flight.command();
                let [thrust, p, q, r] = [*thrust, rates.x, rates.y, rates.z].map(f32::to_bits);
                write_words(counts, [of_reference, of_law, of_tick, thrust, p, q, r])?;
            }
            Some(())
        }

        fn since(&self, start: u32) -> u32 {
            self.counter.now().wrapping_sub(start).wrapping_sub(self.overhead)
        }

        /// A tick on which no step is due.
        fn pass(&self) {
            self.timing.set_decimation(u32::MAX);
            self.timing.on_timer(self.counter.now());
            self.timing.set_decimation(1);
        }
    }

    /// What the control interrupt runs.
    #[inline(never)]
    fn control(flight: &mut Flight, timing: &Timing, counter: Counter) {
        tick::control(flight, timing, counter);
    }

    /// On-board reference: polynomial to jerk, and the flat map.
    #[inline(never)]
    fn reference(player: &mut Player<'_>, tick: Tick) -> Result<Reference, ReferenceError> {
        player.reference(tick)
    }

    /// One step of the law with validation, sign handling and saturation.
    #[inline(never)]
    fn law_step(tracker: &Tracker<'_>, state: &State, reference: &Reference) -> Result<Step, StepError> {
        tracker.step(state, reference)
    }

    fn state([x, y, z, q0, q1, q2, q3, vx, vy, vz]: [f32; 10]) -> State {
        State {
            position_m: Vector3::new(x, y, z),
            attitude: Quaternion::new(q0, q1, q2, q3),
            velocity_m_s: Vector3::new(vx, vy, vz),
        }
    }

    fn read_words<const N: usize>(file: &mut File) -> Option<[u32; N]> {
        let mut bytes = [[0_u8; 4]; N];
        let flat = bytes.as_flattened_mut();
        let whole = flat.len();
        (file.read(flat) == whole).then(|| bytes.map(u32::from_le_bytes))
    }

    fn write_words<const N: usize>(file: &mut File, words: [u32; N]) -> Option<()> {
        file.write(words.map(u32::to_le_bytes).as_flattened()).then_some(())
    }
}

/// On a desk there is nothing to run: `quatrack measure` builds the image and starts it.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is an image for an emulated STM32F405; run it with `quatrack measure`");
}
