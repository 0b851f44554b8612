//! The controller: the measurements and the target in, a command or motor forces out, by any law.
//!
//! One composition for every product. A [`Law`] is one of the laws with its gain; a [`Controller`] is a law with the limits
//! that its commands keep to and the [`crate::Actuation`] that carries them to the motors. The memory of a flight is
//! apart, in [`Memory`], and serves every law: another controller can take over between two steps, at once or over a
//! [`Handover`].
//!
//! ```
//! use quatrack::gains::paper;
//! use quatrack::nalgebra::Vector3;
//! use quatrack::{Actuation, Airframe, Controller, Equilibrium, Limits, Measured, Memory, Output, Rate, Reference, State, Target};
//!
//! let airframe = Airframe::CRAZYFLIE_2_1;
//! let actuation = Actuation::new(&airframe, Rate::from_hz(500).ok_or("no rate")?)?;
//! let limits = Limits::of(&airframe, Vector3::new(20.0, 20.0, 5.0));
//! let controller = Controller::new(Equilibrium::new(&paper::LQR_E), limits).with_actuation(&actuation);
//! let mut memory = Memory::hovering(&airframe);
//!
//! let (state, body_rates) = (State::at_rest(Vector3::new(0.0, 0.0, 0.99)), Vector3::new(0.0, 0.0, 0.0));
//! let reference = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0)?;
//! let measured = Measured::new(&state).with_body_rates(&body_rates);
//! let output = controller.step(&mut memory, measured, Target::new(&reference))?;
//! // 1 cm too low: 100 m/s^2 per metre on top of gravity.
//! assert!(matches!(output, Output::Command(step) if (step.command.thrust_m_s2 - 10.81).abs() < 1e-3));
//! let forces_n = controller.carry(&mut memory, &output, measured)?.forces_n;
//! assert!(forces_n.iter().all(|force| (force - 0.25 * 0.029 * 10.81).abs() < 1e-4));
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```

mod carry;
mod controller;
mod handover;
mod input;
mod law;
mod leash;
mod memory;
mod output;
mod registers;
mod settings;

pub use controller::Controller;
pub use handover::Handover;
pub use input::{Measured, Target};
pub use law::Law;
pub use leash::Leash;
pub use memory::Memory;
pub use output::{MotorStep, Output, Step};
pub use settings::{ControllerError, Settings};
