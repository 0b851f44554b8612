//! Gain tables made offline: constants in the image, checked when it is compiled, and files, checked when they are
//! loaded.

#[cfg(feature = "cascade")]
#[rustfmt::skip]
pub mod cascade;
mod constant;
pub mod paper;
pub mod table;

pub use constant::{ConstantGain, Decoupled, Scales};
