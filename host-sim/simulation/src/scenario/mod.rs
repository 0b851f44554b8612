//! A scenario: a craft, its air, what is wrong with what is known of it, a course and a law, in one file that every command
//! flies.

mod checked;
pub mod compare;
pub mod course;
mod error;
pub mod file;
pub mod flight;
mod laws;
mod object_law;
pub mod sensors;

pub use checked::{AirFigures, CourseChoice, FilterFigures, Scenario, TrueFigures};
pub use error::ScenarioError;
pub use laws::{Law, LawError, ToldFigures};
