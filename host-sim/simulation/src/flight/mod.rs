//! Flights: a trajectory, a law and a clock in; a log and its figures out.
//!
//! ```text
//! closed_loop        plant (1) under a law in continuous time, or under held commands at a rate
//!   core_loop        the f32 core in the loop: f64 states in, its commands out
//!   law, reference   the laws in f64; references sampled as in the paper, or exact
//!   reference_check  the parts of a reference that no law can follow
//! deviation          how far one reference is from another
//! rigid_loop         a craft with motors under commands at a rate, late and with noise if asked for
//!   motor_loop       the f32 core down to the motors in the loop
//!     motor_laws     actuator-aware tables and the paper's laws on a vehicle's motors
//!       robustness       the flights they are judged by
//! metrics, log       results of a flight; its rows as CSV
//! ```

pub mod closed_loop;
pub mod core_loop;
pub mod deviation;
pub mod law;
pub mod log;
pub mod metrics;
pub mod motor_laws;
pub mod motor_loop;
pub mod noise;
pub mod reference;
pub mod reference_check;
pub mod rigid_loop;
pub mod robustness;
