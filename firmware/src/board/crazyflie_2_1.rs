//! Crazyflie 2.1: the microcontroller's peripherals in; running clocks, timer, line, motors and gyroscope out. The
//! emulated STM32F405 is the same board to this module, without a gyroscope.
//!
//! ```text
//! PA1, PB11, PA15, PB9   motors 1 to 4: TIM2 channels 2, 4, 1 and TIM4 channel 4
//! PA2, PA3               USART2 on the deck connector (pins TX2, RX2): the line
//! PA8, PC9               I2C3, clock and data: the BMI088, its gyroscope at 0x68
//! PC14                   its INT3: new rates, not used
//! PD2                    blue LED
//! TIM5                   the free-running counter
//! HSE                    8 MHz crystal
//! ```
//!
//! None of this has run on a real board yet.

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use embedded_hal::delay::DelayNs;
use stm32f4::stm32f405::{FLASH, GPIOA, GPIOB, GPIOC, PWR, Peripherals, RCC, USART2};

use super::flash::Sectors;
use super::i2c::{Bus, BusError};
use super::pwm::{self, Channel};
use super::rng::Rng;
use crate::counter::Counter;
use crate::drivers::bmi088::{Address, Bandwidth, Gyro, GyroError, Range};
use crate::drivers::motors::Motors;
use crate::drivers::thrust_curve::ThrustCurve;
use crate::rates::TICK_RATE_HZ;
use crate::transport::usart;

/// With the crystal: 8 MHz / 4 * 168 / 2.
const PLL_HZ: u32 = 168_000_000;
/// Without it.
const HSI_HZ: u32 = 16_000_000;

/// Looks at a ready flag before it is given up: more than the 2 ms that the crystal may take to start.
const READY_LOOKS: u32 = 20_000;

/// The peripherals that run.
#[derive(Clone, Copy, Debug)]
pub struct Clocks {
    /// Clock of the processor and SysTick, Hz.
    pub core_hz: u32,
    /// Counts of the counter in a tick.
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
    /// M1 to M4, off.
    pub motors: Motors<Channel>,
    /// The gyroscope, or why there is none.
    pub gyro: Result<Gyro<Bus>, GyroError<BusError>>,
    /// The flash that keeps uploads.
    pub sectors: Sectors,
    /// Random numbers.
    pub rng: Rng,
}

/// Starts clocks, pins, the counter, the line, motors, gyroscope, and the timer that ticks.
pub fn start(device: Peripherals, systick: &mut SYST) -> Board {
    hold_motors(&device.RCC, &device.GPIOA, &device.GPIOB);
    let on_pll = start_pll(&device.RCC, &device.FLASH, &device.PWR);
    // APB1 runs at a quarter of the processor's clock behind the PLL, and undivided without it.
    let apb1_hz = if on_pll { PLL_HZ / 4 } else { HSI_HZ };
    let counter = Counter::start(device.TIM5, &device.RCC);
    let clocks = clocks(on_pll, systick, &counter);
    let channels = pwm::start(device.TIM2, device.TIM4, &device.RCC);
    let mut delay = Delay { core_hz: clocks.core_hz };
    free_bus(&device.GPIOA, &device.GPIOC, &mut delay);
    give_pins(&device.GPIOA, &device.GPIOB, &device.GPIOC);
    device.RCC.apb1enr().modify(|_, w| w.usart2en().enabled());
    usart::start(&device.USART2, apb1_hz);
    let bus = Bus::start(device.I2C3, &device.RCC, apb1_hz);
    // The next smaller range ends below the 20 rad/s that laws may ask for.
    let gyro = Gyro::start(bus, Address::Low, Range::Degrees2000, Bandwidth::Hz116, &mut delay);
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(clocks.core_hz / TICK_RATE_HZ - 1);
    systick.clear_current();
    systick.enable_counter();
    systick.enable_interrupt();
    let Ok(motors) = Motors::new(channels, ThrustCurve::CRAZYFLIE_2_1);
    let (sectors, rng) = (Sectors::new(device.FLASH), Rng::start(device.RNG, &device.RCC));
    Board { clocks, counter, usart: device.USART2, motors, gyro, sectors, rng }
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

/// The rates of the processor and of the counter in a tick.
///
/// Behind the PLL TIM5 counts at half the processor's rate, on the internal oscillator at the same. An emulator has no
/// clock tree: QEMU's SysTick always runs at 168 MHz and its TIM5 at 1 GHz, which their ratio gives away.
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

/// Low before they are outputs: a motor must not twitch. PA15 comes up as a pin for debugging that is pulled high.
fn hold_motors(rcc: &RCC, gpioa: &GPIOA, gpiob: &GPIOB) {
    rcc.ahb1enr().modify(|_, w| w.gpioaen().enabled().gpioben().enabled().gpiocen().enabled().gpioden().enabled());
    gpioa.bsrr().write(|w| w.br1().set_bit().br15().set_bit());
    gpiob.bsrr().write(|w| w.br11().set_bit().br9().set_bit());
    gpioa.moder().modify(|_, w| w.moder1().output().moder15().output());
    gpiob.moder().modify(|_, w| w.moder11().output().moder9().output());
    gpioa.pupdr().modify(|_, w| w.pupdr15().floating());
}

/// A chip that was answering when the processor restarted holds the data line until it has sent its byte: nine clocks.
fn free_bus(gpioa: &GPIOA, gpioc: &GPIOC, delay: &mut Delay) {
    gpioa.otyper().modify(|_, w| w.ot8().open_drain());
    gpioc.otyper().modify(|_, w| w.ot9().open_drain());
    gpioa.bsrr().write(|w| w.bs8().set_bit());
    gpioa.moder().modify(|_, w| w.moder8().output());
    for _ in 0..9 {
        gpioa.bsrr().write(|w| w.br8().set_bit());
        delay.delay_us(5);
        gpioa.bsrr().write(|w| w.bs8().set_bit());
        delay.delay_us(5);
    }
}

/// Gives the pins to the peripherals that drive them: the motors' to timers that run with every channel off.
fn give_pins(gpioa: &GPIOA, gpiob: &GPIOB, gpioc: &GPIOC) {
    gpioa.afrl().modify(|_, w| w.afrl1().af1().afrl2().af7().afrl3().af7());
    gpioa.afrh().modify(|_, w| w.afrh8().af4().afrh15().af1());
    gpiob.afrh().modify(|_, w| w.afrh9().af2().afrh11().af1());
    gpioc.afrh().modify(|_, w| w.afrh9().af4());
    gpioa.moder().modify(|_, w| {
        w.moder1().alternate().moder2().alternate().moder3().alternate().moder8().alternate().moder15().alternate()
    });
    gpiob.moder().modify(|_, w| w.moder9().alternate().moder11().alternate());
    gpioc.moder().modify(|_, w| w.moder9().alternate());
}

/// Waits by counting the processor's cycles.
struct Delay {
    core_hz: u32,
}

impl DelayNs for Delay {
    fn delay_ns(&mut self, ns: u32) {
        cortex_m::asm::delay((ns / 1000 + 1).saturating_mul(self.core_hz / 1_000_000));
    }
}
