//! Flights: vehicles, plants, gains and trajectories in; flights with their errors out. In f64, and with the `f32` core
//! and the Crazyflie controller as they are on board.
//!
//! ```text
//! generated            every generated file of a checkout against its right contents
//! scenario             one file that every command flies: a craft, its air, a course and a law
//!   rivals             Mellinger's and Lee's laws and the cascaded PID
//!     control_law      the interface by which a law flies
//! faults               flights with something wrong, under the supervisor
//! crazyflie            the Crazyflie's firmware around our controller
//! reproduction         Table I, and past it
//!   flight             plants under laws in f64 and under the f32 core, metrics
//!     plant            a rigid body with motors that lag and saturate, and other loads on it
//!       integrator     one-step methods
//!   gains              design files -> certified tables, their check, exchange with other tools
//!     vehicles         vehicles by name or from TOML files; their limits and number
//! ```
//!
//! Below it are `quatrack_plan` and `quatrack_design`; conventions are those of the latter.

pub mod control_law;
pub mod crazyflie;
pub mod faults;
pub mod flight;
pub mod gains;
pub mod generated;
pub mod integrator;
pub mod plant;
pub mod reproduction;
pub mod rivals;
pub mod scenario;
pub mod vehicles;
