//! Planning: waypoints and bounds, or files, in; trajectories of the flat output out.
//!
//! ```text
//! plan            waypoints and bounds -> B-spline, by second-order cone programming
//!   trajectory    B-splines, polynomial pieces, their files, fits for the Crazyflie
//!     bounded     files as far as any input is long
//!     quote       the part of a file that an error quotes, and its line
//! ```
//!
//! Below it is `quatrack_design`, of which it takes the flat output and gravity; conventions are those.

pub mod bounded;
pub mod plan;
pub mod quote;
pub mod trajectory;

/// The examples of the README, run as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
