//! The paper's Table I: both trajectories, all four controllers, as published and as they should be; a table with a
//! verdict per cell out. And past it: more designs, feed-forward, held commands.

pub mod extensions;
mod extensions_report;
pub mod published;
pub mod report;
pub mod table;
