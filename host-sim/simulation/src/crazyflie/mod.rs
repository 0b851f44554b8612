//! The Crazyflie's firmware around our controller, in simulation: courses flown through the controller's C interface on
//! the rigid plant; tracking errors out.
//!
//! ```text
//! report, count rows of flights; instructions a call on the emulated target
//!   flight      a course, a craft and what is wrong with it -> errors
//!     firmware  the stabilizer at 1 kHz: commander, gyroscope, controller, power distribution
//!       course  what the high-level commander evaluates
//! ```

mod codegen;
mod count;
mod course;
mod firmware;
mod flight;
mod recording;
mod report;

pub use codegen::{CodegenError, Design, Stated, motor_gains};
pub use count::{Counts, count};
pub use course::{Course, CourseError, Septics};
pub use firmware::{Firmware, STEPS_HZ, Sensors, Setpoints, Tune};
pub use flight::{Case, Flown, fly, fly_recorded};
pub use recording::Recording;
pub use report::{Report, Row};
