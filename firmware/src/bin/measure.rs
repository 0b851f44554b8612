//! Counts instructions: recorded states in, from a file of the host; per step, counts and the command out, to another.
//!
//! Both files are in the folder in which the emulator runs, all numbers little-endian, 32 bits.
//!
//! `states.bin`: the rows of a dense gain; three limits (least and most thrust, rates); then, for each flight, course
//! (0 mild, 1 aggressive), controller (4 is the dense gain), whether it is flown at its worst, number of steps; then ten
//! floats a step.
//!
//! `counts.bin`: cost of reading the counter, counts of two loops of known length; then, for each step of each flight,
//! counts of the reference, of the law (least, sum, most) and of the tick, the four floats of the tick's command, and a hash
//! of all commands of the law.
//!
//! As recorded, the law is the paper's, within the first limits. At its worst it has every form that costs more: errors in
//! the heading frame of a reference that turns, without feed-forward and with it, within each of the limits, the measured
//! quaternion of either sign. The tick is then that of the stored trajectory, which does not turn, with feed-forward
//! within the last limits.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;

    use cortex_m_rt::entry;
    use quatrack::law::EquilibriumGain;
    use quatrack::link::{LawChoice, LimitsSetting, StateIn, Table, TrajectoryId};
    use quatrack::nalgebra::Vector3;
    use quatrack::{
        Command, Controller, Equilibrium, ErrorForm, FeedForward, Leash, Measured, Memory, Piece, Player, Quaternion,
        Reference, ReferenceError, State, Step, Target, Tick, Trajectory,
    };
    use quatrack_firmware::counter::Counter;
    use quatrack_firmware::craft::NoCraft;
    use quatrack_firmware::flight::{DECIMATION as TICKS_PER_STEP, Flight, Store, TICK_RATE};
    use quatrack_firmware::semihosting::{File, Mode, exit};
    use quatrack_firmware::timing::Timing;
    use quatrack_firmware::{stored, tick};
    use stm32f4::stm32f405::Peripherals;

    /// Rounds of `delay`, a loop of two instructions: the costs differ by 2000, however long call and return are.
    const LOOPS: [u32; 2] = [100, 1100];

    /// Heading at the start of a turning course and its rate, rad and rad/s.
    const TURN: [f32; 2] = [0.3, 0.5];

    #[entry]
    fn main() -> ! {
        static mut STORE: Store = Store::new();
        // Too large for the stack.
        static mut MILD: [Piece; stored::MILD.len()] = stored::MILD;
        static mut AGGRESSIVE: [Piece; stored::AGGRESSIVE.len()] = stored::AGGRESSIVE;
        exit(run(STORE, [MILD, AGGRESSIVE]).is_some())
    }

    fn run(store: &'static mut Store, turning: [&'static mut [Piece]; 2]) -> Option<()> {
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
        let turning = turning.map(|pieces| turn(pieces, TURN));
        let mut rows = [[0.0; 9]; 4];
        for row in &mut rows {
            *row = read_words(&mut states)?.map(f32::from_bits);
        }
        let dense = EquilibriumGain::new(rows).ok()?;
        let limits = [setting(&mut states)?, setting(&mut states)?, setting(&mut states)?];
        let mut flight = Flight::new(store, None);
        // The dearest steps are limited, all of them.
        flight.config.saturation_max_ticks = Tick::MAX;
        // As in the paper: the law by itself has no leash.
        flight.leash = Leash::NONE;
        let mut bench = Bench { counter, overhead, timing: Timing::new(1), flight, dense, limits, states, counts };
        bench.timing.set_decimation(1);
        while let Some([course, controller, is_worst, steps]) = read_words(&mut bench.states) {
            let (id, stored, turning): (_, &[Piece], _) = match (course, turning) {
                (0, [mild, _]) => (TrajectoryId::Mild, &stored::MILD, mild),
                (_, [_, aggressive]) => (TrajectoryId::Aggressive, &stored::AGGRESSIVE, aggressive),
            };
            let course = Course { id, stored: Trajectory::new(stored).ok()?, turning: Trajectory::new(turning).ok()? };
            let table = [Table::LyapF, Table::LyapE, Table::LqrF, Table::LqrE].get(controller as usize).copied();
            match (is_worst, table) {
                (0, Some(table)) => bench.fly_recorded(&course, table, steps)?,
                _ => bench.fly_worst(&course, table, steps)?,
            }
        }
        Some(())
    }

    /// The same pieces with a heading that grows all the while, from a start at a rate.
    fn turn(pieces: &'static mut [Piece], [mut heading, rate]: [f32; 2]) -> &'static [Piece] {
        for piece in &mut *pieces {
            piece.heading = [heading, rate, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            heading += rate * (piece.duration_ns as f32 * 1e-9);
        }
        pieces
    }

    /// A trajectory as the board has it and as it turns.
    struct Course {
        id: TrajectoryId,
        stored: Trajectory<'static>,
        turning: Trajectory<'static>,
    }

    /// The counter, the recorded flights and the controllers that are counted.
    struct Bench {
        counter: Counter,
        overhead: u32,
        timing: Timing,
        flight: Flight,
        dense: EquilibriumGain,
        limits: [LimitsSetting; 3],
        states: File,
        counts: File,
    }

    /// Out of line, so that both loops are the same one, with the same padding before it.
    #[inline(never)]
    fn spin(rounds: u32) {
        cortex_m::asm::delay(rounds);
    }

    /// Counts that a pair of readings takes by itself.
    fn overhead(counter: Counter) -> u32 {
        let start = counter.now();
        counter.now().wrapping_sub(start)
    }

    /// Counts of calls, and a hash of their results.
    #[derive(Clone, Copy)]
    struct Calls {
        least: u32,
        sum: u32,
        most: u32,
        hash: u32,
    }

    impl Calls {
        const NONE: Self = Self { least: u32::MAX, sum: 0, most: 0, hash: 0x811c_9dc5 };

        fn add(&mut self, count: u32) {
            self.least = self.least.min(count);
            self.sum = self.sum.wrapping_add(count);
            self.most = self.most.max(count);
        }
    }

    /// A hash carried on.
    fn hashed<const N: usize>(hash: u32, words: [u32; N]) -> u32 {
        words.iter().fold(hash, |hash, word| (hash ^ word).wrapping_mul(0x0100_0193))
    }

    impl Bench {
        /// The paper's law on the stored trajectory, as on the host.
        fn fly_recorded(&mut self, course: &Course, table: Table, steps: u32) -> Option<()> {
            let law = LawChoice { error_form: ErrorForm::Paper, ..LawChoice::new(table) };
            let [limits, ..] = self.limits;
            let controller = black_box(Controller::new(law.built_in()?, limits.check().ok()?));
            let mut player = Player::new(course.stored, TICK_RATE);
            self.take_off(course, law, limits)?;
            for step in 0..steps {
                let state = black_box(self.read_state()?);
                let (of_reference, reference) = self.reference(&mut player, step * TICKS_PER_STEP)?;
                let mut calls = Calls::NONE;
                let expected = self.law(&mut calls, &controller, &state, &reference)?;
                let of_tick = self.tick(step, state, &expected)?;
                self.write(of_reference, &calls, of_tick)?;
            }
            Some(())
        }

        /// Everything that costs more; of the dense gain where no table is named.
        fn fly_worst(&mut self, course: &Course, table: Option<Table>, steps: u32) -> Option<()> {
            let [_, _, last] = self.limits;
            if let Some(table) = table {
                self.take_off(course, worst(table), last)?;
            }
            let dense = self.dense;
            let mut stored = Player::new(course.stored, TICK_RATE);
            let mut turning = Player::new(course.turning, TICK_RATE);
            for step in 0..steps {
                let recorded = self.read_state()?;
                let sign = |q: Quaternion| if step % 2 == 0 { q } else { -q };
                let (of_reference, reference) = self.reference(&mut turning, step * TICKS_PER_STEP)?;
                let turned = recorded.attitude * reference.heading().quaternion();
                let state = black_box(State { attitude: sign(turned), ..recorded });
                let mut calls = Calls::NONE;
                for limits in self.limits {
                    for feed_forward in [FeedForward::Without, FeedForward::With] {
                        let law = match table {
                            Some(table) => LawChoice { feed_forward, ..LawChoice::new(table) }.built_in()?,
                            None => Equilibrium { feed_forward, ..Equilibrium::new(&dense) }.into(),
                        };
                        let controller = black_box(Controller::new(law, limits.check().ok()?));
                        self.law(&mut calls, &controller, &state, &reference)?;
                    }
                }
                let mut of_tick = 0;
                if let Some(table) = table {
                    let controller = Controller::new(worst(table).built_in()?, last.check().ok()?);
                    let reference = stored.reference(step * TICKS_PER_STEP).ok()?;
                    let state = State { attitude: sign(recorded.attitude), ..recorded };
                    let memory = &mut Memory::at_rest();
                    let output = controller.step(memory, Measured::new(&state), Target::new(&reference)).ok()?;
                    of_tick = self.tick(step, state, output.command()?)?;
                }
                self.write(of_reference, &calls, of_tick)?;
            }
            Some(())
        }

        /// Armed, at the start of a stored trajectory.
        fn take_off(&mut self, course: &Course, law: LawChoice, limits: LimitsSetting) -> Option<()> {
            self.flight.disarm();
            let [hovering, ..] = self.limits;
            self.flight.set_limits(hovering).ok()?;
            self.flight.select(law).ok()?;
            self.flight.playback.start(stored::player(course.id)?);
            let start = State::at_rest(self.flight.playback.begins_at_m()?);
            self.flight.accept(StateIn { tick: 0, state: start }, self.timing.now());
            self.flight.hear(self.timing.now());
            self.flight.arm(self.timing.now()).ok()?;
            // Limits that leave no hover cost most, and no board arms with them.
            self.flight.set_limits(limits).ok()
        }

        fn reference(&self, player: &mut Player<'_>, tick: Tick) -> Option<(u32, Reference)> {
            let start = self.counter.now();
            let reference = reference(player, tick);
            let count = self.since(start);
            Some((count, black_box(reference.ok()?)))
        }

        /// One step of the law with validation, sign handling and saturation: a call of the core's own function.
        fn law(
            &self,
            calls: &mut Calls,
            controller: &Controller<'_>,
            state: &State,
            reference: &Reference,
        ) -> Option<Step> {
            let memory = &mut Memory::at_rest();
            let start = self.counter.now();
            let output = controller.step(memory, Measured::new(state), Target::new(reference));
            let count = self.since(start);
            let step = *black_box(&output).as_ref().ok()?.command()?;
            calls.add(count);
            calls.hash = hashed(calls.hash, words(&step.command));
            Some(step)
        }

        /// A tick that steps on a state and is to answer as expected.
        fn tick(&mut self, step: u32, state: State, expected: &Step) -> Option<u32> {
            // Ticks between two steps, which only count.
            (1..TICKS_PER_STEP).for_each(|_| self.pass());
            self.flight.hear(self.timing.now());
            self.flight.accept(StateIn { tick: step * TICKS_PER_STEP, state }, self.timing.now());
            self.timing.on_timer(self.counter.now());
            let start = self.counter.now();
            control(&mut self.flight, &self.timing, self.counter);
            let count = self.since(start);
            (self.flight.take_answer()?.result == Ok(*expected)).then_some(count)
        }

        fn write(&mut self, of_reference: u32, calls: &Calls, of_tick: u32) -> Option<()> {
            let [thrust, p, q, r] = words(self.flight.command());
            let Calls { least, sum, most, hash } = *calls;
            write_words(&mut self.counts, [of_reference, least, sum, most, of_tick, thrust, p, q, r, hash])
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

        fn read_state(&mut self) -> Option<State> {
            let [x, y, z, q0, q1, q2, q3, vx, vy, vz] = read_words(&mut self.states)?.map(f32::from_bits);
            Some(State {
                position_m: Vector3::new(x, y, z),
                attitude: Quaternion::new(q0, q1, q2, q3),
                velocity_m_s: Vector3::new(vx, vy, vz),
            })
        }
    }

    /// The costliest choice of a table, on a reference that does not turn.
    fn worst(table: Table) -> LawChoice {
        LawChoice { feed_forward: FeedForward::With, ..LawChoice::new(table) }
    }

    /// The body of the control interrupt.
    #[inline(never)]
    fn control(flight: &mut Flight, timing: &Timing, counter: Counter) {
        tick::control(flight, timing, counter, &mut NoCraft);
    }

    /// On-board reference: polynomial to jerk, and the flat map.
    #[inline(never)]
    fn reference(player: &mut Player<'_>, tick: Tick) -> Result<Reference, ReferenceError> {
        player.reference(tick)
    }

    fn words(command: &Command) -> [u32; 4] {
        let rates = &command.body_rates_rad_s;
        [command.thrust_m_s2, rates.x, rates.y, rates.z].map(f32::to_bits)
    }

    fn setting(file: &mut File) -> Option<LimitsSetting> {
        let [thrust_min_m_s2, thrust_max_m_s2, p, q, r] = read_words(file)?.map(f32::from_bits);
        Some(LimitsSetting { thrust_min_m_s2, thrust_max_m_s2, body_rates_max_rad_s: [p, q, r] })
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
