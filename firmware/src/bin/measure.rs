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
    use quatrack::nalgebra::Vector3;
    use quatrack::{
        Command, Limits, Piece, Player, Quaternion, Rate, Reference, ReferenceError, State, Step, StepError, Tick,
        Tracker, Trajectory,
    };
    use quatrack_firmware::control::{self, CommandSink, StateSource, TickError};
    use quatrack_firmware::counter::Counter;
    use quatrack_firmware::semihosting::{File, Mode, exit};
    use quatrack_firmware::{laws, stored};
    use stm32f4::stm32f405::Peripherals;

    /// Control steps a second.
    const RATE_HZ: u32 = 500;

    /// Rounds of `delay`, a loop of two instructions: the costs differ by 2000, however long call and return are.
    const LOOPS: [u32; 2] = [100, 1100];

    #[entry]
    fn main() -> ! {
        exit(run().is_some())
    }

    fn run() -> Option<()> {
        let peripherals = Peripherals::take()?;
        let counter = Counter::start(peripherals.TIM2, &peripherals.RCC);
        let mut states = File::open(c"states.bin", Mode::Read)?;
        let mut counts = File::open(c"counts.bin", Mode::Write)?;
        let overhead = overhead(&counter);
        let loops = LOOPS.map(|rounds| {
            let start = counter.now();
            spin(rounds);
            counter.now().wrapping_sub(start).wrapping_sub(overhead)
        });
        write_words(&mut counts, [overhead, loops[0], loops[1]])?;
        while let Some(header) = read_words::<3>(&mut states) {
            fly(&counter, overhead, header, &mut states, &mut counts)?;
        }
        Some(())
    }

    /// Out of line, so that both loops are the same one, with the same padding before it.
    #[inline(never)]
    fn spin(rounds: u32) {
        cortex_m::asm::delay(rounds);
    }

    /// What a pair of readings costs by itself.
    fn overhead(counter: &Counter) -> u32 {
        let start = counter.now();
        counter.now().wrapping_sub(start)
    }

    fn fly(counter: &Counter, overhead: u32, header: [u32; 3], states: &mut File, counts: &mut File) -> Option<()> {
        let [course, controller, steps] = header;
        let pieces: &[Piece] = if course == 0 { &stored::MILD } else { &stored::AGGRESSIVE };
        let trajectory = Trajectory::new(pieces).ok()?;
        let tracker = black_box(Tracker::new(laws::by_index(controller as u8)?, Limits::NONE));
        let rate = Rate::from_hz(RATE_HZ)?;
        let (mut alone, mut player) = (Player::new(trajectory, rate), Player::new(trajectory, rate));
        let mut slot = Slot { state: None, command: Command::ZERO };
        for tick in 0..steps {
            let state = black_box(state(read_words::<10>(states)?.map(f32::from_bits)));
            slot.state = Some(state);

            let start = counter.now();
            let reference = reference(&mut alone, tick);
            let of_reference = counter.now().wrapping_sub(start).wrapping_sub(overhead);
            let reference = black_box(reference.ok()?);

            let start = counter.now();
            let step = law(&tracker, &state, &reference);
            let of_law = counter.now().wrapping_sub(start).wrapping_sub(overhead);
            let step = black_box(step.ok()?);

            let start = counter.now();
            let whole = whole(tick, &tracker, &mut slot, &mut player);
            let of_tick = counter.now().wrapping_sub(start).wrapping_sub(overhead);
            if black_box(whole) != Ok(step) {
                return None;
            }

            let Command { thrust_m_s2: thrust, body_rates_rad_s: rates } = slot.command;
            let [thrust, p, q, r] = [thrust, rates.x, rates.y, rates.z].map(f32::to_bits);
            write_words(counts, [of_reference, of_law, of_tick, thrust, p, q, r])?;
        }
        Some(())
    }

    /// On-board reference: polynomial to jerk, and the flat map.
    #[inline(never)]
    fn reference(player: &mut Player<'_>, tick: Tick) -> Result<Reference, ReferenceError> {
        Reference::from_flat(&player.at(tick))
    }

    /// One step of the law with validation, sign handling and saturation.
    #[inline(never)]
    fn law(tracker: &Tracker<'_>, state: &State, reference: &Reference) -> Result<Step, StepError> {
        tracker.step(state, reference)
    }

    /// What the timer's interrupt runs.
    #[inline(never)]
    fn whole(tick: Tick, tracker: &Tracker<'_>, slot: &mut Slot, player: &mut Player<'_>) -> Result<Step, TickError> {
        let mut commands = Commands(&mut slot.command);
        control::tick(tick, tracker, &mut States(&slot.state), player, &mut commands)
    }

    struct Slot {
        state: Option<State>,
        command: Command,
    }

    struct States<'a>(&'a Option<State>);

    impl StateSource for States<'_> {
        fn newest(&mut self) -> Option<State> {
            *self.0
        }
    }

    struct Commands<'a>(&'a mut Command);

    impl CommandSink for Commands<'_> {
        fn put(&mut self, command: &Command) {
            *self.0 = *command;
        }
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
