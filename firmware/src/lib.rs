//! The quatrack controller on an STM32F405: states and orders in over a link, commands out at a fixed rate.
//!
//! ```text
//! bin                           one image each: main (the line), pipes (the emulator's), measure, control_path
//!   tick                        the bodies of the timer's interrupts
//!     board                     clocks, pins, timers of one board
//!       transport               bytes over a USART, or over files of the emulating machine
//!         semihosting           files and the exit of that machine (feature `semihosting`)
//!       counter, stack, record  the free-running timer; the painted stack; the fault that outlives a restart
//!       log                     defmt's frames, in a ring that a debug probe reads
//!       panic                   the handler that cannot link
//!     session                   frames in, orders to the flight, frames out
//!       flight                  states, orders, ticks in; gated commands and motor forces out
//!         laws                  which law is flown: built in, or of a loaded table
//!         playback, stored      the reference of a tick; the trajectories in flash
//!           vehicle             the craft: its tables' name, its way to the motors
//!             rates, timing     how often the loop ticks and steps; overruns, jitter, the longest step
//!       craft                   a flight's gyroscope and motors
//!         drivers               BMI088, brushed motors, battery, against the traits of `embedded-hal`
//!       provisioned             the keys that the image was given
//!         signature             gain tables that are signed with them
//!       kept                    uploads that survive a loss of power
//!         storage               one of them, in two slots, against the traits of `embedded-storage`
//! ```
//!
//! From `session` and `craft` down nothing knows the hardware, and all of it is tested on the host.
#![cfg_attr(not(test), no_std)]
#![warn(clippy::unwrap_used, clippy::expect_used)]

pub mod craft;
pub mod drivers;
pub mod flight;
pub mod kept;
pub mod laws;
pub mod playback;
pub mod provisioned;
pub mod rates;
#[cfg(feature = "motors")]
pub mod session;
pub mod signature;
pub mod storage;
pub mod stored;
pub mod timing;
pub mod vehicle;

#[cfg(target_os = "none")]
pub mod board;
#[cfg(target_os = "none")]
pub mod counter;
#[cfg(all(target_os = "none", feature = "log"))]
pub mod log;
#[cfg(target_os = "none")]
mod panic;
#[cfg(target_os = "none")]
pub mod record;
#[cfg(all(target_os = "none", feature = "semihosting"))]
pub mod semihosting;
#[cfg(target_os = "none")]
pub mod stack;
#[cfg(target_os = "none")]
pub mod tick;
#[cfg(target_os = "none")]
pub mod transport;
