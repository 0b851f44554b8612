//! Counts the instructions of frames and tags: counts out, to a file of the host.
//!
//! `counts.bin` is in the folder in which the emulator runs, all numbers little-endian, 32 bits: the cost of reading the counter,
//! counts of two loops of known length, then one count for each line of `COUNTED` in `host-sim/cli/src/pil/link.rs`; 0 where
//! something was not taken.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;

    use cortex_m_rt::entry;
    use quatrack::link::{
        Decoder, Encoder, FRAME_BYTES, FromBoard, HostSession, Identity, Key, Message, Nonce, Protection, Refusal,
        RigidStateIn, SIGNATURE_BYTES, Seal, SessionSeals, StateIn, ToBoard, Version, signature, signed_with,
    };
    use quatrack::nalgebra::Vector3;
    use quatrack::{FlatSample, RigidState, State};
    use quatrack_firmware::counter::Counter;
    use quatrack_firmware::semihosting::{File, Mode, exit};
    use stm32f4::stm32f405::Peripherals;

    /// Rounds of a loop of two instructions: the costs differ by 2000.
    const LOOPS: [u32; 2] = [100, 1100];
    const SESSION: u32 = 1_796_000_000;
    /// Bytes of a table whose gain is the same all the time, about.
    const TABLE_BYTES: usize = 400;

    #[entry]
    fn main() -> ! {
        exit(run().is_some())
    }

    /// Counts the instructions between two looks at the counter.
    struct Stopwatch {
        counter: Counter,
        overhead: u32,
    }

    impl Stopwatch {
        fn of(&self, work: impl FnOnce() -> bool) -> u32 {
            let start = self.counter.now();
            let is_done = work();
            let count = self.counter.now().wrapping_sub(start).wrapping_sub(self.overhead);
            if is_done { count } else { 0 }
        }
    }

    fn run() -> Option<()> {
        let peripherals = Peripherals::take()?;
        let counter = Counter::start(peripherals.TIM5, &peripherals.RCC);
        let mut counts = File::open(c"counts.bin", Mode::Write)?;
        let start = counter.now();
        let overhead = counter.now().wrapping_sub(start);
        let watch = Stopwatch { counter, overhead };
        let loops = LOOPS.map(|rounds| {
            let start = counter.now();
            spin(rounds);
            counter.now().wrapping_sub(start).wrapping_sub(overhead)
        });
        write(&mut counts, [overhead, loops[0], loops[1]])?;
        for is_keyed in [false, true] {
            write(&mut counts, frames(&watch, is_keyed)?)?;
        }
        let key = Key::new(black_box(&[7; 32]));
        let mut table = [3; TABLE_BYTES + SIGNATURE_BYTES];
        let (content, place) = table.split_last_chunk_mut::<SIGNATURE_BYTES>()?;
        *place = signature(&key, content);
        write(&mut counts, [watch.of(|| signed_with(&key, black_box(&table)).is_some())])
    }

    /// A hello with its answer, an order, a state with body rates, a state with a reference, and an answer.
    fn frames(watch: &Stopwatch, is_keyed: bool) -> Option<[u32; 5]> {
        let (key, host, board) = (Key::new(black_box(&[7; 32])), Nonce([1; 16]), Nonce([2; 16]));
        let mut session =
            if is_keyed { HostSession::keyed(SESSION, key.clone(), host) } else { HostSession::new(SESSION) };
        let mut decoder = if is_keyed { Decoder::keyed(&key, Protection::Everything) } else { Decoder::new() };
        let mut encoder = Encoder::new(SESSION);
        let mut seals = None;
        let (mut frame, mut answer) = ([0; FRAME_BYTES], [0; FRAME_BYTES]);
        let identity = FromBoard::Hello(Identity {
            firmware: Version { major: 0, minor: 1, patch: 0 },
            control_image: 1,
            tick_rate_hz: 1000,
            decimation: 2,
            trajectory_pieces: 64,
            protection: if is_keyed { Protection::Everything } else { Protection::CableOnly },
            signed_tables: false,
            nonce: board,
        });
        let bytes = session.encode(&session.hello(), &mut frame).ok()?;
        let mut answered = None;
        let of_hello = watch.of(|| {
            let is_taken = taken(&mut decoder, bytes);
            let answers = is_keyed.then(|| {
                let new = key.session(SESSION, &host, &board);
                decoder.propose(SESSION, 0, new.to_board.clone());
                seals = Some(new);
                key.answer(&host)
            });
            answered = sent(&mut encoder, &identity, answers.as_ref(), &mut answer);
            is_taken
        });
        session.next(answer.get(..answered?)?)?;
        let rest = State::at_rest(Vector3::new(1.0, 2.0, 3.0));
        let rigid = RigidState { state: rest, body_rates_rad_s: Vector3::new(0.1, 0.2, 0.3) };
        let sample = FlatSample::at_rest(Vector3::new(1.0, 2.0, 3.0), 0.5);
        let messages = [
            ToBoard::Arm,
            ToBoard::RigidState(RigidStateIn { tick: 1000, state: rigid }),
            ToBoard::StateAndReference(StateIn { tick: 1000, state: rest }, sample),
        ];
        let mut of_messages = [0; 3];
        for (count, message) in of_messages.iter_mut().zip(&messages) {
            let bytes = session.encode(message, &mut frame).ok()?;
            *count = watch.of(|| taken(&mut decoder, bytes));
        }
        let [of_order, of_state, of_reference] = of_messages;
        let nack = FromBoard::Nack { sequence: 1, reason: Refusal::NoTable };
        let seal = seals.as_ref().map(|seals: &SessionSeals| &seals.from_board);
        let of_answer = watch.of(|| sent(&mut encoder, black_box(&nack), seal, &mut answer).is_some());
        Some([of_hello, of_order, of_state, of_reference, of_answer])
    }

    /// Out of line, so that both loops are the same one, with the same padding before it.
    #[inline(never)]
    fn spin(rounds: u32) {
        cortex_m::asm::delay(rounds);
    }

    #[inline(never)]
    fn taken(decoder: &mut Decoder<ToBoard>, bytes: &[u8]) -> bool {
        black_box(decoder.next(black_box(bytes))).is_some()
    }

    #[inline(never)]
    fn sent<M: Message>(encoder: &mut Encoder, message: &M, seal: Option<&Seal>, buffer: &mut [u8]) -> Option<usize> {
        encoder.encode_sealed(message, seal, buffer).ok().map(<[u8]>::len)
    }

    fn write<const N: usize>(file: &mut File, words: [u32; N]) -> Option<()> {
        file.write(words.map(u32::to_le_bytes).as_flattened()).then_some(())
    }
}

/// On a desk there is nothing to run: `quatrack measure` builds the image and starts it.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is an image for an emulated STM32F405; run it with `quatrack measure`");
}
