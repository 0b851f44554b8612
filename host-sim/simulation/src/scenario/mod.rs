//! A scenario: a craft, its air, its deviations, a course and a law, in one file that every command
//! flies.
//!
//! ```text
//! compare            laws beside each other
//! varied             one more thing wrong at a time
//! manoeuvres         take-off, landing, step, shove, gust, start upside down
//!   checked, checks  a file -> a scenario whose every value has been looked at, or one line that says why not
//!     whole          the scenario; its flights
//!       flight       a plant, sensors and a law at 1 kHz
//!         filtered   the estimate of a Kalman filter
//!           sensors  noise and biases
//!         kept       rows of a flight, or their sums
//!         log        a recording as the log of a craft
//!           recording  a flight with its estimates and surroundings, as CSV
//!         track      a course evaluated once
//!         course     hover, ramp, and the measured part
//!       prototype    a law designed once for many flights
//!       laws         laws by name
//!         object_law the Crazyflie controller as a law
//!       table_law    a table of gains as a law
//!         cascade_law  the core's cascade as a law
//!         core_law   the core's other laws
//!           not_flown  why a law does not fly a vehicle
//!   told             what a law is told, and the ranges in which it is taken
//!   file             the keys in TOML
//!     non_finite   the first number that is not finite
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
mod kept;
mod laws;
mod log;
pub mod manoeuvres;
mod non_finite;
mod not_flown;
mod object_law;
mod prototype;
mod recording;
pub mod sensors;
mod table_law;
mod told;
mod track;
mod varied;
mod whole;

pub use cascade_law::{cascade_of_table, flown_cascade};
pub use core_law::{actuation_of, actuator_aware_of};
pub use error::{ScenarioError, StartError};
pub use kept::Tally;
pub use laws::{Law, LawError};
pub use log::{LogRow, cflib_csv};
pub use not_flown::NotFlown;
pub use prototype::Prototype;
pub use recording::{Around, Recording};
pub use sensors::SensorNoise;
pub use table_law::{TableLawError, start_table};
pub use told::{ToldError, ToldFigures};
pub use track::Track;
pub use whole::{CourseChoice, FilterFigures, Scenario, Side, StartOffset};
