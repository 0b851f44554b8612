//! Certificates of a gain as it will be flown: rounded to f32, at its control rate, behind its actuators.
//!
//! In flow a plant, a controller, the timing of the loop and a model of the actuators' lag; out flows a [`Certificate`],
//! or the reason why there is none. Every figure is computed from the rounded gain:
//!
//! - poles in continuous time, and per sample under hold; P > 0 with its decrease checked after P was rounded;
//! - disk margins at the plant's input, each channel alone and all at once, from the peak of the sensitivity;
//! - the largest delay and the largest actuator lag up to which the sampled loop stays stable.
//!
//! A loop that decouples into independent chains, as those of hover do, is taken apart first: its figures are then
//! exact for all channels at once, too. [`certify_along`] does the same for gains over time. [`certify_region`] holds an
//! actuator-aware gain against a region of lags, masses, inertias and delays, [`mod@cascade`] the cascade with its
//! observers and the air as well. [`require`] holds a certificate against the
//! least that a design asks for.
//!
//! Reference: Seiler, Packard and Gahinet, An Introduction to Disk Margins, IEEE Control Systems Magazine 2020.

mod along;
pub mod cascade;
mod certificate;
mod constant;
mod decrease;
mod error;
mod limits;
mod linear_loop;
mod margins;
mod minimum;
mod plant;
mod region;
mod response;
mod rounding;
mod sampled_loop;
mod structured;
mod sweep;

pub use along::{MovingDecrease, certify_along, moving_decrease};
pub use certificate::{AlongFigures, Certificate, ContinuousLoop, SampledLoopFigures};
pub use constant::certify;
pub use decrease::Decrease;
pub use error::CertifyError;
pub use limits::StabilityLimit;
pub use margins::{AllChannels, ChannelMargins, DiskMargin, LoopMargins};
pub use minimum::{Judged, MarginTooSmall, Minimum, Quantity, judge, require};
pub use plant::{Controller, LagModel, Plant, Predictor, Timing};
pub use region::{Region, RegionBounds, RegionCertificate, Variation, certify_region, motor_lag_limit};
pub use response::LoopResponse;
pub use rounding::Rounding;
pub use structured::{StructuredBounds, structured_bounds};
