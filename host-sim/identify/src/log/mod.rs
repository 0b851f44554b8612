//! A log as it was recorded: named series of times and values out of a file; by a map of columns, the quantities of a flight in SI.
//!
//! ```text
//! takes       flights that share a file
//! map         which columns hold what, in which unit; three that are built in
//! record      a log out of rows
//! table       CSV, plain or compressed      deck   the micro SD deck's binary log
//!   series    times and values by name
//! ```

mod deck;
mod map;
mod record;
mod series;
mod table;
mod takes;

pub use map::ColumnMap;
pub(crate) use map::{Scalar, Vector, scale};
pub use record::{Row, cflib_csv};
pub use series::{RawLog, Series};

use std::path::Path;

use crate::IdentifyError;

/// Reads a log: the micro SD deck's binary format is known by its first byte, gzip by its first two; all else is CSV.
///
/// # Errors
/// [`IdentifyError`] for a file that cannot be read or has no rows.
pub fn read(path: &Path) -> Result<RawLog, IdentifyError> {
    use std::io::Read as _;
    let name = path.display().to_string();
    let bytes = std::fs::read(path)
        .map_err(|error| IdentifyError::Unreadable { path: name.clone(), reason: error.to_string() })?;
    let bytes = if bytes.starts_with(&[0x1f, 0x8b]) {
        let mut plain = Vec::new();
        flate2::read::MultiGzDecoder::new(&bytes[..]).read_to_end(&mut plain).map_err(|error| {
            IdentifyError::Format { path: name.clone(), reason: format!("this gzip file is not whole ({error})") }
        })?;
        plain
    } else {
        bytes
    };
    if bytes.first() == Some(&deck::MAGIC) { deck::parse(&bytes, &name) } else { table::parse(&bytes, &name) }
}

/// From the bytes of a file that has been read already.
///
/// # Errors
/// As [`read`].
pub fn parse_csv(bytes: &[u8], name: &str) -> Result<RawLog, IdentifyError> {
    table::parse(bytes, name)
}
