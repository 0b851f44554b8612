//! The figures that explain flights best: inverse dynamics with priors, and intervals by block bootstrap.
//!
//! ```text
//! whole            all figures of some flights
//!   contradiction  two fits beside each other
//!   slow_log       figures that a log slower than the grid does not tell
//!   figures        each told with an interval, or refused with a manoeuvre
//!     estimate     its interval by draws
//!   model          the model of the most likely figures, and the share that it explains
//!   posterior      the choice of one of two, and draws of it
//!   refine         maximum a posteriori by filters: thrust, torque balance, lag, delay and noise together
//!     fisher       its normal equations by blocks of time
//!       innovations  of a Kalman filter that knows the figures
//!         layout   the parameters: their places, start values and priors
//!           steady the steady Kalman filter of a model
//!   balanced       the same by the balances of torques and thrust below the corner
//!   drag, yaw      regressions by themselves
//!   thrust         by how much the command's power may be larger
//!   balance        torques along a stretch of flight, for pictures
//!     lag_curve    how much of the torques a lag explains
//!       problem    signals of the balances, as logged and low-passed
//!       normal_equations  steps and draws with priors
//!         bootstrap, prior
//! ```

mod balance;
mod balanced;
mod bootstrap;
mod contradiction;
mod drag;
mod estimate;
mod figures;
mod fisher;
mod innovations;
mod lag_curve;
mod layout;
mod model;
mod normal_equations;
mod posterior;
mod prior;
mod problem;
mod refine;
mod slow_log;
mod steady;
mod thrust;
mod whole;
mod yaw;

pub use balance::Balance;
pub use estimate::Estimate;
pub use lag_curve::LagPoint;
pub use model::FlightFit;
pub(crate) use model::Model;
pub use prior::Base;
pub use whole::{Fit, fit};

/// Corner of the low-pass of all balances, Hz: above, logs of 100 Hz are noise and interpolation.
pub(crate) const CORNER_HZ: f64 = 6.0;
/// Left out at either end of a section, s: the lag and the low-pass begin there.
pub(crate) const MARGIN_S: f64 = 0.5;
/// Length of a block, s: longer than the correlation time of disturbances.
pub(crate) const BLOCK_S: f64 = 3.0;
