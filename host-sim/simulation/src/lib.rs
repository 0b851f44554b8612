//! The host side of quatrack, in f64: what the paper does with pencil, MATLAB and a solver.
//!
//! In flow the equations of the paper, weights, waypoints and trajectory files; out flow gains, plans, flights, tables
//! and figures. The layers import only downwards:
//!
//! ```text
//! pil                             the image on its processor, emulated or real: flown, compared, counted
//! reproduction, figures           Table I and Figures 2 to 5
//!   flight                        plants under laws in f64 and under the f32 core, metrics
//!     plan                        waypoints and bounds -> B-spline, by second-order cone programming
//!       trajectory                B-splines, polynomial pieces, their files, fits for the Crazyflie
//!   gains                         design files -> certified tables, their check, exchange with other tools
//!   certify                       what a gain as flown promises: poles, margins, delay and lag
//!     design                      Section IV: Lyapunov and Riccati equations, the four gains, gains for a control rate
//!     analysis                    Section III: poles, Jordan blocks, controllability
//!       model                     Section II: the model (1), its linearisations
//!   plant                         a rigid body with motors that lag and saturate, and what else pushes it
//!     vehicle, integrator         mass, inertia, motors and limits of a craft, from TOML; one-step methods
//! ```
//!
//! Conventions: world frame z up, quaternion scalar first, Hamilton product, body to world; thrust is divided by mass
//! (m/s^2), body rates in rad/s; SI everywhere.

pub mod analysis;
pub mod certify;
pub mod crazyflie;
pub mod design;
pub mod figures;
pub mod flight;
pub mod gains;
pub mod integrator;
pub mod model;
pub mod pil;
pub mod plan;
pub mod plant;
pub mod reproduction;
pub mod trajectory;
pub mod vehicle;
