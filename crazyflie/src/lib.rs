//! The quatrack controller in the Crazyflie's own firmware: an out-of-tree controller.
//!
//! Setpoints of any commander, the firmware's estimate and the gyroscope go in at 1 kHz; force and torque, or the four
//! motors' forces, come out at 500 Hz.
//!
//! ```text
//! ffi            the symbols that the firmware and our app call; what they share
//!   service      parameters, logs, tables that are sent
//!     upload     the packets of a table that is sent
//!     control    one step; changes of the table
//!       guide    demands -> a motion with heading
//!         stream, turning  setpoints at 100 Hz -> position to crackle, heading to its jerk, at every step
//!       tables   gains as flown
//!       edge     the firmware's units and conventions -> SI
//!         abi, demand, output
//!           craft  what the firmware was built for -> which craft
//!             builtin  the tables in the image
//!               shared, try_cell, cycles  what two tasks share, and without waiting; the cycle counter
//! ```
//!
//! On the target it is linked into one object whose only symbols are those of [`ffi`]; on a desk the same code flies in
//! simulation, through the same calls.
#![cfg_attr(target_os = "none", no_std)]
#![warn(clippy::unwrap_used, clippy::expect_used)]

pub mod abi;
mod builtin;
pub mod control;
pub mod craft;
mod cycles;
pub mod demand;
pub mod edge;
pub mod ffi;
pub mod guide;
pub mod output;
pub mod service;
pub mod shared;
pub mod stream;
pub mod tables;
mod try_cell;
pub mod turning;
pub mod upload;

#[cfg(target_os = "none")]
mod panic;
