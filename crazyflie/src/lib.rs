//! The quatrack controller in the Crazyflie's own firmware: an out-of-tree controller.
//!
//! Setpoints of any commander, the firmware's estimate, gyroscope and accelerometer go in at 1 kHz; the four motors' forces, or
//! force and torque, come out at 500 Hz.
//!
//! ```text
//! ffi                  the symbols that the firmware and our app call; the struct that they share
//!   service            parameters, logs, tables that are sent
//!     parameters       the owner's settings, in range
//!     upload           the packets of a table that is sent
//!     control          one step; observers and background work between steps; changes of the table
//!       inbox          the firmware's setpoint -> the change; below it there is no C setpoint
//!       shaping        requests that are no motion -> a motion with heading
//!         heading      headings, dated -> heading to its jerk, at every step
//!         stream       motions, dated -> position to crackle, at every step
//!           request    the request of a setpoint
//!       tables, own_craft  gains as flown; a craft with its table
//!         units        the firmware's units and conventions -> SI
//!           abi, motion, output
//!             craft    the firmware's build figures -> the craft
//!               builtin  the tables in the image
//!                 shared, try_cell, cycles  values that two tasks share without waiting; the cycle counter
//! ```
//!
//! The way of a setpoint goes down through each of these once:
//!
//! ```text
//! abi::Setpoint ──▶ inbox ──▶ Change ──┬─ Motion ──▶ stream, heading ──▶ sample at each step ──▶ law ──▶ forces
//!                                      ├─ Request ─▶ Flight::Stream ───────────┘                 ▲
//!                                      │             Flight::Guided ─▶ shaping ─▶ sample ────────┤
//!                                      │             Flight::Rates ──────────────▶ body-rate loop, firmware's mixer
//!                                      ├─ Bad ─────▶ the core's supervisor: to rest, slowly down
//!                                      └─ Off ─────▶ Flight::Off
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
pub mod ffi;
pub mod heading;
pub mod inbox;
pub mod motion;
pub mod output;
pub mod own_craft;
mod parameters;
pub mod request;
pub mod service;
pub mod shaping;
pub mod shared;
pub mod stream;
pub mod tables;
mod try_cell;
pub mod units;
pub mod upload;

#[cfg(target_os = "none")]
mod panic;
