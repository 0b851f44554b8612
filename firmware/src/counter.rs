//! TIM5 as a free-running counter: the timer in, counts out.
//!
//! On the board it counts the timer's clock. Under QEMU with `-icount shift=0` an instruction takes a nanosecond and the
//! emulated timer runs at 1 GHz, so that it counts instructions; code that relies on that measures it first.

use stm32f4::stm32f405::{RCC, TIM5};

/// The running counter, for any interrupt to read.
#[derive(Clone, Copy)]
pub struct Counter {
    /// Only [`Counter::start`] makes one.
    running: (),
}

impl Counter {
    /// Starts the timer over the whole range of 32 bits, without prescaler. Nobody gets at it afterwards.
    #[allow(clippy::needless_pass_by_value, reason = "the timer is moved in, so that nothing else can set it")]
    pub fn start(timer: TIM5, rcc: &RCC) -> Self {
        rcc.apb1enr().modify(|_, w| w.tim5en().enabled());
        timer.arr().write(|w| w.set(u32::MAX));
        timer.psc().reset();
        // Takes the prescaler over.
        timer.egr().write(|w| w.ug().update());
        timer.cr1().modify(|_, w| w.cen().enabled());
        Self { running: () }
    }

    /// The count now; wraps. Out of line, so that every reading costs the same.
    #[allow(unsafe_code, reason = "reads one register of a timer that nobody writes any more")]
    #[inline(never)]
    pub fn now(&self) -> u32 {
        let () = self.running;
        // SAFETY: reading the count changes nothing.
        unsafe { TIM5::steal() }.cnt().read().bits()
    }
}
