//! The Crazyflie controller through its C interface.

mod any;
mod faults;
mod flights;
mod header;
mod in_air;
mod object;
mod setpoints;
mod stream;
mod survival;
mod tables;
mod uploads;
