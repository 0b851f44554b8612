//! The Crazyflie controller through its C interface.

mod any;
mod flights;
mod header;
mod object;
mod setpoints;
mod stream;
mod tables;
