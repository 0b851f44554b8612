//! Figures of a craft from logs of its flights: logs in; motor lag and delay, thrust by command and voltage, drag, airflow moment and
//! inertia, each with a 95 % interval or a reason why it is not known, out.
//!
//! ```text
//! report          from logs to the report
//!   vehicle_file  the figures as a vehicle that designs take
//!   regions       whether the craft is inside the certified regions of built-in tables
//!     predict     the flights again from commands, on a part held out
//!     fit         inverse dynamics, priors, block bootstrap
//!       flight    one even grid: checked, cleaned, aligned
//!         log     files and maps of their columns
//!           error, filter  why there is nothing; low-pass, derivative, shift, lag
//! ```
//!
//! Why not output error: its input, the logged commands, is noisy, and it inflates the inertia two- to threefold. The
//! maximised quantity is the likelihood of the innovations of Kalman filters, with process noise, where the filters'
//! model explains a flight; where it does not, as on real crafts, the balance of torques and of forces along the flight
//! as it was, below 6 Hz, is fitted.

#![allow(
    clippy::needless_range_loop,
    clippy::repeat_vec_with_capacity,
    reason = "an index is a time step or an axis here"
)]

mod error;
mod filter;
pub mod flight;
pub mod log;
pub mod predict;
mod regions;
mod report;
mod vehicle_file;

pub mod fit;

pub use error::IdentifyError;
use log::scale as log_scale;
pub use regions::Standing;
pub use report::{Document, Report, identify};
pub use vehicle_file::vehicle_toml;
