//! Crazyflie 2.1: the microcontroller's peripherals in; running clocks, timer and line out. The emulated STM32F405 is
//! the same board to this module.
//!
//! ```text
//! PA1, PB11, PA15, PB9   motors 1 to 4: held low, since nothing drives them yet
//! PA2, PA3               USART2 on the deck connector (pins TX2, RX2): the line
//! PD2                    blue LED
//! HSE                    8 MHz crystal
//! ```
//!
//! None of this has run on a real board yet.

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use stm32f4::stm32f405::{FLASH, GPIOA, GPIOB, PWR, Peripherals, RCC, USART2};

use crate::counter::Counter;
use crate::flight::TICK_RATE_HZ;
use crate::transport::usart;

/// With the crystal: 8 MHz / 4 * 168 / 2.
const PLL_HZ: u32 = 168_000_000;
/// Without it.
const HSI_HZ: u32 = 16_000_000;

/// Looks at a ready flag before it is given up: more than the 2 ms that the crystal may take to start.
const READY_LOOKS: u32 = 20_000;

/// What runs.
#[derive(Clone, Copy, Debug)]
pub struct Clocks {
    /// Of the processor and SysTick, Hz.
    pub core_hz: u32,
    /// Counts of TIM2 in a tick.
    pub counts_per_tick: u32,
}

/// The board, started.
pub struct Board {
    /// Its clocks.
    pub clocks: Clocks,
    /// The free-running counter.
    pub counter: Counter,
    /// The line, started.
    pub usart: USART2,
}

/// Starts clocks, pins, the counter, the line, and the timer that ticks.
pub fn start(device: Peripherals, systick: &mut SYST) -> Board {
    let on_pll = start_pll(&device.RCC, &device.FLASH, &device.PWR);
    start_pins(&device.RCC, &device.GPIOA, &device.GPIOB);
    let counter = Counter::start(device.TIM2, &device.RCC);
    let clocks = clocks(on_pll, systick, &counter);
    device.RCC.apb1enr().modify(|_, w| w.usart2en().enabled());
    // APB1 runs at a quarter of the processor's clock behind the PLL, and undivided without it.
    usart::start(&device.USART2, if on_pll { PLL_HZ / 4 } else { HSI_HZ });
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(clocks.core_hz / TICK_RATE_HZ - 1);
    systick.clear_current();
    systick.enable_counter();
    systick.enable_interrupt();
    Board { clocks, counter, usart: device.USART2 }
}

/// Runs from the crystal through the PLL; whether it does. A crystal or PLL that does not get ready leaves the board on
/// its internal oscillator.
fn start_pll(rcc: &RCC, flash: &FLASH, pwr: &PWR) -> bool {
    rcc.cr().modify(|_, w| w.hseon().on());
    if !becomes(|| rcc.cr().read().hserdy().bit_is_set()) {
        return false;
    }
    rcc.apb1enr().modify(|_, w| w.pwren().enabled());
    pwr.cr().modify(|_, w| w.vos().scale1());
    set_pll(rcc);
    rcc.cr().modify(|_, w| w.pllon().on());
    if !becomes(|| rcc.cr().read().pllrdy().bit_is_set()) {
        return false;
    }
    flash.acr().write(|w| w.latency().ws5().prften().enabled().icen().enabled().dcen().enabled());
    rcc.cfgr().modify(|_, w| w.hpre().div1().ppre1().div4().ppre2().div2());
    rcc.cfgr().modify(|_, w| w.sw().pll());
    becomes(|| rcc.cfgr().read().sws().is_pll())
}

/// 8 MHz / 4 * 168 / 2 for the processor, / 7 for USB.
#[allow(unsafe_code, reason = "the register's description does not know which numbers these fields may hold")]
fn set_pll(rcc: &RCC) {
    // SAFETY: the reference manual's ranges are 2 to 63, 50 to 432 and 2 to 15.
    rcc.pllcfgr().write(|w| unsafe { w.pllsrc().hse().pllm().bits(4).plln().bits(168).pllp().div2().pllq().bits(7) });
}

fn becomes(ready: impl Fn() -> bool) -> bool {
    (0..READY_LOOKS).any(|_| ready())
}

/// The rates of the processor and of TIM2 in a tick.
///
/// Behind the PLL TIM2 counts at half the processor's rate, on the internal oscillator at the same. An emulator has no
/// clock tree: QEMU's SysTick always runs at 168 MHz and its TIM2 at 1 GHz, which their ratio gives away.
fn clocks(on_pll: bool, systick: &mut SYST, counter: &Counter) -> Clocks {
    const LOOK_CYCLES: u32 = 10_000;
    const EMULATED_TIMER_HZ: u32 = 1_000_000_000;
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(0x00ff_ffff);
    systick.clear_current();
    systick.enable_counter();
    let (cycles, counts) = (SYST::get_current(), counter.now());
    cortex_m::asm::delay(LOOK_CYCLES);
    let (cycles, counts) = (cycles.wrapping_sub(SYST::get_current()), counter.now().wrapping_sub(counts));
    let is_emulated = counts & 0x00ff_ffff > 2 * (cycles & 0x00ff_ffff);
    let (core_hz, timer_hz) = match (is_emulated, on_pll) {
        (true, _) => (PLL_HZ, EMULATED_TIMER_HZ),
        (false, true) => (PLL_HZ, PLL_HZ / 2),
        (false, false) => (HSI_HZ, HSI_HZ),
    };
    Clocks { core_hz, counts_per_tick: timer_hz / TICK_RATE_HZ }
}

fn start_pins(rcc: &RCC, gpioa: &GPIOA, gpiob: &GPIOB) {
    rcc.ahb1enr().modify(|_, w| w.gpioaen().enabled().gpioben().enabled().gpioden().enabled());
    // Low before they are outputs: a motor must not twitch.
    gpioa.bsrr().write(|w| w.br1().set_bit().br15().set_bit());
    gpiob.bsrr().write(|w| w.br11().set_bit().br9().set_bit());
    gpioa.afrl().modify(|_, w| w.afrl2().af7().afrl3().af7());
    gpioa.moder().modify(|_, w| w.moder1().output().moder15().output().moder2().alternate().moder3().alternate());
    gpiob.moder().modify(|_, w| w.moder11().output().moder9().output());
}
