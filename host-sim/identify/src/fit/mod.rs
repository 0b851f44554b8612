//! The figures that explain flights best: inverse dynamics with priors, and intervals by block bootstrap.
//!
//! ```text
//! whole            all figures of some flights
//!   refine         maximum a posteriori: thrust, torque balance, lag and delay together
//!   drag, yaw      regressions by themselves
//!   balance        torques along a stretch of flight, for pictures
//!     lag_curve    how much of the torques a lag explains
//!       problem    signals of the balance, low-passed; their residuals
//!         bootstrap, prior
//! ```

mod balance;
mod bootstrap;
mod drag;
mod lag_curve;
mod prior;
mod problem;
mod refine;
mod whole;
mod yaw;

pub use balance::Balance;
pub use lag_curve::LagPoint;
pub use prior::Base;
pub(crate) use whole::Model;
pub use whole::{Estimate, Fit, FlightFit, fit};

/// Corner of the low-pass of all balances, Hz: above, logs of 100 Hz are noise and interpolation.
pub(crate) const CORNER_HZ: f64 = 6.0;
/// Left out at either end of a section, s: the lag and the low-pass begin there.
pub(crate) const MARGIN_S: f64 = 0.5;
/// Length of a block, s: longer than what disturbances remember.
pub(crate) const BLOCK_S: f64 = 3.0;
