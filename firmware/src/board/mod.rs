//! Boards: one module for each, with its pins and clocks. Below it are the peripherals of the STM32F405 behind the traits
//! of `embedded-hal`.

pub mod crazyflie_2_1;
pub mod flash;
pub mod i2c;
pub mod pwm;
pub mod rng;
