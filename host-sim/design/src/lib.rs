//! Gains for a quadcopter and their certificates, in f64: Riccati and Lyapunov equations, continuous and sampled, solved
//! to the last digits and checked; the model of the craft; certificates.
//!
//! In flow a pair (A, B) and weights, or a vehicle; out flow gains, the solutions of their equations with residuals, and
//! margins. Nothing is read from files here and nothing is drawn. The layers import only downwards:
//!
//! ```text
//! certify       certificates of a gain as flown: poles, margins, delay and lag
//!   design      Section IV: Lyapunov and Riccati equations, the four gains, gains for a control rate
//!   analysis    Section III: poles, Jordan blocks, controllability
//!     vehicle   mass, inertia, motors and limits of a craft
//!       model   Section II: the model (1), its linearisations, the flat map
//! ```
//!
//! Conventions: world frame z up, quaternion scalar first, Hamilton product, body to world; thrust is divided by mass
//! (m/s^2), body rates in rad/s; SI everywhere. Sections and equations are those of the paper that the `quatrack`
//! repository reproduces.

/// The README's examples are compiled and run.
#[doc = include_str!("../README.md")]
#[cfg(doctest)]
pub struct Readme;

/// The matrices, in the version that this crate takes and gives.
pub use nalgebra;

pub mod analysis;
pub mod certify;
pub mod design;
pub mod model;
pub mod vehicle;
