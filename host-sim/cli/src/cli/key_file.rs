//! Files of keys: 64 hexadecimal digits in, 32 bytes out, and back. A reader of one has the key.

use std::fs;
use std::io::{Read as _, Write as _};
use std::path::Path;

use quatrack::link::KEY_BYTES;

use super::Failure;

/// Most bytes that a file of a key has, with an editor's characters behind it.
const FILE_BYTES_MAX: u64 = 200;

/// The key of a file.
pub(crate) fn read(path: &Path) -> Result<[u8; KEY_BYTES], Failure> {
    let refused = |reason: &str| Failure::input(format!("{}: {reason}", path.display()));
    // No more than a key has: a device may have no end.
    let mut bytes = Vec::new();
    let read = fs::File::open(path).and_then(|file| file.take(FILE_BYTES_MAX).read_to_end(&mut bytes));
    read.map_err(|error| refused(&format!("cannot be read ({error})")))?;
    bytes_of(bytes.trim_ascii()).ok_or_else(|| refused(NO_KEY))
}

/// Never with the contents of the file: it may be a key all the same.
const NO_KEY: &str = "is no key: 64 hexadecimal digits; make one with `quatrack keys new`";

fn bytes_of(digits: &[u8]) -> Option<[u8; KEY_BYTES]> {
    let (pairs, rest) = digits.as_chunks::<2>();
    let mut bytes = [0; KEY_BYTES];
    if pairs.len() != KEY_BYTES || !rest.is_empty() {
        return None;
    }
    for (byte, pair) in bytes.iter_mut().zip(pairs) {
        let [high, low] = pair.map(|digit| char::from(digit).to_digit(16));
        *byte = u8::try_from(16 * high? + low?).ok()?;
    }
    Some(bytes)
}

/// Makes a file of a new random key, which its owner alone may read. A file that is there is left as it is.
pub(crate) fn create(path: &Path) -> Result<(), Failure> {
    let cannot = |error: std::io::Error| {
        Failure::input(format!("{}: cannot make this file ({error}); choose another place", path.display()))
    };
    let mut key = [0; KEY_BYTES];
    getrandom::fill(&mut key).map_err(|error| cannot(error.into()))?;
    let mut options = fs::OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let digits: String = key.iter().map(|byte| format!("{byte:02x}")).collect();
    options.open(path).and_then(|mut file| writeln!(file, "{digits}")).map_err(cannot)
}
