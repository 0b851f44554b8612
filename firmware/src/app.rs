// The running image: interrupts in, priorities out. Included by each bin that flies, which names its line.
//
// Priorities, highest first:
// 3  USART2    a byte is lost 10 us after it came; some 30 instructions
// 2  SysTick   the tick, 1 kHz; some 50 instructions: counts, and pends the control interrupt
// 1  CAN2_SCE  a vector that the board has no other use for: the control step
// 0  idle      the link: frames in and out, telemetry
#[rtic::app(device = stm32f4::stm32f405, peripherals = true)]
mod app {
    use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

    use heapless::spsc::Queue;
    use quatrack::Tick;
    use quatrack::link::{FRAME_BYTES, LoopStatistics, Nonce};
    use quatrack_firmware::board::crazyflie_2_1 as board;
    use quatrack_firmware::board::i2c::Bus;
    use quatrack_firmware::board::pwm::Channel;
    use quatrack_firmware::board::rng::Rng;
    use quatrack_firmware::counter::Counter;
    use quatrack_firmware::craft::BoardCraft;
    use quatrack_firmware::flight::{Flight, Store};
    use quatrack_firmware::kept::InFlash;
    use quatrack_firmware::provisioned::Keys;
    use quatrack_firmware::session::{Session, Shared as SharedFlight, Uploads, Vitals};
    use quatrack_firmware::timing::Timing;
    use quatrack_firmware::transport::Line as _;
    use quatrack_firmware::transport::usart::{QUEUE_BYTES, Receiver, UsartLine};
    use quatrack_firmware::{record, stack};
    use rtic::mutex_prelude::Mutex;
    use stm32f4::stm32f405::Interrupt;

    use crate::{Flash, Line};

    static DROPPED_BYTES: AtomicU32 = AtomicU32::new(0);

    #[shared]
    struct Shared {
        flight: Flight,
        timing: Timing,
        counter: Counter,
    }

    #[local]
    struct Local {
        craft: BoardCraft<Bus, Channel>,
        receiver: Receiver,
        session: Session<InFlash<Flash>>,
        line: Line,
        rng: Rng,
    }

    #[init(local = [
        queue: Queue<u8, QUEUE_BYTES> = Queue::new(),
        store: Store = Store::new(),
        uploads: Uploads = Uploads::new(),
    ])]
    fn init(mut context: init::Context) -> (Shared, Local) {
        let fault = record::read();
        let (producer, consumer) = context.local.queue.split();
        if let Some(report) = fault {
            defmt::error!("restarted after {} at {=u32:#010x}", report.fault, report.address);
        }
        let board = board::start(context.device, &mut context.core.SYST);
        let line = crate::line(UsartLine::new(board.usart, consumer));
        let mut flight = Flight::new(context.local.store, fault.map(|report| report.fault));
        if board.gyro.is_ok() {
            flight.motors.set_gyroscope();
        }
        let shared = Shared {
            flight,
            timing: Timing::new(board.clocks.counts_per_tick),
            counter: board.counter,
        };
        defmt::info!("core {=u32} Hz, TIM5 {=u32} counts a tick", board.clocks.core_hz, board.clocks.counts_per_tick);
        if let Err(error) = &board.gyro {
            defmt::warn!("no gyroscope: {=str}", error.kind());
        }
        let craft = BoardCraft { gyro: board.gyro.ok(), motors: board.motors };
        let receiver = Receiver::new(producer, &DROPPED_BYTES);
        let keys = Keys::provisioned();
        match &keys.link {
            Some((_, protection)) => defmt::info!("{}", protection),
            None => defmt::warn!("no key: anybody on the line can fly"),
        }
        let (flash, slot_bytes) = crate::flash(board.sectors);
        let session = Session::new(context.local.uploads, keys, InFlash::new(flash, slot_bytes), fault);
        (shared, Local { craft, receiver, session, line, rng: board.rng })
    }

    #[task(binds = USART2, priority = 3, local = [receiver])]
    fn receive(context: receive::Context) {
        context.local.receiver.on_interrupt();
    }

    #[task(binds = SysTick, priority = 2, shared = [&timing, &counter])]
    fn tick(context: tick::Context) {
        if context.shared.timing.on_timer(context.shared.counter.now()) {
            rtic::pend(Interrupt::CAN2_SCE);
        }
    }

    #[task(binds = CAN2_SCE, priority = 1, local = [craft], shared = [flight, &timing, &counter])]
    fn control(mut context: control::Context) {
        let (timing, counter, craft) = (context.shared.timing, *context.shared.counter, context.local.craft);
        context.shared.flight.lock(|flight| quatrack_firmware::tick::control(flight, timing, counter, craft));
    }

    #[idle(local = [session, line, rng], shared = [flight, &timing])]
    fn idle(mut context: idle::Context) -> ! {
        let (session, line) = (context.local.session, context.local.line);
        let vitals = OwnVitals { timing: context.shared.timing, rng: context.local.rng };
        let mut flight = LockedFlight(&mut context.shared.flight);
        session.restore(&mut flight);
        let mut received = [0; 64];
        let mut frame = [0; FRAME_BYTES];
        let mut mode = flight.with(|flight| flight.mode());
        loop {
            let count = line.receive(&mut received);
            for byte in received.iter().take(count) {
                let Some(answers) = session.push(*byte, &mut flight, &vitals) else { continue };
                if flight.with(|flight| flight.is_lock_step() && flight.is_waiting()) {
                    rtic::pend(Interrupt::CAN2_SCE);
                    // The step is taken here, before the next instruction.
                    cortex_m::asm::dsb();
                    cortex_m::asm::isb();
                }
                let command = flight.with(Flight::take_message);
                for message in answers.iter().chain(&command) {
                    if let Some(frame) = session.frame(message, &mut frame) {
                        line.send(frame);
                    }
                }
            }
            let command = flight.with(Flight::take_message);
            for message in command.into_iter().chain(session.unasked(&mut flight, &vitals)) {
                if let Some(frame) = session.frame(&message, &mut frame) {
                    line.send(frame);
                }
            }
            let before = core::mem::replace(&mut mode, flight.with(|flight| flight.mode()));
            if mode != before {
                defmt::info!("tick {=u32}: {} -> {}", vitals.now(), before, mode);
            }
            if count == 0 {
                line.wait();
            }
        }
    }

    struct LockedFlight<'a, M>(&'a mut M);

    impl<M: Mutex<T = Flight>> SharedFlight for LockedFlight<'_, M> {
        fn with<R>(&mut self, access: impl FnOnce(&mut Flight) -> R) -> R {
            self.0.lock(access)
        }
    }

    struct OwnVitals<'a> {
        timing: &'a Timing,
        rng: &'a Rng,
    }

    impl Vitals for OwnVitals<'_> {
        fn now(&self) -> Tick {
            self.timing.now()
        }

        fn statistics(&self) -> LoopStatistics {
            LoopStatistics {
                overruns: self.timing.overruns(),
                worst_step_ns: self.timing.worst_step_ns(),
                jitter_ns: self.timing.jitter_ns(),
                stack_bytes: stack::high_water_bytes(),
                bytes_dropped: DROPPED_BYTES.load(Relaxed),
                ..LoopStatistics::default()
            }
        }

        fn nonce(&self) -> Option<Nonce> {
            crate::nonce(self.rng)
        }

        fn set_decimation(&self, decimation: u32) {
            self.timing.set_decimation(decimation);
        }
    }
}
