//! Gain tables that somebody may fly: design files in; gains, certificates and tables out, or the figure that fails.
//!
//! ```text
//! check          committed files against their designs' output today
//!   built_in     the core's own tables of the cascade
//!   artifacts    NAME.json, NAME.rs, NAME.bin
//!     certified  gains, certificate, the table; the design's own minimum
//!       board_certificate  the figures that a table carries, the same on every processor
//!       table      of any kind, as bytes
//!       designed   the gain in f64, and the loop it is certified in
//!         kinds    gains by the law that flies them
//!         model    the linear model, and the weights
//!         unsolved why there is none: the states to blame
//!         design   entries in range that fit together
//!           file   TOML
//!           course the trajectory of gains over time, as the board stores it
//! curves         loop gain, sensitivity and steps, to be drawn
//! export         A, B, Q, R, K, P, poles, T_e for other tools
//! ```
//!
//! A kind of table is a variant of [`Gains`]; a method a variant of [`Method`] under the [`Problem`] that it is for.

mod artifacts;
mod board_certificate;
mod built_in;
mod certified;
mod check;
mod course;
mod curves;
mod design;
mod designed;
mod error;
mod export;
mod file;
mod kinds;
mod model;
mod names;
mod rounding;
mod table;
mod unsolved;

pub use artifacts::{Artifact, artifacts, default_folder, json_document, rust_source};
pub use board_certificate::BoardCertificate;
pub use built_in::{BuiltInError, built_in_source};
pub use certified::Certified;
pub(crate) use check::Comparison;
pub use check::{Checked, Failed, check_design, check_folder, designs};
pub use course::OnBoardTrajectory;
pub use curves::{CutLoop, LoopCurves, StepResponse};
pub use design::{Design, IdentifiedBound, Method, Problem};
pub use designed::{Designed, Poles};
pub use error::GainsError;
pub use export::{Export, Matrix};
pub use kinds::{Gains, TableRows};
pub use model::{LinearModel, SampledProblem, Weights};
pub use names::{Signal, signals};
pub use table::Table;
