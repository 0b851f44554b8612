//! Plants to fly against: commanded motor forces in, the motion of a craft out.
//!
//! A [`Craft`] is put together from parts that know nothing of each other: a [`RigidBody`] that turns forces and torques
//! into motion, a [`MotorBank`] that turns commands into thrusts and their sum into force and torque, an [`Airflow`]
//! for the air's action on it, and any number of [`Load`]s for other forces on the body. Its state is position,
//! velocity (world frame), attitude, body rates (body frame) and the four thrusts. A [`Plant`] is a craft in one
//! flight: with a wind that blows, commands on their way, and a battery that empties. Sensors belong to the flight.
//!
//! ```text
//! side_by_side             several plants in the lanes of the vector unit
//! in_flight                Plant: one flight's craft, wind, delay, battery
//!   kernel                 the steps of plain craft, alone or side by side
//!   environment, truth     the surroundings of a flight; the true figures of its craft; checked once
//!   craft                  the equations of motion, and their steps
//!     air, propeller       drag, moment, lift; momentum and speed of the rotors
//!     motors, body         lag and limits; mass and inertia
//!     loads, contact, ground_effect
//!   wind, dryden, random   motion of the air; turbulence; numbers that repeat
//!   supply, delay          force by command and voltage, battery; transport delay
//! ```

mod air;
mod body;
mod contact;
mod craft;
mod delay;
mod dryden;
mod environment;
mod ground_effect;
mod in_flight;
mod kernel;
mod loads;
mod motors;
mod propeller;
mod random;
mod refused;
mod side_by_side;
mod state;
mod supply;
mod truth;
mod wind;

pub use air::{Airflow, RotorDrag};
pub use body::RigidBody;
pub use contact::{Contact, Wall};
pub use craft::{Craft, LinearWind, Motion};
pub use dryden::Dryden;
pub use environment::{Air, Environment};
pub use ground_effect::GroundEffect;
pub use in_flight::Plant;
pub use loads::{Ground, Load, Shove, Wrench};
pub use motors::{Motor, MotorBank};
pub use propeller::{Propeller, SpeedResponse};
pub use random::{Source, Stream};
pub use refused::PlantError;
pub use side_by_side::PlantGroup;
pub use state::RigidState;
pub use supply::{Battery, CURVE_POINTS, ForceMap, Supply};
pub use truth::Truth;
pub use wind::{Gust, Wind};
