//! The quatrack controller on an STM32F405: states and orders in over a link, commands out at a fixed rate.
//!
//! ```text
//! bin: main, measure        one image each
//!   board                   pins, clocks and timers of one board
//!   semihosting             files of the machine that emulates or debugs (feature `semihosting`)
//!   counter                 the free-running timer that the loop is watched with
//!   panic                   the handler that cannot link
//!   stored                  the trajectories in flash
//!   laws                    the four controllers by number
//!   control                 the loop, against traits: no hardware
//! ```
#![cfg_attr(not(test), no_std)]

pub mod control;
#[cfg(target_os = "none")]
pub mod counter;
pub mod laws;
pub mod stored;

#[cfg(target_os = "none")]
mod panic;
#[cfg(all(target_os = "none", feature = "semihosting"))]
pub mod semihosting;
