//! The paper's Table I: both trajectories, all four controllers, as published and as they should be; a table with a
//! verdict per cell out.

pub mod published;
pub mod report;
pub mod table;
