//! TIM2 as a free-running counter: the timer in, counts out.
//!
//! On the board it counts the timer's clock. Under QEMU with `-icount shift=0` an instruction takes a nanosecond and the
//! emulated timer runs at 1 GHz, so that it counts instructions; who relies on that measures it first.

use stm32f4::stm32f405::{RCC, TIM2};

/// The running counter.
pub struct Counter {
    timer: TIM2,
}

impl Counter {
    /// Starts the timer over the whole range of 32 bits, without prescaler.
    pub fn start(timer: TIM2, rcc: &RCC) -> Self {
        rcc.apb1enr().modify(|_, w| w.tim2en().enabled());
        timer.arr().write(|w| w.set(u32::MAX));
        timer.psc().reset();
        timer.cr1().modify(|_, w| w.cen().enabled());
        Self { timer }
    }

    /// The count now; wraps. Out of line, so that every reading costs the same.
    #[inline(never)]
    pub fn now(&self) -> u32 {
        self.timer.cnt().read().bits()
    }
}
