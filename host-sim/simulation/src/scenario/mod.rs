//! A scenario: a craft, its air, what is wrong with what is known of it, a course and a law, in one file that every command
//! flies.
//!
//! ```text
//! compare            laws beside each other
//! varied             one more thing wrong at a time
//!   checked, checks  a file -> a scenario whose every value has been looked at, or one line that says why not
//!     whole          the scenario; its flights
//!       flight       a plant, sensors and a law at 1 kHz
//!         filtered   the estimate of a Kalman filter
//!           sensors  noise and biases
//!         recording  a flight with what was around it, as CSV
//!         course     hover, ramp, and what is measured
//!       laws         laws by name
//!         object_law the Crazyflie controller as a law
//!       table_law    the controller of a table of gains as a law
//!         core_law   the core's controller as a law
//!   file             the keys in TOML
//! ```

mod cascade_law;
mod checked;
mod checks;
pub mod compare;
mod core_law;
pub mod course;
mod error;
pub mod file;
pub mod filtered;
pub mod flight;
mod laws;
mod object_law;
mod recording;
pub mod sensors;
mod table_law;
mod varied;
mod whole;

pub use cascade_law::{CascadeLaw, cascade_of};
pub use core_law::{actuation_of, actuator_aware_of};
pub use error::{ScenarioError, StartError};
pub use laws::{Law, LawError, ToldFigures, start_table};
pub use recording::{Around, Recording};
pub use sensors::SensorNoise;
pub use table_law::TableLaw;
pub use whole::{CourseChoice, FilterFigures, Scenario, StartOffset};
