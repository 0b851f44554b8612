//! Flights: a trajectory, a law and a clock in; a log and its figures out.
//!
//! ```text
//! closed_loop        plant (1) under a law in continuous time, or under held commands at a rate
//!   core_loop        the f32 core in the loop: the one crossing between f64 and f32
//!   law, reference   the laws in f64; references sampled as in the paper, or exact
//! metrics, log       what a flight came to; its rows as CSV
//! ```

pub mod closed_loop;
pub mod core_loop;
pub mod law;
pub mod log;
pub mod metrics;
pub mod reference;

pub use crate::integrator;
