//! Plants to fly against: commanded motor forces in, the motion of a craft out.
//!
//! A [`Craft`] is put together from parts that know nothing of each other: a [`RigidBody`] that turns forces and torques
//! into motion, a [`MotorBank`] that turns commands into thrusts and their sum into force and torque, and any number of
//! [`Load`]s, whatever else pushes the body. The state is position, velocity (world frame), attitude, body rates (body
//! frame) and the four thrusts. What stands between plant and controller, sensors and the way of a command, belongs to
//! the flight.

mod body;
mod craft;
mod loads;
mod motors;
mod state;

pub use body::RigidBody;
pub use craft::Craft;
pub use loads::{Ground, Load, Shove, Wrench};
pub use motors::{Motor, MotorBank};
pub use state::RigidState;
