//! A log as it was recorded: named series of times and values out of a file; by a map of columns, the quantities of a flight in SI.
//!
//! ```text
//! takes       flights that share a file
//! map         which columns hold what, in which unit; three that are built in
//! table       CSV, plain or compressed      deck   the micro SD deck's binary log
//!   series    times and values by name
//! ```

mod deck;
mod map;
mod series;
mod table;
mod takes;

pub use map::ColumnMap;
pub(crate) use map::{Scalar, Vector, scale};
pub use series::{RawLog, Series};

use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

use crate::IdentifyError;

/// More than a log takes, plain: half an hour of 30 columns at 1 kHz. A device that never ends is read up to here.
const MOST_BYTES: u64 = 512 << 20;

/// Reads a log: the micro SD deck's binary format is known by its first byte, gzip by its first two; all else is CSV.
///
/// # Errors
/// [`IdentifyError`] for a file that cannot be read or has no rows.
pub fn read(path: &Path) -> Result<RawLog, IdentifyError> {
    let name = path.display().to_string();
    let bytes = File::open(path)
        .and_then(|file| whole(file, MOST_BYTES))
        .map_err(|error| IdentifyError::Unreadable { path: name.clone(), reason: error.to_string() })?;
    let bytes = if bytes.starts_with(&[0x1f, 0x8b]) {
        whole(flate2::read::MultiGzDecoder::new(&bytes[..]), MOST_BYTES).map_err(|error| {
            let reason = match error.kind() {
                io::ErrorKind::FileTooLarge => error.to_string(),
                _ => format!("this gzip file is not whole ({error})"),
            };
            IdentifyError::Format { path: name.clone(), reason }
        })?
    } else {
        bytes
    };
    if bytes.first() == Some(&deck::MAGIC) { deck::parse(&bytes, &name) } else { table::parse(&bytes, &name) }
}

/// All that there is to read, at most so many bytes.
fn whole(from: impl io::Read, most_bytes: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    from.take(most_bytes + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most_bytes {
        let reason = format!("longer than {} MB, or a device without an end; cut the log", most_bytes >> 20);
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, reason));
    }
    Ok(bytes)
}

/// From the bytes of a file that has been read already.
///
/// # Errors
/// As [`read`].
pub fn parse_csv(bytes: &[u8], name: &str) -> Result<RawLog, IdentifyError> {
    table::parse(bytes, name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_no_end_is_read_up_to_the_bound() {
        let said = whole(io::repeat(0), 1 << 20).unwrap_err();
        assert_eq!(said.to_string(), "longer than 1 MB, or a device without an end; cut the log");
        assert_eq!(whole(&[7; 9][..], 9).unwrap(), [7; 9]);
    }
}
