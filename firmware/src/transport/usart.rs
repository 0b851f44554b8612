//! The line over USART2: received bytes through a queue that its interrupt fills, sent ones as the line takes them.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use cortex_m::{asm, interrupt};
use heapless::spsc::{Consumer, Producer};
use stm32f4::stm32f405::USART2;

use super::Line;

/// Bits a second; both clocks of the board divide to it exactly.
pub const BAUD: u32 = 1_000_000;

/// Bytes that can wait while the link's loop is busy: 5 ms of the line.
pub const QUEUE_BYTES: usize = 512;

/// Starts the USART on a clock: 8 bits, no parity, an interrupt for every byte that comes.
pub fn start(usart: &USART2, clock_hz: u32) {
    let sixteenths = clock_hz / BAUD;
    usart.brr().write(|w| w.div_mantissa().set((sixteenths >> 4) as u16).div_fraction().set((sixteenths & 0xf) as u8));
    usart.cr1().write(|w| w.ue().enabled().te().enabled().re().enabled().rxneie().enabled());
}

/// The receiving half, for the interrupt.
pub struct Receiver {
    queue: Producer<'static, u8>,
    dropped: &'static AtomicU32,
}

impl Receiver {
    /// Fills `queue` and counts bytes that do not fit.
    pub fn new(queue: Producer<'static, u8>, dropped: &'static AtomicU32) -> Self {
        Self { queue, dropped }
    }

    /// Takes the byte that has come. Reading it also clears an overrun of the register.
    #[allow(unsafe_code, reason = "the interrupt reads registers that the sending half only waits on")]
    pub fn on_interrupt(&mut self) {
        // SAFETY: SR and DR are only read; the other half writes DR, which is another register of the hardware.
        let usart = unsafe { USART2::steal() };
        let status = usart.sr().read();
        if status.ore().bit_is_set() {
            self.drop_one();
        }
        if status.rxne().bit_is_set() || status.ore().bit_is_set() {
            let byte = usart.dr().read().dr().bits() as u8;
            if status.rxne().bit_is_set() && self.queue.enqueue(byte).is_err() {
                self.drop_one();
            }
        }
    }

    fn drop_one(&mut self) {
        self.dropped.store(self.dropped.load(Relaxed).saturating_add(1), Relaxed);
    }
}

/// The other half.
pub struct UsartLine {
    usart: USART2,
    queue: Consumer<'static, u8>,
}

impl UsartLine {
    /// Reads from `queue` and sends on the started `usart`.
    pub fn new(usart: USART2, queue: Consumer<'static, u8>) -> Self {
        Self { usart, queue }
    }
}

impl Line for UsartLine {
    fn receive(&mut self, buffer: &mut [u8]) -> usize {
        let mut count = 0;
        for place in buffer {
            let Some(byte) = self.queue.dequeue() else { break };
            *place = byte;
            count += 1;
        }
        count
    }

    fn send(&mut self, frame: &[u8]) {
        for byte in frame {
            while self.usart.sr().read().txe().bit_is_clear() {}
            self.usart.dr().write(|w| w.dr().set(u16::from(*byte)));
        }
    }

    fn wait(&mut self) {
        // With interrupts held back nothing can come between the look and the wait, which ends with a pending one.
        interrupt::free(|_| {
            if !self.queue.ready() {
                asm::wfi();
            }
        });
    }
}
