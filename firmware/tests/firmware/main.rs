//! The firmware above its hardware, on the host.

mod flight;
mod flight_motors;
mod gyro;
mod kept_uploads;
mod keyed_session;
mod laws;
mod leash;
mod motors;
mod session;
mod signed_tables;
