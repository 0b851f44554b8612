//! Files as far as any input is long: a device that never ends is read up to there, and refused.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

use crate::quote::line_at;

/// More than any file that is read whole takes.
pub const MOST_BYTES: u64 = 64 << 20;

/// The bytes of a file.
///
/// # Errors
/// The system's, and [`io::ErrorKind::FileTooLarge`] beyond [`MOST_BYTES`].
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(MOST_BYTES + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MOST_BYTES {
        let reason = format!("longer than {} MB, or a device without an end", MOST_BYTES >> 20);
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, reason));
    }
    Ok(bytes)
}

/// The same as text.
///
/// # Errors
/// As [`read`], and [`io::ErrorKind::InvalidData`] with the line that is not UTF-8.
pub fn read_to_string(path: &Path) -> io::Result<String> {
    String::from_utf8(read(path)?).map_err(|error| {
        let line = line_at(error.as_bytes(), error.utf8_error().valid_up_to());
        io::Error::new(io::ErrorKind::InvalidData, format!("line {line} is not UTF-8; save the file as UTF-8 text"))
    })
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_device_without_an_end_is_refused() {
        let said = read_to_string(Path::new("/dev/zero")).unwrap_err();
        assert_eq!(said.to_string(), "longer than 64 MB, or a device without an end");
        assert!(read(Path::new("/dev/null")).unwrap().is_empty());
    }

    #[test]
    fn the_line_that_is_not_text_is_named() {
        let file = std::env::temp_dir().join(format!("quatrack-bounded-{}", std::process::id()));
        std::fs::write(&file, b"a = 1\nb = \xff\n").unwrap();
        let said = read_to_string(&file).unwrap_err().to_string();
        std::fs::remove_file(&file).unwrap();
        assert_eq!(said, "line 2 is not UTF-8; save the file as UTF-8 text");
    }
}
