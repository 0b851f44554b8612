//! The Crazyflie's firmware around our controller, in simulation: courses flown through the controller's C interface on
//! the rigid plant; tracking errors out.
//!
//! ```text
//! report        rows of flights
//!   flight      a course, a craft and what is wrong with it -> errors
//!     firmware  the stabilizer at 1 kHz: commander, gyroscope, controller, power distribution
//!       course  what the high-level commander evaluates
//! ```

mod course;
mod firmware;
mod flight;
mod paper_limits;
mod recording;
mod report;

pub use course::{Course, CourseError, Septics};
pub use firmware::{Firmware, STEPS_HZ, Sensors, Setpoints, Tune, platform};
pub use flight::{Case, FlightErrors, Recorded, fly, fly_recorded};
pub use paper_limits::{CodegenError, paper_limits};
pub use recording::{CONTROL_BYTES, Recording};
pub use report::{CrazyflieReport, Row};
