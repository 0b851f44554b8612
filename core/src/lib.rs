//! Quaternion-based trajectory tracking for small quadcopters, after "Trajectory Tracking with a Quaternion-based
//! Quadcopter Model": an estimated state and a reference in, thrust and body rates out, at a fixed rate.
//!
//! No `std`, no allocation, no panic, `f32`, and the same bits on every target. Gains are computed offline and are stored
//! in [`gains`].
//!
//! ```
//! use quatrack::{Controller, Equilibrium, Limits, Measured, Memory, Output, Reference, State, Target};
//! use quatrack::{gains, nalgebra::Vector3};
//!
//! let limits = Limits::new(1.8, 16.5, Vector3::new(20.0, 20.0, 5.0))?;
//! let controller = Controller::new(Equilibrium::new(&gains::paper::LQR_E), limits);
//! let mut memory = Memory::at_rest();
//! let state = State::at_rest(Vector3::new(0.0, 0.0, 0.9));
//! let reference = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0)?;
//! let output = controller.step(&mut memory, Measured::new(&state), Target::new(&reference))?;
//! let Output::Command(step) = output else { unreachable!("the law gives thrust and body rates") };
//! // 10 cm too low: 100 m/s^2 per metre on top of gravity, cut to the range of the motors.
//! assert_eq!(step.command.thrust_m_s2, 16.5);
//! assert!(step.limited.thrust());
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
//!
//! The layers import only downwards:
//!
//! ```text
//! link                        frames, uploads (feature `link`)
//!   gains                     tables of every kind
//!     control                 any law down to command or motor forces; its memory; the handover to another
//!       supervisor            whether its output may pass
//!       cascade               nested loops with limits, observers, air; with its gains
//!       law                   equilibrium (E), flat output (F), integral action, gains along a trajectory, actuator-aware
//!         trajectory          pieces played by ticks
//!           motor_reference   flat output -> motor forces and commands
//!             actuation         a craft's way to its motors, at a control rate
//!             body_rate, mixer  command -> wrench -> motor forces
//!               airframe      mass, inertia, levers, range and lag of the motors
//!           reference         flat output -> state and input, checked
//!           estimator         inertial sensors and positions -> state, covariance, innovations
//!             flatness        the flat map and its inverse
//!               state, rigid_state, command, gain, motor_lag, clock
//!                 quaternion, error
//!                   math, checksum  square root, sine and cosine; CRC-32C
//! ```
//!
//! Features, none of them default: `cascade` for the law of nested loops; `actuator-aware` for the law before it, a rival in
//! simulation; `link` for the serial link's frames; `serde` and `defmt` for plain data to be stored or logged.
//!
//! Conventions: world frame z up; quaternion scalar first, Hamilton product, body to world; thrust divided by mass, in
//! m/s^2; body rates in rad/s.
#![no_std]
#![warn(clippy::unwrap_used, clippy::expect_used)]

#[cfg(test)]
extern crate std;

pub mod actuation;
pub mod airframe;
pub mod body_rate;
#[cfg(feature = "cascade")]
pub mod cascade;
pub mod checksum;
pub mod clock;
pub mod command;
pub mod control;
#[cfg(feature = "defmt")]
mod defmt_formats;
pub mod error;
pub mod estimator;
pub mod flatness;
pub mod gain;
pub mod gains;
pub mod law;
#[cfg(feature = "link")]
pub mod link;
pub mod math;
pub mod mixer;
pub mod motor_lag;
pub mod motor_reference;
pub mod quaternion;
pub mod reference;
pub mod rigid_state;
pub mod state;
pub mod supervisor;
pub mod trajectory;

pub use nalgebra;

pub use actuation::Actuation;
pub use airframe::{Airframe, AirframeFigures};
pub use body_rate::BodyRateLoop;
#[cfg(feature = "cascade")]
pub use cascade::{Air, Cascade, CascadeGains, CascadeInput, CascadeLimits, CascadeMemory, Followed};
pub use clock::{Rate, Tick};
pub use command::{Command, Limited, Limits};
pub use control::{
    Controller, ControllerError, Handover, Law, Leash, Measured, Memory, MotorStep, Output, Settings, Step, Target,
};
pub use error::{ReferenceError, StateError, StepError};
#[cfg(feature = "actuator-aware")]
pub use law::{ActuatorAware, ActuatorAwareGain};
pub use law::{AlongTrajectory, Equilibrium, ErrorForm, FeedForward, FlatOutput, IntegralAction};
pub use mixer::{MotorLimited, Wrench};
pub use motor_lag::{MotorForces, MotorLag};
pub use motor_reference::{FifthOrderSample, MotorReference};
pub use quaternion::{Heading, Quaternion};
pub use reference::{FlatSample, Reference};
pub use rigid_state::RigidState;
pub use state::State;
pub use trajectory::{Bookmark, Piece, Player, Progress, Trajectory};
