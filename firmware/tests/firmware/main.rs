//! The firmware above its hardware, on the host.

mod flight;
mod flight_motors;
mod gyro;
mod laws;
mod motors;
mod session;
