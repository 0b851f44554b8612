//! The motors' outputs: TIM2 and TIM4 in, four channels out. One count is 1/256 of a period, 328 kHz behind the PLL, as
//! the Crazyflie's own firmware has it: slower, and the ripple reaches the regulator of the supply.

use core::convert::Infallible;

use embedded_hal::pwm::{ErrorType, SetDutyCycle};
use stm32f4::stm32f405::{RCC, TIM2, TIM4};

/// Counts of a whole period; with as many a channel is on all the time.
const PERIOD_COUNTS: u16 = 256;

/// A channel; only [`start`] makes them, one of each.
#[derive(Debug)]
pub struct Channel(Output);

#[derive(Debug)]
enum Output {
    Tim2Channel1,
    Tim2Channel2,
    Tim2Channel4,
    Tim4Channel4,
}

/// Starts both timers with every channel off: M1 to M4. Their pins are still to be given to them.
#[allow(clippy::needless_pass_by_value, reason = "the timers are moved in, so that nothing else can drive them")]
pub(super) fn start(tim2: TIM2, tim4: TIM4, rcc: &RCC) -> [Channel; 4] {
    rcc.apb1enr().modify(|_, w| w.tim2en().enabled().tim4en().enabled());
    let last = PERIOD_COUNTS - 1;
    tim2.arr().write(|w| w.set(u32::from(last)));
    tim4.arr().write(|w| w.arr().set(last));
    // On below the compared count, which is taken over where a period begins.
    tim2.ccmr1_output().write(|w| w.oc1m().pwm_mode1().oc1pe().enabled().oc2m().pwm_mode1().oc2pe().enabled());
    tim2.ccmr2_output().write(|w| w.oc4m().pwm_mode1().oc4pe().enabled());
    tim4.ccmr2_output().write(|w| w.oc4m().pwm_mode1().oc4pe().enabled());
    for counts in [tim2.ccr1(), tim2.ccr2(), tim2.ccr4()] {
        counts.reset();
    }
    tim4.ccr4().reset();
    tim2.egr().write(|w| w.ug().update());
    tim4.egr().write(|w| w.ug().update());
    tim2.ccer().write(|w| w.cc1e().set_bit().cc2e().set_bit().cc4e().set_bit());
    tim4.ccer().write(|w| w.cc4e().set_bit());
    tim2.cr1().modify(|_, w| w.cen().enabled());
    tim4.cr1().modify(|_, w| w.cen().enabled());
    [Output::Tim2Channel2, Output::Tim2Channel4, Output::Tim2Channel1, Output::Tim4Channel4].map(Channel)
}

impl ErrorType for Channel {
    type Error = Infallible;
}

impl SetDutyCycle for Channel {
    fn max_duty_cycle(&self) -> u16 {
        PERIOD_COUNTS
    }

    #[allow(unsafe_code, reason = "writes one register, which belongs to this channel alone")]
    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        // SAFETY: the timers have been taken away, there is one channel for each output, and each writes its own register.
        let (tim2, tim4) = unsafe { (TIM2::steal(), TIM4::steal()) };
        match self.0 {
            Output::Tim2Channel1 => tim2.ccr1().write(|w| w.ccr().set(u32::from(duty))),
            Output::Tim2Channel2 => tim2.ccr2().write(|w| w.ccr().set(u32::from(duty))),
            Output::Tim2Channel4 => tim2.ccr4().write(|w| w.ccr().set(u32::from(duty))),
            Output::Tim4Channel4 => tim4.ccr4().write(|w| w.ccr().set(duty)),
        };
        Ok(())
    }
}
