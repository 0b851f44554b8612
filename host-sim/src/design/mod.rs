//! x
pub mod synthesis;
