//! The Crazyflie's firmware around our controller, in simulation: courses flown through the controller's C interface on
//! the rigid plant; tracking errors out.
//!
//! ```text
//! report        rows of flights
//!   flight      a course, a craft and its deviations -> errors
//!     firmware  the stabilizer at 1 kHz: commander, gyroscope, controller, power distribution
//!       setpoints  the forms in which setpoints are sent
//!       course  the course that the high-level commander evaluates
//!       standard   the standard cascade of a vehicle, certified once
//!         own_craft  a craft that the controller does not know, with its table
//!     recording  calls of the controller as they lie in the target's memory
//! paper_limits  limits of the paper's laws as a source of the controller
//! ```

mod course;
mod firmware;
mod flight;
mod own_craft;
mod paper_limits;
mod recording;
mod report;
mod setpoints;
mod standard;

pub use course::{Course, CourseError, Septics};
pub use firmware::{Firmware, STEPS_HZ, Sensors, Tune, knows, platform};
pub use flight::{Case, FlightErrors, Recorded, fly, fly_on, fly_recorded};
pub use own_craft::{OwnCraftError, craft_header, own_craft, standard_design, standard_force_input};
pub use paper_limits::{CodegenError, paper_limits};
pub use quatrack_crazyflie::own_craft::{MAGIC as CRAFT_MAGIC, OwnCraft};
pub use recording::{CONTROL_BYTES, Recording};
pub use report::{CrazyflieReport, Row};
pub use setpoints::Setpoints;
pub use standard::{StandardCascade, StandardError, standard_cascade};
