//! Campaigns: a scenario with distributions over its figures and a number of runs in; a row for each flight, a
//! summary of each law, and a page to look at, out.
//!
//! ```text
//! report, picture    a folder -> a page to look at; success over every drawn figure
//!   mcap             a flight for Foxglove and PlotJuggler
//!   summary          rows -> success, percentiles, worst flights, the figures that matter most
//!     statistics     intervals, quantiles, ranks
//!   merge            shards -> one folder; which shard is missing
//!     fly            runs on all cores -> rows in order, resumed where they end
//!       folder       the files on disk: the definition, rows as CSV, the same as Parquet
//!         definition  a file -> scenarios by number
//!           vary     distributions over the figures of a file
//!             draws  random numbers by seed, run and figure
//!         row        one flight of one law
//!         shard      the runs of each shard
//!           error    why there is no campaign
//! ```
//!
//! Run k is the same alone, in any shard and on any number of cores, to the byte: its figures and the seed of its noise are
//! functions of the campaign's seed, k and the figure's name, and of nothing else.

pub mod definition;
pub mod draws;
mod error;
pub mod fly;
pub mod folder;
#[cfg(feature = "mcap")]
pub mod mcap;
pub mod merge;
pub mod picture;
pub mod report;
pub mod row;
pub mod shard;
pub mod statistics;
pub mod summary;
pub mod vary;

pub use definition::Campaign;
pub use error::CampaignError;
pub use folder::Folder;
pub use row::{Outcome, Row};
pub use shard::Shard;
